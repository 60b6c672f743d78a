"""Rows of one topic with what others said last before them."""

from collections.abc import Callable, Sequence

import numpy as np

from omni_vehicle_ros.analysis.signals import Array
from omni_vehicle_ros.analysis.stream.envelope import Times

WAITING = 8192
"""Rows that wait for other topics at most: more than the topics of a bag are apart when it is read in blocks."""

Taker = Callable[[Times, Array, Array], None]


class Join:
    """Joins the rows of a topic with the last ones, not after them by their stamps, of other topics.

    A row waits until every other topic has gone past it; those of a topic that says little wait for at most `WAITING`
    rows.

    Parameters
    ----------
    widths
        Number of signals of each other topic.
    taker
        Gets times [ns], the rows, shape (n, k), and beside them those of the others, shape (n, sum of widths); NaN
        before their first.
    """

    def __init__(self, widths: Sequence[int], taker: Taker) -> None:
        self._others = [_Held(width) for width in widths]
        self._taker = taker
        self._times: list[Times] = []
        self._rows: list[Array] = []
        self._waiting = 0

    def add(self, times: Times, rows: Array) -> None:
        """Take rows of the topic, shapes (n,) and (n, k)."""
        self._times.append(times)
        self._rows.append(rows)
        self._waiting += len(times)
        self._give(min((other.last for other in self._others), default=0))

    def add_other(self, number: int, times: Times, rows: Array) -> None:
        """Take rows of one of the others."""
        self._others[number].add(times, rows)
        self._give(min(other.last for other in self._others))

    def finish(self) -> None:
        """Give what waits."""
        self._give(np.iinfo(np.int64).max)

    def _give(self, before: int) -> None:
        """Give all rows before a time [ns], and those that have waited for too long."""
        if not self._waiting or (self._waiting <= WAITING and before <= self._times[0][0]):
            return
        times, rows = np.concatenate(self._times), np.concatenate(self._rows)
        late = times >= before
        count = int(np.argmax(late)) if late.any() else len(times)
        count = max(count, len(times) - WAITING)
        self._waiting = len(times) - count
        self._times, self._rows = ([times[count:]], [rows[count:]]) if self._waiting else ([], [])
        if count:
            beside = [other.at(times[:count]) for other in self._others]
            self._taker(times[:count], rows[:count], np.concatenate(beside, axis=1))


class _Held:
    """The rows of a topic that may still be asked for."""

    def __init__(self, width: int) -> None:
        self.last = np.iinfo(np.int64).min
        self._times = np.array([self.last])
        self._rows = np.full((1, width), np.nan)

    def add(self, times: Times, rows: Array) -> None:
        kept = slice(-16 * WAITING, None)  # another topic may say more often what it says
        self._times = np.concatenate([self._times, np.maximum.accumulate(times)])[kept]
        self._rows = np.concatenate([self._rows, rows])[kept]
        self._times = np.maximum.accumulate(self._times)  # a clock that jumped back: the latest counts
        self.last = int(self._times[-1])

    def at(self, times: Times) -> Array:
        places = np.maximum(np.searchsorted(self._times, times, side='right') - 1, 0)
        found: Array = self._rows[places]
        self._times, self._rows = self._times[places.min() :], self._rows[places.min() :]
        return found
