"""Reading MCAP files from begin to end, whole or broken (MCAP specification, https://mcap.dev/spec).

A file without its end, as a killed or full recorder leaves it, gives all messages up to where it breaks off.
"""

import re
import struct
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import IO, NamedTuple

import lz4.frame  # type: ignore[import-untyped]
import zstandard

from omni_vehicle_ros.errors import BagError

MAGIC = b'\x89MCAP0\r\n'
LARGEST_CHUNK = 2**30
"""Uncompressed size of a chunk above which it is taken for damage [byte]."""

FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK = 2, 3, 4, 5, 6

_RECORD = struct.Struct('<BQ')
_CHUNK = struct.Struct('<QQQI')
_MESSAGE = struct.Struct('<HIQQ')


class RecordedMessage(NamedTuple):
    """One message of a bag."""

    topic: str
    type_name: str
    log_time: int
    """When it was recorded [ns]."""
    data: bytes


class MessageStream:
    """Iterates over the messages of MCAP files, in the order of the files, in bounded memory.

    Parameters
    ----------
    paths
        The files.

    Attributes
    ----------
    types
        The types of the topics met so far, by topic.
    count
        Messages given so far.
    damage
        For each file that is damaged or not finished, up to where it was read and why no farther.
    """

    def __init__(self, paths: tuple[Path, ...]) -> None:
        self._paths = paths
        self.types: dict[str, str] = {}
        self.count = 0
        self.damage: list[str] = []

    @property
    def complete(self) -> bool:
        """Whether all that was read so far was whole."""
        return not self.damage

    def __iter__(self) -> Iterator[RecordedMessage]:
        """Give the messages.

        Raises
        ------
        BagError
            A file can't be opened, or is no MCAP file.
        """
        self.count = 0
        self.damage.clear()
        for path in self._paths:
            before = self.count
            try:
                with path.open('rb') as file:
                    for message in _FileReader(file, self.types):
                        self.count += 1
                        yield message
            except _DamageError as error:
                self.damage.append(f'{path}: {error}; {self.count - before} messages before that are good')
            except OSError as error:
                raise BagError(f'{path} can not be read: {error.strerror}') from error


def read_messages(path: Path | str) -> MessageStream:
    """Return the messages of a bag, in the order of recording.

    Parameters
    ----------
    path
        A bag directory (``metadata.yaml`` isn't needed) or one MCAP file.

    Raises
    ------
    BagError
        There is no such bag.
    """
    path = Path(path)
    if path.is_file():
        return MessageStream((path,))
    if not path.is_dir():
        raise BagError(f'{path} does not exist; name a bag directory or an MCAP file')
    files = tuple(sorted(path.glob('*.mcap'), key=_natural_order))
    if not files:
        raise BagError(f'{path} holds no MCAP file, so it is no bag that can be read here')
    return MessageStream(files)


def _natural_order(path: Path) -> list[tuple[int, str]]:
    """Order bag_2 before bag_10."""
    return [(int(part), '') if part.isdigit() else (-1, part) for part in re.split(r'([0-9]+)', path.name)]


class _DamageError(Exception):
    """The file breaks off or makes no sense here."""


