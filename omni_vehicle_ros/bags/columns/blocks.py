"""Bags of any size as columns, block by block."""

import sys
from collections.abc import Callable, Collection, Generator, Iterator
from pathlib import Path
from typing import NamedTuple

from omni_vehicle_ros.bags.columns.columns import Columns
from omni_vehicle_ros.bags.columns.kernel import compiled_walk
from omni_vehicle_ros.bags.columns.lanes import Lanes, Topic
from omni_vehicle_ros.bags.mcap.file_reader import McapFileReader
from omni_vehicle_ros.bags.mcap.records import CHANNEL, RECORD, DamageError
from omni_vehicle_ros.bags.mcap.stream import MessageStream, read_messages
from omni_vehicle_ros.errors import BagError, MessageError
from omni_vehicle_ros.messages import VALUE_TYPES

ROWS = 65536
MOST_ROWS = 4096
"""Messages of a block at most, whatever is asked for: more would not be faster, for they leave the cache."""
MOST_BYTES = 32 * 2**20
"""Of the messages that are kept as they are, until they are decoded one by one."""
COMPILED_FROM = 8 * 2**20
"""Bytes of files from which on it is worth to load numba: that takes as long as to decode them without it."""


class Block(NamedTuple):
    """The next messages of a topic.

    Attributes
    ----------
    topic, type_name
        What they are.
    columns
        What they say, or why they can't be decoded.
    """

    topic: str
    type_name: str
    columns: Columns | MessageError


def read_blocks(
    path: Path | str, topics: Collection[str] | None = None, rows: int = ROWS
) -> Iterator[tuple[str, Columns]]:
    """Give the messages of a bag as columns, in bounded memory.

    Parameters
    ----------
    path
        A bag directory or one MCAP file; one that breaks off gives what there is.
    topics
        Full names; by default all whose type is known here.
    rows
        Messages of a block at most.

    Yields
    ------
    str
        Full name of a topic.
    Columns
        Its next messages. Blocks of one topic are in the order of recording; the others' are at most 4096 messages
        ahead or behind. ``names`` are those in this block.

    Raises
    ------
    BagError
        There is no such bag; messages can't be decoded; a topic that was asked for has an unknown type; a topic has
        several types.
    """
    yield from checked_blocks(read_messages(path), path, topics, rows)


def checked_blocks(
    stream: MessageStream, path: Path | str, topics: Collection[str] | None = None, rows: int = ROWS
) -> Iterator[tuple[str, Columns]]:
    """Do as `read_blocks` with a stream, which gets count and damage; ``path`` is for error messages."""

    def wanted(topic: str, type_name: str) -> bool:
        if topic not in topics if topics is not None else type_name not in VALUE_TYPES:
            return False
        check_type(path, topic, stream.types[topic], type_name)
        return True

    for topic, _, columns in BlockReader(stream, wanted, rows):
        if isinstance(columns, MessageError):
            raise BagError(f'{path}: topic {topic}: {columns}') from columns
        yield topic, columns


def check_type(path: Path | str, topic: str, type_name: str, other: str) -> None:
    """Check that messages have the type of their topic, and that it can be read.

    Raises
    ------
    BagError
        They don't, or it can't.
    """
    if other != type_name:
        raise BagError(f'{path}: topic {topic} has several types: {type_name}, {other}')
    if type_name not in VALUE_TYPES:
        raise BagError(f'{path}: topic {topic} has the type {type_name}, which is not read here')


class BlockReader:
    """Iterates over the blocks of a stream, once.

    Parameters
    ----------
    stream
        Gets count and damage, as if it were iterated over.
    wanted
        Tells by its name and its type whether a topic is to be decoded; is asked when the topic is met.
    rows
        Messages of a block at most.
    """

    def __init__(self, stream: MessageStream, wanted: Callable[[str, str], bool], rows: int = ROWS) -> None:
        compiled = 'numba' in sys.modules or stream.size >= COMPILED_FROM
        self._stream = stream
        self._wanted = wanted
        self._lanes = Lanes(compiled_walk() if compiled else None, min(rows, MOST_ROWS))
        self._numbers: dict[tuple[str, str], int] = {}

    @property
    def counts(self) -> dict[tuple[str, str], int]:
        """Messages so far, by topic and type."""
        return {key: int(self._lanes.counts[number, 0]) for key, number in self._numbers.items()}

    def __iter__(self) -> Iterator[Block]:
        """Give the blocks.

        Raises
        ------
        BagError
            A file can't be opened, or is no MCAP file.
        """
        for _ in self._stream.walk(self._fill):
            yield from self._empty()
        yield from self._empty()

    def _empty(self) -> Iterator[Block]:
        self._lanes.odd_bytes = 0
        for number, topic in enumerate(self._lanes.topics):
            columns: Columns | MessageError | None
            try:
                columns = self._lanes.empty(number)
            except MessageError as error:
                columns = error
            if columns is not None:
                yield Block(topic.name, topic.type_name, columns)

    def _fill(self, reader: McapFileReader) -> Generator[tuple[int, None], None, None]:
        """Take the messages of a file; when there is no more room, and at the end, give how many they were."""
        damage: DamageError | None = None
        given = self._taken
        self._lanes.forget_channels()
        try:
            for piece in reader.pieces():
                for _ in self._take(reader, piece):
                    yield self._taken - given, None
                    given = self._taken
        except DamageError as error:
            damage = error
        yield self._taken - given, None
        if damage is not None:
            raise damage

    @property
    def _taken(self) -> int:
        return int(self._lanes.counts[:, 0].sum())

    def _take(self, reader: McapFileReader, piece: bytes) -> Iterator[None]:
        """Take the messages of a piece; stop wherever there is no more room."""
        position = self._lanes.walk(piece, 0)
        while position < len(piece):
            after, message = reader.record(piece, position)
            if message is not None:
                number = self._numbers[message.topic, message.type_name]
                if self._lanes.is_full(number) or self._lanes.odd_bytes > MOST_BYTES:
                    yield
                if not self._lanes.take(number, message.log_time, message.data):
                    after = position
            elif piece[position] == CHANNEL:
                self._add_channel(reader, piece[position + RECORD.size :])
            position = self._lanes.walk(piece, after)

    def _add_channel(self, reader: McapFileReader, record: bytes) -> None:
        channel = int.from_bytes(record[:2], 'little')
        key = reader.channels[channel]
        if key not in self._numbers:
            self._numbers[key] = self._lanes.add_topic(Topic(*key, self._wanted(*key)))
        self._lanes.topic_of[channel] = self._numbers[key]
