"""The order of a recording: by simulated time, then by topic, whatever order messages came in."""

from collections.abc import Iterable
from typing import Protocol

from omni_vehicle_ros import interface
from omni_vehicle_ros.components.beats import FOREIGN, Beats
from omni_vehicle_ros.components.unstamped import TOPICS as UNSTAMPED
from omni_vehicle_ros.components.unstamped import Unstamped
from omni_vehicle_ros.faults import CLOCK, FAULTS, read_faults
from omni_vehicle_ros.messages import decode
from omni_vehicle_ros.messages.stamps import stamp_of

SETTLE = 40
"""Cycles that a message waits for those of the same time: more than the plant runs ahead of the recorder."""

FAULT_TYPE = interface.topic(FAULTS).type


class Writer(Protocol):
    """What a journal writes to."""

    def add_topic(self, name: str, type_name: str, qos: interface.Qos) -> None:
        """Announce a topic."""

    def write(self, name: str, data: bytes, log_time: int) -> None:
        """Write a message."""


class Journal:
    """Writes the topics of one vehicle in a settled order, and counts what is missing of the cyclic ones.

    Parameters
    ----------
    writer
        Where to.
    namespace
        Of the vehicle.
    period
        Control period [ns].
    """

    def __init__(self, writer: Writer, namespace: str, period: int) -> None:
        self.now = 0
        self._beats = Beats(SETTLE)
        self.period = period
        self.written = 0
        self.lost = 0
        self._writer = writer
        rows = [row for row in interface.TOPICS if row.recorded]
        self._names = [interface.resolve(row.name, namespace) for row in rows]
        self._index = {row.name: i for i, row in enumerate(rows)}
        self._beat, self._faults = self._index['joint_states'], self._index[FAULTS]
        self._cyclic = [row.cyclic for row in rows]
        self._heard: dict[int, int] = {}
        self._last: dict[int, int] = {}
        self._jumps = False
        self._pending: dict[int, list[tuple[int, bytes | int, bytes]]] = {}
        self._unstamped = Unstamped()
        for row, name in zip(rows, self._names, strict=True):
            writer.add_topic(name, row.type, row.qos)

    def add(self, topic: str, data: bytes) -> int:
        """Take a message, and return its stamp [ns]; the one that begins a cycle also writes what has settled.

        A message without a stamp counts as said now.
        """
        if topic in UNSTAMPED:
            self._keep_all(self._unstamped.hear(topic, data, self.now))
            return self.now
        index = self._index[topic]
        stamp = said = stamp_of(data)
        if topic == 'joint_states':
            stamp = self._cycle(stamp)
            self._write(self.now - SETTLE * self.period)
        elif stamp < 0 or abs(stamp - self.now) > FOREIGN or (stamp == 0 and self.now > SETTLE * self.period):
            stamp = self.now
        if self._cyclic[index]:
            self._heard[index] = max(stamp, self._heard.get(index, stamp))
        self._keep(topic, data, stamp)
        if topic == 'driver/step':
            self._keep_all(self._unstamped.name(decode(interface.topic(topic).type, data)))
        return said

    def _cycle(self, stamp: int) -> int:
        """Return the time of a message that begins a cycle: its own, or now for one of a stranger."""
        if not self._beats.accept(stamp):
            return self.now
        self.now = max(self.now, stamp)
        return stamp

    def _keep(self, topic: str, data: bytes, stamp: int) -> None:
        # Many nodes speak on /diagnostics at the same time: there the text decides, else who came first.
        waiting = self._pending.setdefault(stamp, [])
        waiting.append((self._index[topic], data if topic == '/diagnostics' else len(waiting), data))

    def _keep_all(self, messages: list[tuple[str, bytes, int]]) -> None:
        for topic, data, stamp in messages:
            self._keep(topic, data, stamp)

    def complete(self, end: int) -> bool:
        """Whether every cyclic topic that was heard has come to ``end`` [ns]."""
        return all(stamp >= end for stamp in self._heard.values())

    def miss(self, topics: Iterable[str]) -> None:
        """Take no more of some topics for granted, until they are heard again."""
        for topic in topics:
            self._heard.pop(self._index.get(topic, -1), None)

    def flush(self) -> None:
        """Write all that waits."""
        self._write(None)

    def _write(self, until: int | None) -> None:
        """Write what is stamped up to ``until`` [ns], in order, and count what is missing."""
        self._keep_all(self._unstamped.give_up(until))
        for stamp in sorted(stamp for stamp in self._pending if until is None or stamp <= until):
            ready = sorted(self._pending.pop(stamp))
            if self._jumps and any(index == self._beat for index, *_ in ready):
                self._follow_clock(stamp)
            for index, _, data in ready:
                self._writer.write(self._names[index], data, stamp)
                if self._cyclic[index]:
                    self._count(index, stamp)
                elif index == self._faults:
                    self._jumps |= any(fault.component == CLOCK for fault in read_faults(decode(FAULT_TYPE, data))[0])
            self.written += len(ready)

    def _count(self, index: int, stamp: int) -> None:
        last = self._last.get(index, stamp - self.period)
        self.lost += max((stamp - last) // self.period - 1, 0)
        self._last[index] = max(stamp, last)

    def _follow_clock(self, stamp: int) -> None:
        """Miss nothing in the time over which the clock has jumped to ``stamp`` [ns]."""
        jump = stamp - self._last.get(self._beat, stamp) - self.period
        self._last = {index: last + jump for index, last in self._last.items()}
        self._jumps = False
