"""What of a bag is due when: rate, begin, duration, loop, pause, steps; without ROS, on the clock of the caller."""

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from heapq import merge
from itertools import count
from typing import NamedTuple

from omni_vehicle_ros.bags.mcap.file_reader import RecordedMessage
from omni_vehicle_ros.errors import BagError
from omni_vehicle_ros.messages import Clock, encode

CLOCK, CLOCK_TYPE = '/clock', 'rosgraph_msgs/msg/Clock'
CLOCK_PERIOD = 10_000_000
"""From one message on a clock that is made to the next, in wall time [ns]."""

BATCH = 500
"""Messages that are given at a time, so that the caller can look at something else in between."""

SEEK_BATCH = 2000
"""Messages that are passed over at a time."""

LOOK_AHEAD = 1000
"""Messages of the first instant that are looked at for latched ones."""

SLACK = 1_000_000_000
"""A bag whose messages are not in the order of time is read this far beyond the end that was asked for [ns]."""

ROUND = 50_000_000
"""From one begin of a loop to the next, at least: some bags have but one instant [ns]."""

IDLE = 0.05


@dataclass(frozen=True)
class PlayerSettings:
    """What of a bag to play, and how.

    Attributes
    ----------
    rate
        Time of the bag over wall time.
    start
        Where to begin, from the first message on [s].
    duration
        How long, in time of the bag [s]; None: to the end. A message right at its end is not played any more.
    loop
        Whether to begin again at the end.
    clock
        Whether to make /clock from the times of the messages, in place of that in the bag.

    Raises
    ------
    BagError
        A number is out of range.
    """

    rate: float = 1.0
    start: float = 0.0
    duration: float | None = None
    loop: bool = False
    clock: bool = False

    def __post_init__(self) -> None:
        """Check the numbers."""
        ranges = (self.rate, 1e-3, 1e3), (self.start, 0.0, 1e9), (self.duration, 1e-9, 1e9)
        for name, (value, low, high) in zip(('rate', 'start', 'duration'), ranges, strict=True):
            if value is not None and not low <= value <= high:
                raise BagError(f'--{name}: {value:g} is outside {low:g} .. {high:g}')


class Entry(NamedTuple):
    """A message to publish."""

    time: int
    """Of the bag [ns]; never less than that of the one before, but where a loop begins again."""
    topic: str
    type_name: str
    data: bytes


