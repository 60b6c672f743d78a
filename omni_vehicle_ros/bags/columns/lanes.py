"""The numbers of messages, stored by topic and layout until there are enough of them for columns."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from omni_vehicle_ros.bags.columns.columns import Columns, columns_of_rows, join_columns, make_columns
from omni_vehicle_ros.bags.columns.kernel import CHANNELS, COUNT, STORE, Walk, words_of
from omni_vehicle_ros.errors import MessageError
from omni_vehicle_ros.messages import decode
from omni_vehicle_ros.messages.rows import RowLayout, row_layout

WORTH = 8
"""Messages of unknown layout of a topic from which on it takes less time to learn one than to decode them."""
STORE_WORDS = 2**24
"""Room for the lanes of all topics, in words of 8 bytes; only what is used of it takes memory."""
MOST_LANES = 16
"""Layouts of a topic that are kept; what has others is decoded message by message."""


class Topic:
    """What is known of one topic and type.

    Parameters
    ----------
    name, type_name
        What it is.
    wanted
        Whether its messages are to be decoded; else they are counted only.
    """

    def __init__(self, name: str, type_name: str, wanted: bool) -> None:
        self.name = name
        self.type_name = type_name
        self.wanted = wanted
        self.lanes: list[tuple[int, RowLayout]] = []
        self.odd: list[tuple[int, int, bytes]] = []
        """Messages that have no lane: number among those stored, log time [ns], content."""
        self.misses = 0


class Lanes:
    """Takes the messages of pieces of a file.

    Parameters
    ----------
    walk
        The loop over messages; without it, each is taken by itself.
    capacity
        Messages of a topic that are stored at most.
    """

    def __init__(self, walk: Walk | None, capacity: int) -> None:
        self._walk = walk
        self._capacity = capacity
        self.topics: list[Topic] = []
        self.forget_channels()
        self.counts = np.empty((0, 3), np.int64)
        self._lanes = np.empty((0, 8), np.int64)
        self._words: tuple[NDArray[Any], ...] = tuple(np.empty(0, dtype) for dtype in (np.int64, np.uint64, np.uint64))
        self._store = np.empty(STORE_WORDS, np.uint64)
        self._stored = 0
        self.odd_bytes = 0

    def forget_channels(self) -> None:
        """Let no channel have a topic, as at the begin of a file."""
        self.topic_of = np.full(CHANNELS, -1, np.int32)

    def add_topic(self, topic: Topic) -> int:
        """Return the number of a new topic."""
        self.topics.append(topic)
        self.counts = np.vstack((self.counts, (0, 0, -1 if topic.wanted else -2)))
        return len(self.topics) - 1

    def walk(self, piece: bytes, position: int) -> int:
        """Take messages of a piece from a position on, up to a record that needs a closer look; return where."""
        if self._walk is None or len(piece) < 8:
            return position
        return self._walk(
            words_of(piece), position, len(piece), self.topic_of, self.counts, self._lanes,
            *self._words, self._store, self._capacity,
        )

    def is_full(self, number: int) -> bool:
        """Tell whether no more messages of a topic can be stored."""
        return bool(self.counts[number, 1] >= self._capacity)

    def take(self, number: int, log_time: int, data: bytes) -> bool:
        """Take one message by itself; or learn its layout and return False: walk again.

        Parameters
        ----------
        number
            Of its topic, which is not full.
        log_time
            When it was recorded [ns].
        data
            What it says.
        """
        topic = self.topics[number]
        if topic.wanted:
            topic.misses += 1
            if self._walk is not None and topic.misses >= WORTH and self._learn(number, data):
                return False
            topic.odd.append((int(self.counts[number, 1]), log_time, data))
            self.odd_bytes += len(data)
            self.counts[number, 1] += 1
        self.counts[number, 0] += 1
        return True

    def _learn(self, number: int, data: bytes) -> bool:
        topic = self.topics[number]
        topic.misses = 0
        if len(topic.lanes) >= MOST_LANES:
            return False
        try:
            layout = row_layout(topic.type_name, data)
        except MessageError:  # it says so when it is decoded
            return False
        if layout is None:
            return False
        width = 2 + len(layout.numbers)
        if self._stored + width * self._capacity > STORE_WORDS:
            return False
        begin, end = len(self._words[0]), len(self._words[0]) + len(layout.checks[0])
        last = end + len(layout.numbers)
        lane = len(data), begin, end, last, self.counts[number, 2], self._stored, width, 0
        self.counts[number, 2] = len(self._lanes)
        topic.lanes.append((len(self._lanes), layout))
        self._lanes = np.vstack((self._lanes, lane))
        self._stored += width * self._capacity
        unused = np.zeros(len(layout.numbers), np.uint64)
        places, masks, constants = layout.checks
        added = np.append(places, layout.numbers), np.append(masks, unused), np.append(constants, unused)
        self._words = tuple(np.append(some, more) for some, more in zip(self._words, added, strict=True))
        return True

    def empty(self, number: int) -> Columns | None:
        """Return what is stored of a topic as columns, and store it no longer; None if there is nothing.

        Raises
        ------
        MessageError
            A message can't be decoded.
        """
        topic = self.topics[number]
        if not self.counts[number, 1]:
            return None
        self.counts[number, 1] = 0
        odd, topic.odd = topic.odd, []
        parts = [*self._from_lanes(topic), *_decode_each(topic, odd)]
        columns, rows = zip(*parts, strict=True)
        return join_columns(columns, rows)

    def _from_lanes(self, topic: Topic) -> list[tuple[Columns, NDArray[np.int64]]]:
        parts = []
        for lane, layout in topic.lanes:
            count, width, begin = self._lanes[lane, COUNT], 2 + len(layout.numbers), self._lanes[lane, STORE]
            self._lanes[lane, COUNT] = 0
            if count:
                # One copy, and the columns are views of it: each to be copied by itself takes four times as long.
                rows = self._store[begin : begin + count * width].reshape(count, width).copy()
                log_times, value = rows[:, 0].view(np.int64), layout.value(rows[:, 2:])
                columns = columns_of_rows(topic.name, topic.type_name, log_times, value)
                parts.append((columns, rows[:, 1].view(np.int64)))
        return parts


def _decode_each(
    topic: Topic, messages: list[tuple[int, int, bytes]]
) -> list[tuple[Columns, NDArray[np.int64]]]:
    """Return messages as columns with their rows, those with the same names together."""
    groups: dict[tuple[str, ...], list[tuple[int, int, Any]]] = {}
    for row, log_time, data in messages:
        value = decode(topic.type_name, data)
        groups.setdefault(getattr(value, 'names', ()), []).append((row, log_time, value))
    parts = []
    for group in groups.values():
        rows, log_times, values = zip(*group, strict=True)
        parts.append((make_columns(topic.name, topic.type_name, log_times, values), np.array(rows, np.int64)))
    return parts
