"""What one signal does after a step: steady state, peak, overshoot, settling time. Pure functions on arrays.

The first sample belongs to the time before the step and is left out everywhere.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

WINDOW = 1.0
BAND = 0.02


class StepMetrics(NamedTuple):
    """How a signal answers a step; None where there is no such figure.

    Attributes
    ----------
    steady_state
        See `steady_state`, in the unit of the signal.
    peak
        See `peak`, in the unit of the signal.
    overshoot
        See `overshoot`, a fraction of the size of the steady state.
    settling_time
        See `settling_time` [s].
    """

    steady_state: float | None
    peak: float | None
    overshoot: float | None
    settling_time: float | None


def steady_state(time: Array, signal: Array, floor: float) -> float | None:
    """Return the mean of the last second, if the signal has settled there, else None.

    It has settled if, over the last second, the difference of its largest and its smallest value is at most
    2 % of the size of its mean, or at most ``floor``. A recording shorter than a second has no steady state.

    Parameters
    ----------
    time
        Rising [s], shape (n,).
    signal
        Values, shape (n,).
    floor
        Changes that mean nothing, in the unit of the signal.
    """
    window = last_window(time)
    if window is None:
        return None
    values = signal[window]
    if not np.all(np.isfinite(values)):
        return None
    mean = float(np.mean(values))
    return mean if float(np.ptp(values)) <= max(BAND * abs(mean), floor) else None


def last_window(time: Array) -> slice | None:
    """Return the samples of the last second, or None if there is less than that."""
    if len(time) < 3 or time[-1] - time[1] < WINDOW * (1.0 - 1e-9):
        return None
    return slice(int(np.searchsorted(time, time[-1] - WINDOW * (1.0 + 1e-9))), len(time))


def peak(signal: Array) -> float | None:
    """Return the value that is farthest from 0, with its sign; None if there is none."""
    values = signal[1:][np.isfinite(signal[1:])]
    return float(values[np.argmax(np.abs(values))]) if len(values) else None


def overshoot(signal: Array, steady: float) -> float:
    """Return the largest excursion past the steady value, as a fraction of its size.

    Past means: on the other side of it than the first sample after the step. A signal that begins on its
    steady value has no such side, and its largest excursion to either side counts.

    Parameters
    ----------
    signal
        Values, shape (n,), some of them finite.
    steady
        Steady value, not 0.
    """
    distance = signal[1:][np.isfinite(signal[1:])] - steady
    past = -distance * np.sign(distance[0]) if distance[0] != 0.0 else np.abs(distance)
    return max(0.0, float(np.max(past))) / abs(steady)


def settling_time(time: Array, signal: Array, steady: float, floor: float) -> float:
    """Return the last time, after the first sample [s], at which the signal is outside +-2 % of its steady value.

    The band is never narrower than +-``floor``; 0 if the signal is never outside.
    """
    outside = np.flatnonzero(~(np.abs(signal[1:] - steady) <= max(BAND * abs(steady), floor)))
    return round(float(time[outside[-1] + 1] - time[0]), 9) if len(outside) else 0.0


def step_metrics(time: Array, signal: Array, floor: float, settled: bool = True) -> StepMetrics:
    """Return all figures of a signal.

    Parameters
    ----------
    time, signal
        Rising times [s] and values, shape (n,).
    floor
        Changes that mean nothing, in the unit of the signal. A steady state not above it has no overshoot.
    settled
        False: something else is known not to have settled, and so this has no steady state.
    """
    steady = steady_state(time, signal, floor) if settled else None
    if steady is None:
        return StepMetrics(None, peak(signal), None, None)
    past = overshoot(signal, steady) if abs(steady) > floor else None
    return StepMetrics(steady, peak(signal), past, settling_time(time, signal, steady, floor))
