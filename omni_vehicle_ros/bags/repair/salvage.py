"""What makes sense in one MCAP file that may be damaged: its messages, and whether it is whole."""

import os
import struct
from collections import Counter
from collections.abc import Iterator
from typing import IO, NamedTuple

from omni_vehicle_ros.bags.mcap.checksum import crc32
from omni_vehicle_ros.bags.mcap.definitions import (
    Attachment,
    Definitions,
    Fields,
    Metadata,
    Statistics,
    read_attachment,
    read_header,
    read_metadata_record,
    read_statistics,
)
from omni_vehicle_ros.bags.mcap.records import (
    ATTACHMENT,
    CHANNEL,
    CHUNK,
    DATA_END,
    FILE_HEADER,
    FOOTER,
    MAGIC,
    MESSAGE,
    MESSAGE_INDEX,
    METADATA,
    RECORD,
    SCHEMA,
    STATISTICS,
    DamageError,
)
from omni_vehicle_ros.bags.repair.chunk import LARGEST_RECORD, check_chunk, chunk_records
from omni_vehicle_ros.bags.repair.damaged_file import FIRST_OWN_OPCODE, MESSAGE_HEADER, DamagedFile, Record

LARGEST_EXTRAS = 1000
"""Attachments and metadata records of a file that are kept."""

_FOOTER = struct.Struct('<BQQQI')
_LAST = _FOOTER.size + len(MAGIC)
_ENTRY = struct.Struct('<QQ')
_PIECE = 2**20


class SavedMessage(NamedTuple):
    """A message as it lies in the file."""

    channel: int
    sequence: int
    log_time: int
    publish_time: int
    data: bytes


Saved = SavedMessage | Attachment | Metadata