class _FileReader:
    """Walks through the records of one file."""

    def __init__(self, file: IO[bytes], types: dict[str, str]) -> None:
        self._file = file
        self._types = types
        self._size = file.seek(0, 2)
        self._schemas: dict[int, str] = {}
        self._channels: dict[int, tuple[str, str]] = {}
        file.seek(0)

    def __iter__(self) -> Iterator[RecordedMessage]:
        magic = self._file.read(len(MAGIC))
        if not MAGIC.startswith(magic):
            raise BagError(f'{self._file.name} is not an MCAP file: it begins with {magic.hex(" ")}')
        opcode = 0
        while opcode != FOOTER:
            opcode, length = self._next_record()
            if opcode == CHUNK:
                yield from self._chunk(_unpack_chunk(self._read(length)))
            elif opcode in (SCHEMA, CHANNEL, MESSAGE):
                yield from self._record(opcode, self._read(length))
            else:
                self._file.seek(length, 1)
        if self._file.read(len(MAGIC)) != MAGIC:
            raise self._broken_off()

    def _next_record(self) -> tuple[int, int]:
        header = self._file.read(_RECORD.size)
        if len(header) < _RECORD.size:
            raise self._broken_off()
        opcode, length = _RECORD.unpack(header)
        if not opcode:
            raise _DamageError(f'byte {self._file.tell() - _RECORD.size} does not begin a record')
        if length > self._size - self._file.tell():
            raise self._broken_off()
        return opcode, length

    def _read(self, length: int) -> bytes:
        content = self._file.read(length)
        if len(content) < length:
            raise self._broken_off()
        return content

    def _broken_off(self) -> _DamageError:
        return _DamageError(f'the file ends after {self._size} bytes, in the middle')

    def _chunk(self, content: bytes) -> Iterator[RecordedMessage]:
        position = 0
        while position < len(content):
            if position + _RECORD.size > len(content):
                raise _DamageError('a chunk ends in the middle of a record')
            opcode, length = _RECORD.unpack_from(content, position)
            position += _RECORD.size
            if length > len(content) - position:
                raise _DamageError('a chunk ends in the middle of a record')
            yield from self._record(opcode, content[position : position + length])
            position += length

    def _record(self, opcode: int, content: bytes) -> tuple[RecordedMessage, ...]:
        try:
            if opcode == MESSAGE:
                channel, _, log_time, _ = _MESSAGE.unpack_from(content)
                if log_time >= 2**63:
                    raise _DamageError(f'the time {log_time} ns is outside that of ROS, 0 .. 2^63 - 1')
                topic, type_name = self._channels[channel]
                return (RecordedMessage(topic, type_name, log_time, content[_MESSAGE.size :]),)
            if opcode == SCHEMA:
                self._schemas[_short(content, 0)] = _string(content, 2)
            elif opcode == CHANNEL:
                self._add_channel(_short(content, 0), _short(content, 2), _string(content, 4))
        except (struct.error, UnicodeDecodeError) as error:
            raise _DamageError(f'a record makes no sense: {error}') from error
        except KeyError as error:
            raise _DamageError(f'a record refers to number {error}, which is unknown') from error
        return ()

    def _add_channel(self, channel: int, schema: int, topic: str) -> None:
        type_name = self._schemas[schema] if schema else ''
        if not (topic + type_name).isprintable():
            raise _DamageError(f'topic {topic!r} of type {type_name!r} makes no sense')
        self._channels[channel] = topic, type_name
        self._types.setdefault(topic, type_name)


def _short(content: bytes, position: int) -> int:
    return int(struct.unpack_from('<H', content, position)[0])


def _string(content: bytes, position: int) -> str:
    (length,) = struct.unpack_from('<I', content, position)
    begin = position + 4
    if begin + length > len(content):
        raise struct.error('a text reaches beyond its record')
    return content[begin : begin + length].decode()


def _unpack_chunk(content: bytes) -> bytes:
    """Return the records in a chunk."""
    try:
        _, _, size, checksum = _CHUNK.unpack_from(content)
        compression = _string(content, _CHUNK.size)
        begin = _CHUNK.size + 4 + len(compression.encode())
        (length,) = struct.unpack_from('<Q', content, begin)
    except (struct.error, UnicodeDecodeError) as error:
        raise _DamageError(f'a chunk makes no sense: {error}') from error
    compressed = content[begin + 8 : begin + 8 + length]
    if size > LARGEST_CHUNK or len(compressed) < length:
        raise _DamageError(f'a chunk claims {length} bytes for {size}')
    records = _decompress(compression, compressed, size)
    if len(records) != size or (checksum and zlib.crc32(records) != checksum):
        raise _DamageError('a chunk does not match its checksum')
    return records


def _decompress(compression: str, compressed: bytes, size: int) -> bytes:
    """Return at most about ``size`` bytes, whatever ``compressed`` claims."""
    try:
        if compression == '':
            return compressed
        if compression == 'zstd':
            if zstandard.frame_content_size(compressed) not in (-1, size):
                raise _DamageError('a chunk does not have the size that it should')
            return zstandard.ZstdDecompressor().decompress(compressed, max_output_size=size)
        if compression == 'lz4':
            return bytes(lz4.frame.LZ4FrameDecompressor().decompress(compressed, max_length=size))
    except (zstandard.ZstdError, RuntimeError, EOFError) as error:
        raise _DamageError(f'a chunk can not be decompressed: {error}') from error
    raise _DamageError(f'compression {compression!r} is unknown')
