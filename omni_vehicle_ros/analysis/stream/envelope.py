"""Signals over time in bounded memory: the smallest and the largest value of each short interval."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from omni_vehicle_ros.analysis.signals import Array

BUCKETS = 2048
"""Intervals kept at most; their width doubles when there are more."""

Times = npt.NDArray[np.int64]


class Bucketed(NamedTuple):
    """The samples of ``m`` intervals; ``k`` signals."""

    keys: Times
    """Number of each interval since time 0, in units of its width, rising, shape (m,)."""
    low: Array
    """Smallest value, NaN where there is none, shape (m, k)."""
    high: Array
    """Largest value, shape (m, k)."""
    low_at: Times
    """When the smallest value came first [ns], shape (m, k)."""
    high_at: Times
    """When the largest value came first [ns], shape (m, k)."""


class Envelope:
    """The course of signals with a common time.

    An interval is ``2 ** shift`` ns wide and begins at a multiple of that, so that merging two of them gives one
    again. A bag with fewer samples than `BUCKETS` keeps nearly all of them.

    Parameters
    ----------
    width
        Number of signals.
    buckets
        Intervals kept at most.

    Attributes
    ----------
    shift
        Logarithm to base 2 of the width of an interval in ns.
    """

    def __init__(self, width: int, buckets: int = BUCKETS) -> None:
        self.shift = 0
        self._most = buckets
        nothing, never = np.empty((0, width)), np.empty((0, width), np.int64)
        self._kept = Bucketed(np.empty(0, np.int64), nothing, nothing, never, never)

    def add(self, times: Times, values: Array) -> None:
        """Take samples.

        Parameters
        ----------
        times
            [ns], in any order, shape (n,).
        values
            Shape (n, k); what is not finite counts as missing.
        """
        values = np.where(np.isfinite(values), values, np.nan)
        at = np.repeat(times[:, np.newaxis], values.shape[1], axis=1)
        self._kept = self._merge(self._kept, Bucketed(times >> self.shift, values, values, at, at))

    def _merge(self, old: Bucketed, new: Bucketed) -> Bucketed:
        keys = np.concatenate([old.keys, new.keys])
        while len(np.unique(keys)) > self._most:
            keys = keys >> 1
            self.shift += 1
        order = np.argsort(keys, kind='stable')
        rest = (np.concatenate(pair)[order] for pair in zip(old[1:], new[1:], strict=True))
        return _reduced(Bucketed(keys[order], *rest))

    def line(self, signal: int, begin: int = 0) -> tuple[Array, Array]:
        """Return times [s] and values to draw a signal with: the extremes of each interval, in order.

        Parameters
        ----------
        signal
            Its number.
        begin
            Time that counts as 0 [ns].

        Returns
        -------
        tuple of ndarray
            Shape (n,), at most twice as many as there are intervals. Where an interval has no value it is NaN.
        """
        kept = self._kept
        low_first = kept.low_at[:, signal] <= kept.high_at[:, signal]
        times = np.sort(np.column_stack([kept.low_at[:, signal], kept.high_at[:, signal]]), axis=1)
        low, high = kept.low[:, signal], kept.high[:, signal]
        values = np.column_stack([np.where(low_first, low, high), np.where(low_first, high, low)])
        once = np.ones(times.shape, np.bool_)
        once[:, 1] = times[:, 1] > times[:, 0]
        return (times[once] - begin) * np.float64(1e-9), values[once]


def _reduced(rows: Bucketed) -> Bucketed:
    """Return one row for each key; rows are sorted by key."""
    if not len(rows.keys):
        return rows
    fresh = np.diff(rows.keys, prepend=rows.keys[0] - 1) != 0
    begins, group = np.flatnonzero(fresh), np.cumsum(fresh) - 1
    low, high = np.fmin.reduceat(rows.low, begins), np.fmax.reduceat(rows.high, begins)
    low_at = _first(rows.low == low[group], rows.low_at, begins, group)
    high_at = _first(rows.high == high[group], rows.high_at, begins, group)
    return Bucketed(rows.keys[begins], low, high, low_at, high_at)


def _first(hit: npt.NDArray[np.bool_], times: Times, begins: Times, group: Times) -> Times:
    """Return the earliest time of a hit in each group; without one the time of its first row."""
    found = np.minimum.reduceat(np.where(hit, times, np.iinfo(np.int64).max), begins)
    return np.where(found == np.iinfo(np.int64).max, times[begins], found)