class Salvage:
    """Iterates over all that makes sense in a file, in bounded memory.

    Attributes
    ----------
    source
        Where it is, and what is damaged.
    definitions
        Schemas and channels.
    profile
        Of the file.
    messages
        Given so far.
    unchecked
        Those of them that no checksum covers.
    private
        Records of kinds that MCAP leaves to applications, which are passed over.
    by_channel
        How many of each channel.
    span
        Log times of the first and the last of them [ns].
    """

    def __init__(self, file: IO[bytes]) -> None:
        self._file = file
        self.source = DamagedFile(file)
        self.definitions = Definitions()
        self.profile = 'ros2'
        self.messages = 0
        self.unchecked = 0
        self.private = 0
        self._chunks = 0
        self._extras = 0
        self.by_channel: Counter[int] = Counter()
        self.span = (0, 0)
        self._index = _ChunkIndex()
        self._data_ended = False
        self._statistics = self._read_summary()

    def __iter__(self) -> Iterator[Saved]:
        """Give what makes sense."""
        for record in self.source:
            try:
                if record.chunk is not None:
                    yield from self._chunk(record)
                else:
                    yield from self._bare_record(record)
            except DamageError as error:
                self.source.reject(record, error)
        self._compare()

    @property
    def whole(self) -> bool:
        """Whether no damage was found until now."""
        return not self.source.damage_count

    @property
    def lost_messages(self) -> tuple[int | None, bool]:
        """How many messages are lost, None if nobody knows, and whether that is all of them or the least."""
        if self._statistics:
            return max(self._statistics.messages - self.messages, 0), True
        if self.source.lost_bytes and not self._index.lost:
            return None, False
        return self._index.lost, not self.source.lost_bytes and self._data_ended

    def _bare_record(self, record: Record) -> Iterator[Saved]:
        opcode = record.opcode
        if opcode >= FIRST_OWN_OPCODE or opcode == FOOTER:
            self.private += opcode != FOOTER
            return
        if record.length > LARGEST_RECORD:
            raise DamageError(f'a record of {record.length} bytes is too long')
        if opcode == FILE_HEADER and record.position == len(MAGIC):
            self.profile = read_header(self._content(record))
        elif opcode == MESSAGE and (self._chunks or self._data_ended):  # no writer does both: a flipped bit in an index
            raise DamageError('a message lies outside of chunks in a file of chunks')
        elif opcode == MESSAGE:
            yield self._message(self._content(record))
            self.unchecked += 1
        elif opcode in (SCHEMA, CHANNEL):
            self._define(opcode, self._content(record))
        elif opcode == MESSAGE_INDEX:
            self._index.compare(self._content(record))
        elif opcode in (ATTACHMENT, METADATA):
            yield self._extra(opcode, self._content(record))
        elif opcode == DATA_END:
            self._end_data(record)
        elif opcode == CHUNK:
            self._index.begin()
            raise DamageError('a chunk contradicts itself')
        elif not self._data_ended:
            raise DamageError(f'a record of kind {opcode} has no place here')

    def _content(self, record: Record) -> bytes:
        return os.pread(self._file.fileno(), record.length, record.begin)

    def _chunk(self, record: Record) -> Iterator[SavedMessage]:
        chunk = record.chunk
        assert chunk is not None
        self._index.begin()
        self._chunks += 1
        if not record.cut:
            check_chunk(self._file, chunk)
        try:
            for place, opcode, content in chunk_records(self._file, chunk):
                try:
                    if opcode == MESSAGE:
                        message = self._message(content)
                        self._index.add(message.channel, message.log_time, place)
                        self.unchecked += record.cut or not chunk.checksum
                        yield message
                    else:
                        self._define(opcode, content)
                except DamageError as error:
                    self.source.note(f'byte {record.position}: in a chunk, {error}', RECORD.size + len(content))
            if self._index.times not in (None, chunk.times):
                self.source.note(f'byte {record.position}: the times of a chunk are wrong')
        except DamageError as error:
            if not record.cut:
                self.source.note(f'byte {record.position}: {error}')

    def _message(self, content: bytes) -> SavedMessage:
        if len(content) < MESSAGE_HEADER.size:
            raise DamageError('a message is too short')
        channel, sequence, log_time, publish_time = MESSAGE_HEADER.unpack_from(content)
        message = SavedMessage(channel, sequence, log_time, publish_time, content[MESSAGE_HEADER.size :])
        if message.channel not in self.definitions.channels:
            raise DamageError(f'a message is of channel {message.channel}, which is unknown')
        if max(message.log_time, message.publish_time) >= 2**63:
            raise DamageError(f'the time {message.log_time} ns is outside that of ROS, 0 .. 2^63 - 1')
        first, last = self.span if self.messages else (message.log_time, message.log_time)
        self.span = min(first, message.log_time), max(last, message.log_time)
        self.messages += 1
        self.by_channel[message.channel] += 1
        return message

    def _define(self, opcode: int, content: bytes) -> None:
        if opcode == SCHEMA:
            self.definitions.add_schema(content)
        else:
            self.definitions.add_channel(content)

    def _extra(self, opcode: int, content: bytes) -> Attachment | Metadata:
        self._extras += 1
        if self._extras > LARGEST_EXTRAS:
            raise DamageError(f'more than {LARGEST_EXTRAS} attachments and metadata records are not kept')
        return read_attachment(content) if opcode == ATTACHMENT else read_metadata_record(content)

    def _end_data(self, record: Record) -> None:
        (checksum,) = Fields(self._content(record)).numbers('I')
        self._data_ended = True
        if not checksum:
            return
        if self._checksum(0, record.position) != checksum:
            self.source.note('the data do not match their checksum')
        elif self.whole:
            self.unchecked = 0

    def _checksum(self, begin: int, end: int) -> int:
        checksum = 0
        for position in range(begin, end, _PIECE):
            checksum = crc32(os.pread(self._file.fileno(), min(_PIECE, end - position), position), checksum)
        return checksum

    def _read_summary(self) -> Statistics | None:
        """Take the definitions and the statistics at the end of the file, if they are sound."""
        size = self.source.size
        last = os.pread(self._file.fileno(), _LAST, max(size - _LAST, 0))
        if len(last) < _LAST or not last.endswith(MAGIC):
            return None
        opcode, length, position, _, checksum = _FOOTER.unpack_from(last)
        if (opcode, length) != (FOOTER, _FOOTER.size - RECORD.size) or not 0 < position <= size - _LAST:
            return None
        if checksum and crc32(last[: _FOOTER.size - 4], self._checksum(position, size - _LAST)) != checksum:
            self.source.note('the summary does not match its checksum')
            return None
        return self._summary_records(position, size - _LAST)

    def _summary_records(self, position: int, end: int) -> Statistics | None:
        statistics = None
        try:
            while position < end:
                opcode, length = RECORD.unpack(os.pread(self._file.fileno(), RECORD.size, position))
                position += RECORD.size
                if opcode in (SCHEMA, CHANNEL, STATISTICS) and length <= LARGEST_RECORD:
                    content = os.pread(self._file.fileno(), length, position)
                    if opcode == STATISTICS:
                        statistics = read_statistics(content)
                    else:
                        self._define(opcode, content)
                position += length
        except (DamageError, struct.error) as error:
            self.source.note(f'the summary makes no sense: {error}')
        return statistics

    def _compare(self) -> None:
        """Compare the file with what it says that it holds."""
        self._index.begin()
        told = self._statistics
        if not self.source.finished:
            return
        if told is None:
            self.source.note('the file does not say how many messages it has')
        elif (told.messages, told.chunks) != (self.messages, self._chunks):
            self.source.note(
                f'the file should have {told.messages} messages in {told.chunks} chunks, '
                f'but has {self.messages} in {self._chunks}'
            )
        elif {number: count for number, count in told.channel_messages.items() if count} != self.by_channel:
            self.source.note('the numbers of messages of the channels are wrong')


class _ChunkIndex:
    """Compares what a chunk holds with the indexes that come after it, in any order."""

    def __init__(self) -> None:
        self.lost = 0
        self._given = 0
        self._told = 0
        self._sums: Counter[int] = Counter()
        self.times: tuple[int, int] | None = None

    def begin(self) -> None:
        """Begin with a chunk; the one before it has had all its indexes."""
        self.lost += max(self._told - self._given, 0)
        self._given = self._told = 0
        self._sums.clear()
        self.times = None

    def add(self, channel: int, log_time: int, place: int) -> None:
        """Note a message of the chunk."""
        first, last = self.times or (log_time, log_time)
        self.times = min(first, log_time), max(last, log_time)
        self._given += 1
        self._sums[channel] += crc32(_ENTRY.pack(log_time, place))

    def compare(self, content: bytes) -> None:
        """Compare with an index.

        Raises
        ------
        DamageError
            It isn't that of the chunk.
        """
        fields = Fields(content)
        (channel,) = fields.numbers('H')
        entries = fields.data()
        if len(entries) % _ENTRY.size or not fields.ended:
            raise DamageError('an index makes no sense')
        self._told += len(entries) // _ENTRY.size
        places = range(0, len(entries), _ENTRY.size)
        if self._given and self._sums[channel] != sum(crc32(entries[at : at + _ENTRY.size]) for at in places):
            raise DamageError('an index is not that of its chunk')
