"""How well something follows its command, and how late."""

import numpy as np

from omni_vehicle_ros.analysis.signals import Array
from omni_vehicle_ros.analysis.stream.envelope import Times
from omni_vehicle_ros.analysis.stream.statistics import RunningStatistics

LAGS = 100
"""Largest lag that is looked for, in messages of the response."""
STILL = 1e-6
"""Standard deviation of a command, in its unit, below which it tells no lag."""


class Response:
    """Error and lag of ``k`` signals against their commands.

    Attributes
    ----------
    error
        Statistics of response less command.
    """

    def __init__(self, width: int) -> None:
        self.error = RunningStatistics(width)
        self._command = RunningStatistics(width)
        self._sums = np.zeros((LAGS + 1, width))
        self._tail = np.empty((0, width))

    def add(self, times: Times, response: Array, command: Array) -> None:
        """Take samples in order: times [ns], shape (n,), and values, shape (n, k); NaN where there is no command."""
        self.error.add(times, response - command)
        self._command.add(times, command)
        commands = np.concatenate([self._tail, command])
        response = response[max(0, LAGS - len(self._tail)) :]
        self._tail = commands[-LAGS:]
        count = len(commands) - LAGS
        if count <= 0:
            return
        unknown = np.concatenate([np.zeros((1, commands.shape[1])), np.cumsum(~np.isfinite(commands), axis=0)])
        known = (unknown[LAGS + 1 :] == unknown[: -LAGS - 1]) & np.isfinite(response)
        for lag in range(LAGS + 1):
            away = np.where(known, response - commands[LAGS - lag : LAGS - lag + count], 0.0)
            self._sums[lag] += np.sum(away * away, axis=0)

    def figures(self, signal: int, period: float | None) -> dict[str, float | None]:
        """Return the figures of one signal; None where there is none.

        Parameters
        ----------
        signal
            Its number.
        period
            From one message of the response to the next [s], if it is cyclic.

        Returns
        -------
        dict
            ``rms`` and ``peak`` of the error, in its unit; ``lag`` [s]: the delay of the command, in whole periods,
            by which it is most like the response.
        """
        found = self.error.figures(signal)
        low, high, mean, deviation = (found[name] for name in ('minimum', 'maximum', 'mean', 'deviation'))
        if low is None or high is None or mean is None or deviation is None:
            return {'rms': None, 'peak': None, 'lag': None}
        peak = high if abs(high) >= abs(low) else low
        return {'rms': float(np.hypot(mean, deviation)), 'peak': peak, 'lag': self._lag(signal, period)}

    def _lag(self, signal: int, period: float | None) -> float | None:
        sums = self._sums[:, signal]
        lag = int(np.argmin(sums))
        moves = (self._command.figures(signal)['deviation'] or 0.0) > STILL and np.ptp(sums) > 0.0
        return lag * period if period and moves and lag < LAGS else None
