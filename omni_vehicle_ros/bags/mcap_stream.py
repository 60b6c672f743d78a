"""Reading MCAP files from begin to end, whole or broken (MCAP specification, https://mcap.dev/spec).

A file without its end, as a killed or full recorder leaves it, gives all messages up to where it breaks off.
"""

import re
import struct
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import IO, NamedTuple, TypeVar

import lz4.frame  # type: ignore[import-untyped]
import zstandard

from omni_vehicle_ros.errors import BagError

MAGIC = b'\x89MCAP0\r\n'
LARGEST_CHUNK = 2**30
"""Uncompressed size of a chunk above which it is taken for damage [byte]."""

FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK = 2, 3, 4, 5, 6

T = TypeVar('T')

RECORD = struct.Struct('<BQ')
_CHUNK = struct.Struct('<QQQI')
_MESSAGE = struct.Struct('<HIQQ')


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
    facts
        What their channels say beside, by topic.
    count
        Messages given so far.
    position
        Where reading is, in all files together [byte].
    damage
        For each file that is damaged or not finished, up to where it was read and why no farther.
    """

    def __init__(self, paths: tuple[Path, ...]) -> None:
        self._paths = paths
        self.types: dict[str, str] = {}
        self.facts: dict[str, ChannelFacts] = {}
        self.count = 0
        self.position = 0
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
        for _, message in self.walk(_messages):
            yield message

    @property
    def size(self) -> int:
        """All files together [byte].

        Raises
        ------
        BagError
            A file is gone.
        """
        try:
            return sum(path.stat().st_size for path in self._paths)
        except OSError as error:
            raise BagError(f'{error.filename} can not be read: {error.strerror}') from error

    def walk(self, read: 'Callable[[FileReader], Iterator[tuple[int, T]]]') -> 'Iterator[tuple[int, T]]':
        """Give what ``read`` finds in each file, and how many messages that is; note damage and go on.

        Raises
        ------
        BagError
            A file can't be opened, or is no MCAP file.
        """
        self.count = 0
        self.damage.clear()
        done = 0
        for path in self._paths:
            before = self.count
            try:
                with path.open('rb') as file:
                    for number, item in read(FileReader(file, self.types, self.facts)):
                        self.count += number
                        self.position = done + file.tell()
                        yield number, item
                    done += file.tell()
            except DamageError as error:
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
    return MessageStream(bag_files(path))


def bag_files(path: Path | str) -> tuple[Path, ...]:
    """Return the MCAP files of a bag, in the order of recording.

    Parameters
    ----------
    path
        A bag directory or one MCAP file.

    Raises
    ------
    BagError
        There is no such bag.
    """
    path = Path(path)
    if path.is_file():
        return (path,)
    if not path.is_dir():
        raise BagError(f'{path} does not exist; name a bag directory or an MCAP file')
    files = tuple(sorted(path.glob('*.mcap'), key=_natural_order))
    if not files:
        raise BagError(f'{path} holds no MCAP file, so it is no bag that can be read here')
    return files


def _natural_order(path: Path) -> list[tuple[int, str]]:
    """Order bag_2 before bag_10."""
    return [(int(part), '') if part.isdigit() else (-1, part) for part in re.split(r'([0-9]+)', path.name)]


class DamageError(Exception):
    """The file breaks off or makes no sense here."""


class FileReader:
    """Walks through the records of one file.

    Parameters
    ----------
    file
        To be read from its begin.
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
        self._file = file
        self._types, self._facts = types, facts
        self._size = file.seek(0, 2)
        self._next = 0  # where the next record begins
        self._schemas: dict[int, str] = {}
        self.channels: dict[int, tuple[str, str]] = {}
        self._decompressor = zstandard.ZstdDecompressor()
        file.seek(0)

    def pieces(self) -> Iterator[bytes]:
        """Give the records in each chunk, and each schema, channel and message outside of one.

        Raises
        ------
        BagError
            It is no MCAP file.
        """
        magic = self._file.read(len(MAGIC))
        if not MAGIC.startswith(magic):
            raise BagError(f'{self._file.name} is not an MCAP file: it begins with {magic.hex(" ")}')
        self._next = len(MAGIC)
        opcode = 0
        while opcode != FOOTER:
            opcode, length = self._next_record()
            if opcode == CHUNK:
                yield self._unpack_chunk(self._read(length))
            elif opcode in (SCHEMA, CHANNEL, MESSAGE):
                yield RECORD.pack(opcode, length) + self._read(length)
            else:
                self._file.seek(length, 1)
        if self._file.read(len(MAGIC)) != MAGIC:
            raise self._broken_off()

    def _next_record(self) -> tuple[int, int]:
        header = self._file.read(RECORD.size)
        if len(header) < RECORD.size:
            raise self._broken_off()
        opcode, length = RECORD.unpack(header)
        if not opcode:
            raise DamageError(f'byte {self._next} does not begin a record')
        self._next += RECORD.size + length
        if self._next > self._size:
            raise self._broken_off()
        return opcode, length

    def _read(self, length: int) -> bytes:
        content = self._file.read(length)
        if len(content) < length:
            raise self._broken_off()
        return content

    def _broken_off(self) -> DamageError:
        return DamageError(f'the file ends after {self._size} bytes, in the middle')

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

    def _unpack_chunk(self, content: bytes) -> bytes:
        """Return the records in a chunk."""
        try:
            _, _, size, checksum = _CHUNK.unpack_from(content)
            compression = _string(content, _CHUNK.size)
            begin = _CHUNK.size + 4 + len(compression.encode())
            (length,) = struct.unpack_from('<Q', content, begin)
        except (struct.error, UnicodeDecodeError) as error:
            raise DamageError(f'a chunk makes no sense: {error}') from error
        compressed = memoryview(content)[begin + 8 : begin + 8 + length]
        if size > LARGEST_CHUNK or len(compressed) < length:
            raise DamageError(f'a chunk claims {length} bytes for {size}')
        records = self._decompress(compression, compressed, size)
        if len(records) != size or (checksum and zlib.crc32(records) != checksum):
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


def _string(content: bytes, position: int) -> str:
    (length,) = struct.unpack_from('<I', content, position)
    begin = position + 4
    if begin + length > len(content):
        raise struct.error('a text reaches beyond its record')
    return content[begin : begin + length].decode()


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


def _messages(reader: FileReader) -> Iterator[tuple[int, RecordedMessage]]:
    for piece in reader.pieces():
        position = 0
        while position < len(piece):
            position, message = reader.record(piece, position)
            if message is not None:
                yield 1, message
