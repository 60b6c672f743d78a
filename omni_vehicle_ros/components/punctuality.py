"""How punctual the wheel modules are in real time: when their answers come, and which cycles go without one."""

import math
from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np

from omni_vehicle_ros.control.health import OK, WARN, Note

BINS, PERIODS = 4000, 8
"""Times of up to so many periods are told apart in so many bins: a run however long takes no more memory."""

SECOND = 1.0
"""From one look at missed cycles to the next [s]."""


class Spread(NamedTuple):
    """How times are spread: median, 99th percentile and largest [s]; the percentiles to 1/500 of a period."""

    p50: float
    p99: float
    largest: float


class Histogram:
    """Counts times.

    Parameters
    ----------
    period
        Times of more than `PERIODS` of them count as so many, but for the largest [s].
    """

    def __init__(self, period: float) -> None:
        self._width = period * PERIODS / BINS
        self._counts = np.zeros(BINS + 1, np.int64)
        self._largest = 0.0

    def add(self, time: float) -> None:
        """Count a time [s]."""
        self._counts[min(int(time / self._width), BINS)] += 1
        if time > self._largest:
            self._largest = time

    def spread(self) -> Spread | None:
        """Return how the times are spread; None if there are none."""
        below = self._counts.cumsum()
        if not below[-1]:
            return None
        places = np.searchsorted(below, below[-1] * np.array([0.5, 0.99])) + 1
        p50, p99 = np.minimum(places * self._width, self._largest).tolist()
        return Spread(p50, p99, self._largest)


class Punctuality:
    """Follows ticks and answers by the wall clock, from the first cycle that all have answered.

    Parameters
    ----------
    sources
        Topics of those who answer.
    period
        Wall time from one tick to the next [s].

    Attributes
    ----------
    period
        As given.
    cycles
        Counted so far, with those that had no tick.
    missed
        Those of them whose next tick came before all had answered, and ticks that did not come at all.
    """

    def __init__(self, sources: Iterable[str], period: float) -> None:
        self.period = period
        self.cycles = self.missed = 0
        self._sources = frozenset(sources)
        self._answers, self._jitter = Histogram(period), Histogram(period)
        self._before: dict[str, tuple[int, float]] = {}
        self._ticks: dict[int, tuple[int, float]] = {}
        self._last, self._stamp = math.inf, -1
        self._awaited: set[str] = set()

    def tick(self, stamp: int, wall: float) -> None:
        """Note that the cycle of ``stamp`` [ns] begins at ``wall`` [s]."""
        if self._ticks and (self.cycles or not self._awaited):
            skipped = max(int((wall - self._last) / self.period - 0.5), 0)
            self.cycles += 1 + skipped
            self.missed += bool(self._awaited) + skipped
        self._ticks[stamp] = self.cycles, wall
        if len(self._ticks) > PERIODS:
            del self._ticks[next(iter(self._ticks))]
        self._last, self._stamp, self._awaited = wall, stamp, set(self._sources)

    def answer(self, source: str, stamp: int, wall: float) -> None:
        """Note that the answer of a source for ``stamp`` [ns] came at ``wall`` [s]."""
        cycle, begin = self._ticks.get(stamp, (0, 0.0))
        if wall < begin:
            return  # of another vehicle: ours can't know of a cycle before it has begun
        if stamp == self._stamp:
            self._awaited.discard(source)
        if cycle:
            before = self._before.get(source)
            self._before[source] = cycle, wall
            self._answers.add(wall - begin)
            if before is not None and before[0] == cycle - 1:
                self._jitter.add(abs(wall - before[1] - self.period))

    def rest(self) -> None:
        """Begin anew with the next tick: no cycle is missed while time stands still."""
        self._ticks.clear()

    def figures(self) -> dict[str, Any]:
        """Return what was found: period, cycles, missed, and the `Spread` of answers and of jitter or None.

        An answer is timed from its tick; jitter is how far two of one module are from being one period apart.
        """
        spreads = {'answer': self._answers.spread(), 'jitter': self._jitter.spread()}
        return {
            'period': self.period, 'cycles': self.cycles, 'missed': self.missed,
            **{name: spread and spread._asdict() for name, spread in spreads.items()},
        }


class Lateness:
    """Says once a second how many cycles were missed in it, and when there are no more.

    Parameters
    ----------
    punctuality
        Counts them.
    """

    def __init__(self, punctuality: Punctuality) -> None:
        self._punctuality = punctuality
        self._looked = -math.inf
        self._cycles = self._missed = 0
        self._late = False

    def look(self, wall: float) -> Note | None:
        """Return what there is to say at ``wall`` [s], if anything."""
        if wall - self._looked < SECOND:
            return None
        found = self._punctuality
        cycles, missed = found.cycles - self._cycles, found.missed - self._missed
        self._looked, self._cycles, self._missed = wall, found.cycles, found.missed
        was_late, self._late = self._late, missed > 0
        period = f'{found.period * 1e3:g} ms'
        if missed:
            return WARN, f'{missed} of {cycles} cycles of {period} were missed in the last second'
        return (OK, f'no cycle of {period} was missed in the last second') if was_late else None