class Player:
    """Says which messages are due.

    All ``now`` are wall time [ns] from any origin. Nothing that grows with the bag is kept.

    Parameters
    ----------
    source
        Gives the messages of the bag each time it is iterated over.
    chosen
        Whether to play a topic.
    latched
        How many messages of a topic someone who comes late gets; 0 if it isn't latched.
    settings
        How to play.

    Attributes
    ----------
    finished
        Whether all has been given.
    paused
        Whether time stands still.
    time
        Where in the bag it is [ns].
    first
        Log time of the first message of the bag [ns]; None until it has been read.
    """

    def __init__(
        self,
        source: Iterable[RecordedMessage],
        chosen: Callable[[str], bool],
        latched: Callable[[str], int],
        settings: PlayerSettings,
    ) -> None:
        self.finished = self.paused = False
        self.time = 0
        self.first: int | None = None
        self._source, self._chosen, self._latched, self._settings = source, chosen, latched, settings
        self._entries = self._pass()
        self._head: Entry | None = None
        self._begun: tuple[int, int] | None = None  # wall time, and time of the bag at it
        self._round: int | None = None  # wall time at which it last began
        self._given = 0
        self._ticked: int | None = None

    @property
    def position(self) -> float:
        """Where in the bag it is, counted as `PlayerSettings.start` is [s]."""
        return max(self.time - (self.first or 0), 0) / 1e9

    def due(self, now: int) -> list[Entry]:
        """Return what is due, in its order; a part of it if it is much. While a begin is sought it is nothing."""
        if not self._fetch() or self.paused:
            return []
        if self._begun is None:
            if self._round is not None and now < self._round + ROUND:
                return []
            assert self._head is not None
            self._begun, self._round = (now, self._head.time), now
        until = self._at(now)
        if self._head is not None:  # who comes late must not let a made clock pass what is still to be given
            self.time = max(self.time, min(until, self._head.time))
        entries = self._tick(now)
        for _ in range(BATCH):
            if self._head is None or self._head.time > until:
                break
            entries.append(self._take())
            if not self._fetch() or self._begun is None:  # the end, or that of a round
                break
        return entries

    def wait(self, now: int) -> float:
        """Return for how long nothing is due [s], a twentieth of a second at most."""
        if self.paused or self.finished:
            return IDLE
        if self._head is None:
            return 0.0
        if self._begun is None:
            ahead = 0.0 if self._round is None else float(self._round + ROUND - now)
        else:
            ahead = (self._head.time - self._at(now)) / self._settings.rate
        if self._settings.clock and self._ticked is not None:
            ahead = min(ahead, self._ticked + CLOCK_PERIOD - now)
        return min(max(ahead * 1e-9, 0.0), IDLE)

    def pause(self, now: int) -> None:
        """Let time stand still."""
        if not self.paused and self._begun is not None:
            self._begun = now, min(self._at(now), self._head.time if self._head else self.time)
        self.paused = True

    def resume(self, now: int) -> None:
        """Go on from where it stands."""
        if self.paused and self._begun is not None:
            self._begun = now, self._begun[1]
        self.paused = False

    def step(self, now: int) -> list[Entry]:
        """Return, while paused, the next message and all others of the same time: in a vehicle's bag, a control cycle.

        The list is empty at the end, and while a begin is sought.
        """
        if not self._fetch() or self._head is None:
            return []
        self.time = max(self.time, self._head.time)
        self._begun = now, self._head.time
        entries = [self._clock_entry()] if self._settings.clock else []
        instant = self._head.time
        for _ in range(LOOK_AHEAD):
            entries.append(self._take())
            if not self._fetch() or self._head is None or self._head.time != instant or self._begun is None:
                break
        return entries

    def _at(self, now: int) -> int:
        assert self._begun is not None
        wall, time = self._begun
        return time + round((now - wall) * self._settings.rate)

    def _tick(self, now: int) -> list[Entry]:
        if not self._settings.clock or (self._ticked is not None and now < self._ticked + CLOCK_PERIOD):
            return []
        self._ticked = now
        return [self._clock_entry()]

    def _clock_entry(self) -> Entry:
        return Entry(self.time, CLOCK, CLOCK_TYPE, encode(CLOCK_TYPE, Clock(self.time)))

    def _take(self) -> Entry:
        assert self._head is not None
        entry, self._head = self._head, None
        self.time = max(self.time, entry.time)
        self._given += 1
        return entry

    def _fetch(self) -> bool:
        """Have the next message at hand, and return whether there is one."""
        while self._head is None and not self.finished:
            try:
                self._head = next(self._entries)
            except StopIteration:
                self._end_pass()
                continue
            if self._head is None:
                return False
        return self._head is not None

    def _end_pass(self) -> None:
        """Begin again, or be finished; a bag without anything to play isn't looped."""
        self.finished = not self._settings.loop or not self._given
        if not self.finished:
            self._given, self._begun, self._ticked, self.time = 0, None, None, 0
            self._entries = self._pass()

    def _pass(self) -> Iterator[Entry | None]:
        """Give the messages from begin to end once, and None now and then where many are passed over."""
        start, duration = round(self._settings.start * 1e9), self._settings.duration
        passed = count(1)
        time: int | None = None
        last = first = latest = 0
        opening = _Opening(self._latched)
        for message in self._source:
            if time is None:
                self.first = message.log_time
                first = time = message.log_time + start
                last = first + (round(duration * 1e9) if duration is not None else 2**63)
            latest = max(latest, message.log_time)
            if message.log_time > last + SLACK:
                break
            if next(passed) % SEEK_BATCH == 0:
                yield None
            if not self._plays(message.topic) or message.log_time >= last:
                continue
            if opening.open and message.log_time <= first and opening.add(message, first):
                continue
            yield from opening.close(first)
            if message.log_time >= first:
                time = max(time, message.log_time)
                yield Entry(time, message.topic, message.type_name, message.data)
        if latest >= first:
            yield from opening.close(first)

    def _plays(self, topic: str) -> bool:
        return self._chosen(topic) and not (self._settings.clock and topic == CLOCK)


class _Opening:
    """What goes out first: what was latched before the begin, what is latched at it, and what else is of its time."""

    def __init__(self, latched: Callable[[str], int]) -> None:
        self.open = True
        self._latched = latched
        self._before: dict[str, deque[tuple[int, RecordedMessage]]] = {}
        self._first: tuple[list[RecordedMessage], list[RecordedMessage]] = [], []
        self._count = 0

    def add(self, message: RecordedMessage, first: int) -> bool:
        """Take a message up to the begin, and return whether there was room for it."""
        depth = self._latched(message.topic)
        if message.log_time == first:
            if sum(map(len, self._first)) >= LOOK_AHEAD:
                return False
            self._first[not depth].append(message)
        elif depth:
            self._count += 1
            self._before.setdefault(message.topic, deque(maxlen=depth)).append((self._count, message))
        return True

    def close(self, first: int) -> Iterator[Entry]:
        """Give all, once."""
        if self.open:
            self.open = False
            before = [message for _, message in merge(*self._before.values(), key=lambda pair: pair[0])]
            for message in (*before, *self._first[0], *self._first[1]):
                yield Entry(first, message.topic, message.type_name, message.data)
            self._before.clear()
