"""Statistics of signals that come piece by piece, without keeping them."""

import math

import numpy as np
import numpy.typing as npt

from omni_vehicle_ros.analysis.signals import Array

FIGURES = ('count', 'mean', 'deviation', 'minimum', 'minimum_at', 'maximum', 'maximum_at')

_PER_DECADE = 200
_SMALLEST, _LARGEST = 1e-9, 1e5


class RunningStatistics:
    """Count, mean, standard deviation, and the extremes with their times, of ``k`` signals.

    Pieces are merged as in Chan, Golub and LeVeque 1983: as exact as two passes over all of it.

    Parameters
    ----------
    width
        Number of signals.
    """

    def __init__(self, width: int) -> None:
        self.count = np.zeros(width, np.int64)
        self.mean, self._squares = np.zeros(width), np.zeros(width)
        self.low, self.high = np.full(width, np.inf), np.full(width, -np.inf)
        self.low_at, self.high_at = np.zeros(width, np.int64), np.zeros(width, np.int64)

    def add(self, times: npt.NDArray[np.int64], values: Array) -> None:
        """Take samples at times [ns], shapes (n,) and (n, k); what is not finite is left out."""
        for signal in range(values.shape[1]):
            known = np.isfinite(values[:, signal])
            if known.any():
                self._add(signal, times[known], values[known, signal])

    def _add(self, signal: int, times: npt.NDArray[np.int64], values: Array) -> None:
        before, count = int(self.count[signal]), len(values)
        mean = float(np.mean(values))
        away = mean - self.mean[signal]
        self._squares[signal] += float(np.sum((values - mean) ** 2)) + away**2 * before * count / (before + count)
        self.mean[signal] += away * count / (before + count)
        self.count[signal] += count
        low, high = int(np.argmin(values)), int(np.argmax(values))
        if values[low] < self.low[signal]:
            self.low[signal], self.low_at[signal] = values[low], times[low]
        if values[high] > self.high[signal]:
            self.high[signal], self.high_at[signal] = values[high], times[high]

    def figures(self, signal: int, begin: int = 0) -> dict[str, float | int | None]:
        """Return the figures of a signal, by the names of `FIGURES`; None where there is no sample.

        Times are in s after ``begin`` [ns].
        """
        count = int(self.count[signal])
        if not count:
            return {'count': 0, **dict.fromkeys(FIGURES[1:])}
        low_at, high_at = (int(at[signal]) - begin for at in (self.low_at, self.high_at))
        numbers = (
            self.mean[signal], math.sqrt(self._squares[signal] / count),
            self.low[signal], low_at * 1e-9, self.high[signal], high_at * 1e-9,
        )
        return {'count': count, **dict(zip(FIGURES[1:], map(float, numbers), strict=True))}


class Quantiles:
    """Quantiles of times [s], from a histogram whose bins are a little over 1 % wide."""

    def __init__(self) -> None:
        decades = math.log10(_LARGEST / _SMALLEST)
        self._edges = np.geomspace(_SMALLEST, _LARGEST, round(decades * _PER_DECADE) + 1)
        self._counts = np.zeros(len(self._edges) + 1, np.int64)

    def add(self, values: Array) -> None:
        """Take times [s]; below 1 ns they count as 0."""
        places = np.searchsorted(self._edges, values, side='right')
        self._counts += np.bincount(places, minlength=len(self._counts))

    def quantile(self, share: float) -> float:
        """Return the time that a share of all does not exceed, up to the width of a bin; 0 without any."""
        total = np.cumsum(self._counts)
        place = int(np.searchsorted(total, share * total[-1]))
        return float(self._edges[min(place, len(self._edges) - 1)]) if place and total[-1] else 0.0
