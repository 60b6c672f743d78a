"""One MCAP file: what its chunks hold, and what its channels say."""

import struct
from collections.abc import Iterator
from typing import IO, NamedTuple

import lz4.frame  # type: ignore[import-untyped]
import zstandard

from omni_vehicle_ros.bags.mcap.checksum import crc32
from omni_vehicle_ros.bags.mcap.records import (
    CHANNEL,
    CHUNK,
    FOOTER,
    LARGEST_CHUNK,
    MAGIC,
    MESSAGE,
    RECORD,
    SCHEMA,
    DamageError,
    RecordFile,
)
from omni_vehicle_ros.errors import BagError

_CHUNK = struct.Struct('<QQQI')
_MESSAGE = struct.Struct('<HIQQ')
_LOOKED_AT = frozenset((FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK))


class RecordedMessage(NamedTuple):
    """One message of a bag."""

    topic: str
    type_name: str
    log_time: int
    """When it was recorded [ns]."""
    data: bytes


class ChannelFacts(NamedTuple):
    """What the first channel of a topic says beside topic and type."""

    encoding: str
    metadata: dict[str, str]


class McapFileReader:
    """Walks through the records of one file.

    Parameters
    ----------
    file
        What is read.
    types
        Gets the types of the topics met, by topic.
    facts
        Gets what their channels say beside, by topic.

    Attributes
    ----------
    channels
        Topic and type of each channel met so far, by its number.

    Raises
    ------
    DamageError
        In every method, where the file breaks off or makes no sense.
    """

    def __init__(self, file: IO[bytes], types: dict[str, str], facts: dict[str, ChannelFacts]) -> None:
        self._name = file.name
        self._records = RecordFile(file)
        self._types, self._facts = types, facts
        self._schemas: dict[int, str] = {}
        self.channels: dict[int, tuple[str, str]] = {}
        self._decompressor = zstandard.ZstdDecompressor()

    @property
    def position(self) -> int:
        """How far the file was read [byte]."""
        return self._records.position

    def pieces(self) -> Iterator[bytes]:
        """Give the records in each chunk, and each schema, channel and message outside of one.

        Raises
        ------
        BagError
            It is no MCAP file.
        """
        magic = self._records.skip_magic()
        if not MAGIC.startswith(magic):
            raise BagError(f'{self._name} is not an MCAP file: it begins with {magic.hex(" ")}')
        kind = 0
        while kind != FOOTER:
            kind, content = self._records.next(_LOOKED_AT)
            if kind == CHUNK:
                yield self._unpack_chunk(content)
            elif kind != FOOTER:
                yield RECORD.pack(kind, len(content)) + content
        if self._records.skip_magic() != MAGIC:
            raise self._records.broken_off()

    def record(self, piece: bytes, position: int) -> tuple[int, RecordedMessage | None]:
        """Read one record of a piece.

        Returns
        -------
        int
            Where it ends.
        RecordedMessage or None
            Of one that is a message.
        """
        if position + RECORD.size > len(piece):
            raise DamageError('a chunk ends in the middle of a record')
        opcode, length = RECORD.unpack_from(piece, position)
        position += RECORD.size
        if length > len(piece) - position:
            raise DamageError('a chunk ends in the middle of a record')
        end = position + length
        return end, self._read_record(opcode, piece[position:end])

    def _read_record(self, opcode: int, content: bytes) -> RecordedMessage | None:
        try:
            if opcode == MESSAGE:
                channel, _, log_time, _ = _MESSAGE.unpack_from(content)
                if log_time >= 2**63:
                    raise DamageError(f'the time {log_time} ns is outside that of ROS, 0 .. 2^63 - 1')
                topic, type_name = self.channels[channel]
                return RecordedMessage(topic, type_name, log_time, content[_MESSAGE.size :])
            if opcode == SCHEMA:
                self._schemas[_short(content, 0)] = _string(content, 2)
            elif opcode == CHANNEL:
                self._add_channel(_short(content, 0), _short(content, 2), _texts(content, 4))
        except (struct.error, UnicodeDecodeError) as error:
            raise DamageError(f'a record makes no sense: {error}') from error
        except KeyError as error:
            raise DamageError(f'a record refers to number {error}, which is unknown') from error
        return None

    def _add_channel(self, channel: int, schema: int, texts: list[str]) -> None:
        topic, encoding, *words = texts
        type_name = self._schemas[schema] if schema else ''
        if not (topic + type_name).isprintable():
            raise DamageError(f'topic {topic!r} of type {type_name!r} makes no sense')
        self.channels[channel] = topic, type_name
        self._types.setdefault(topic, type_name)
        self._facts.setdefault(topic, ChannelFacts(encoding, dict(zip(words[::2], words[1::2], strict=True))))

    def _unpack_chunk(self, content: memoryview) -> bytes:
        """Return the records in a chunk."""
        try:
            _, _, size, checksum = _CHUNK.unpack_from(content)
            compression = _string(content, _CHUNK.size)
            begin = _CHUNK.size + 4 + len(compression.encode())
            (length,) = struct.unpack_from('<Q', content, begin)
        except (struct.error, UnicodeDecodeError) as error:
            raise DamageError(f'a chunk makes no sense: {error}') from error
        compressed = content[begin + 8 : begin + 8 + length]
        if size > LARGEST_CHUNK or len(compressed) < length:
            raise DamageError(f'a chunk claims {length} bytes for {size}')
        records = self._decompress(compression, compressed, size)
        if len(records) != size or (checksum and crc32(records) != checksum):
            raise DamageError('a chunk does not match its checksum')
        return records

    def _decompress(self, compression: str, compressed: memoryview, size: int) -> bytes:
        """Return at most about ``size`` bytes, whatever ``compressed`` claims."""
        try:
            if compression == '':
                return bytes(compressed)
            if compression == 'zstd':
                if zstandard.frame_content_size(compressed) not in (-1, size):
                    raise DamageError('a chunk does not have the size that it should')
                return self._decompressor.decompress(compressed, max_output_size=size)
            if compression == 'lz4':
                return bytes(lz4.frame.LZ4FrameDecompressor().decompress(compressed, max_length=size))
        except (zstandard.ZstdError, RuntimeError, EOFError) as error:
            raise DamageError(f'a chunk can not be decompressed: {error}') from error
        raise DamageError(f'compression {compression!r} is unknown')


def _short(content: bytes, position: int) -> int:
    return int(struct.unpack_from('<H', content, position)[0])


def _string(content: bytes | memoryview, position: int) -> str:
    (length,) = struct.unpack_from('<I', content, position)
    begin = position + 4
    if begin + length > len(content):
        raise struct.error('a text reaches beyond its record')
    return str(content[begin : begin + length], 'utf-8')


def _texts(content: bytes, position: int) -> list[str]:
    """Return topic and encoding of a channel, and after them the words of its metadata: name, value, and so on."""
    found = [_string(content, position)]
    position += 4 + len(found[0].encode())
    found.append(_string(content, position))
    position += 4 + len(found[1].encode())
    (length,) = struct.unpack_from('<I', content, position)
    position, end = position + 4, position + 4 + length
    while position < end:
        found.append(_string(content, position))
        position += 4 + len(found[-1].encode())
    if position != end or len(found) % 2:
        raise struct.error('metadata reach beyond their record')
    return found
