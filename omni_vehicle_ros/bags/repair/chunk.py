"""Chunks of an MCAP file that may be damaged: checked, and read in pieces, so that no size in them is believed."""

import io
import os
import struct
from collections.abc import Iterator
from typing import IO, NamedTuple, cast

import lz4.frame  # type: ignore[import-untyped]
import zstandard

from omni_vehicle_ros.bags.mcap.checksum import crc32
from omni_vehicle_ros.bags.mcap.records import CHANNEL, LARGEST_CHUNK, MESSAGE, RECORD, SCHEMA, DamageError

LARGEST_RECORD = 2**28
"""Size of a record above which it is taken for damage [byte]: what is held in memory at a time."""

_PIECE = 2**20
_FIXED = struct.Struct('<QQQII')
_COMPRESSED = struct.Struct('<Q')
_LARGEST_WINDOW = 2**27
_ERRORS = (zstandard.ZstdError, RuntimeError, EOFError, OSError, ValueError)


class Chunk(NamedTuple):
    """What a chunk says of itself."""

    compression: str
    begin: int
    """Of the compressed records in the file."""
    length: int
    """Of the compressed records [byte]."""
    size: int
    """Of the records [byte]."""
    checksum: int
    """Of the records; 0: there is none."""
    times: tuple[int, int]
    """Log times of its first and last message [ns]."""


def read_chunk_header(file: IO[bytes], position: int, length: int) -> Chunk | None:
    """Return what the chunk whose content begins at ``position`` says; None if that contradicts its length."""
    head = os.pread(file.fileno(), _FIXED.size + 4 + _COMPRESSED.size, position)
    if len(head) < _FIXED.size + _COMPRESSED.size:
        return None
    first, last, size, checksum, letters = _FIXED.unpack_from(head)
    compression = head[_FIXED.size : _FIXED.size + min(letters, 4)]
    begin = _FIXED.size + letters + _COMPRESSED.size
    if compression not in (b'', b'lz4', b'zstd') or len(compression) != letters or size > LARGEST_CHUNK:
        return None
    if begin > len(head):
        return None
    (compressed,) = _COMPRESSED.unpack_from(head, begin - _COMPRESSED.size)
    if begin + compressed != length:
        return None
    return Chunk(compression.decode(), position + begin, compressed, size, checksum, (first, last))


class _Window(io.RawIOBase):
    """A part of a file."""

    def __init__(self, file: IO[bytes], begin: int, length: int) -> None:
        self._descriptor = file.fileno()
        self._position = begin
        self._end = begin + length

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: memoryview) -> int:  # type: ignore[override]
        found = os.pread(self._descriptor, min(len(buffer), self._end - self._position), self._position)
        buffer[: len(found)] = found
        self._position += len(found)
        return len(found)


def check_chunk(file: IO[bytes], chunk: Chunk) -> int:
    """Read a chunk through; return how many bytes its records have.

    Raises
    ------
    DamageError
        It can't be decompressed, or doesn't have the size or the checksum that it should.
    """
    stream, size, checksum = _open(file, chunk), 0, 0
    try:
        while piece := stream.read(min(_PIECE, chunk.size + 1 - size)):
            size += len(piece)
            checksum = crc32(piece, checksum)
    except _ERRORS as error:
        raise DamageError(f'a chunk can not be decompressed: {error}') from error
    if size != chunk.size or (chunk.checksum and checksum != chunk.checksum):
        raise DamageError('a chunk does not match its checksum')
    return size


def chunk_records(file: IO[bytes], chunk: Chunk) -> Iterator[tuple[int, int, bytes]]:
    """Give place, opcode and content of the records in a chunk, up to where it breaks off.

    Raises
    ------
    DamageError
        It doesn't end with the end of a record.
    """
    stream, left = _open(file, chunk), chunk.size
    try:
        while left > 0:
            header = stream.read(RECORD.size)
            if len(header) < RECORD.size:
                raise DamageError('a chunk ends in the middle of a record')
            opcode, length = RECORD.unpack(header)
            place = chunk.size - left
            left -= RECORD.size + length
            if opcode not in (SCHEMA, CHANNEL, MESSAGE):
                raise DamageError(f'a chunk holds a record of kind {opcode}, which has no place in it')
            if left < 0 or length > LARGEST_RECORD:
                raise DamageError(f'a chunk holds a record of {length} bytes, which is too long')
            content = stream.read(length)
            if len(content) < length:
                raise DamageError('a chunk ends in the middle of a record')
            yield place, opcode, content
    except _ERRORS as error:
        raise DamageError(f'a chunk can not be decompressed: {error}') from error


def _open(file: IO[bytes], chunk: Chunk) -> io.BufferedIOBase:
    window = _Window(file, chunk.begin, chunk.length)
    if chunk.compression == 'lz4':
        opened: io.BufferedIOBase = lz4.frame.LZ4FrameFile(window)
        return opened
    if chunk.compression == 'zstd':
        source = cast('IO[bytes]', window)
        reader = zstandard.ZstdDecompressor(max_window_size=_LARGEST_WINDOW).stream_reader(source)
        return io.BufferedReader(reader, _PIECE)
    return io.BufferedReader(window, _PIECE)
