"""What happened when: pauses, limits that were reached, wheels that lifted, complaints of the nodes."""

from collections import Counter
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from omni_vehicle_ros.analysis.stream.envelope import Times
from omni_vehicle_ros.messages import Status

KINDS = ('time-out', 'missed cycles', 'saturation', 'wheel lift', 'warning', 'error')
TOGETHER = 100_000_000
"""Two spans of one state closer than this are one [ns]."""
KEPT = 200
"""Events of one source that are kept; all are counted."""

_PAUSE_WORDS = ('_timeout', 'no answer', 'no command', 'stale', 'silent')


class Event(NamedTuple):
    """Something that happened, from when to when [ns]."""

    begin: int
    end: int
    kind: str
    source: str
    text: str


class Spans:
    """Finds from when to when something is so.

    Parameters
    ----------
    kind, source, text
        Of the events.

    Attributes
    ----------
    events
        The first `KEPT` that are over.
    count
        How many there were.
    """

    def __init__(self, kind: str, source: str, text: str) -> None:
        self.kind, self.source, self.text = kind, source, text
        self.events: list[Event] = []
        self.count = 0
        self._open: tuple[int, int] | None = None

    def add(self, times: Times, so: npt.NDArray[np.bool_]) -> None:
        """Take samples in order: times [ns] and whether it is so, shape (n,)."""
        hits = times[so]
        if not len(hits):
            return
        breaks = np.flatnonzero(np.diff(hits) > TOGETHER)
        begins, ends = hits[np.concatenate([[0], breaks + 1])], hits[np.concatenate([breaks, [len(hits) - 1]])]
        for begin, end in zip(begins.tolist(), ends.tolist(), strict=True):
            if self._open is not None and begin - self._open[1] <= TOGETHER:
                self._open = (self._open[0], max(end, self._open[1]))
            else:
                self.finish()
                self._open = (begin, end)

    def finish(self) -> None:
        """Say that all samples have come."""
        if self._open is None:
            return
        self.count += 1
        if len(self.events) < KEPT:
            self.events.append(Event(*self._open, self.kind, self.source, self.text))
        self._open = None


class Complaints:
    """Finds what nodes complain about on /diagnostics, from when to when each says the same.

    Attributes
    ----------
    events
        The first `KEPT` of each node that are over.
    counts
        How many there were, by kind.
    """

    _NODES = 200

    def __init__(self) -> None:
        self.events: list[Event] = []
        self.counts: Counter[str] = Counter()
        self._open: dict[str, tuple[int, int, str, str]] = {}
        self._by_node: Counter[str] = Counter()

    def add(self, times: Times, statuses: Iterable[Sequence[Status]]) -> None:
        """Take messages in order: times [ns] and what each says."""
        for time, some in zip(times.tolist(), statuses, strict=True):
            for status in some:
                self._hear(time, status)

    def _hear(self, time: int, status: Status) -> None:
        said = self._open.get(status.name)
        kind = _kind(status)
        if said is not None and said[2:] == (kind, status.message):
            self._open[status.name] = (said[0], time, kind, status.message)
            return
        if said is not None:
            self._close(status.name, time)
        if kind and len(self._open) < self._NODES:
            self._open[status.name] = (time, time, kind, status.message)

    def _close(self, node: str, time: int) -> None:
        begin, _, kind, text = self._open.pop(node)
        self.counts[kind] += 1
        self._by_node[node] += 1
        if self._by_node[node] <= KEPT and len(self._by_node) <= self._NODES:
            self.events.append(Event(begin, time, kind, node, text))

    def finish(self) -> None:
        """Say that all messages have come."""
        for node, said in list(self._open.items()):
            self._close(node, said[1])


def _kind(status: Status) -> str:
    if status.level <= 0:
        return ''
    if any(word in status.message for word in _PAUSE_WORDS):
        return 'time-out'
    return 'warning' if status.level == 1 else 'error'


class Heartbeat:
    """Finds where none of several topics says anything for longer than a limit.

    Parameters
    ----------
    limit
        [ns]; 0: none.
    """

    def __init__(self, limit: int) -> None:
        self._limit = limit
        self._last: dict[str, int] = {}
        self._silent: dict[str, list[tuple[int, int]]] = {}

    def add(self, topic: str, times: Times) -> None:
        """Take when a topic spoke [ns], in order, shape (n,)."""
        silent = self._silent.setdefault(topic, [])
        begin = self._last.get(topic)
        joined = times if begin is None else np.concatenate([[begin], times])
        if begin is None:
            silent.append((np.iinfo(np.int64).min, int(times[0])))
        for place in np.flatnonzero(np.diff(joined) > self._limit).tolist():
            if len(silent) < KEPT:
                silent.append((int(joined[place]) + self._limit, int(joined[place + 1])))
        self._last[topic] = int(times[-1])

    def events(self, end: int) -> list[Event]:
        """Return the pauses after the first word of any topic, up to the end of the bag [ns]."""
        if not self._last or not self._limit:
            return []
        common = [(np.iinfo(np.int64).min, end)]
        for topic, silent in self._silent.items():
            last = (self._last[topic] + self._limit, end)
            common = _overlap(common, [*silent, *([last] if last[0] < end else [])])
        first = min(silent[0][1] for silent in self._silent.values())
        text = f'no command for {self._limit * 1e-9:g} s'
        source = ', '.join(sorted(self._last))
        return [Event(begin, stop, 'time-out', source, text) for begin, stop in common if begin >= first]


def _overlap(some: list[tuple[int, int]], others: list[tuple[int, int]]) -> list[tuple[int, int]]:
    pairs = ((max(a, c), min(b, d)) for a, b in some for c, d in others)
    return [(begin, end) for begin, end in pairs if begin < end]
