"""The records of an MCAP file, one after the other (MCAP specification, https://mcap.dev/spec)."""

import os
import struct
from collections.abc import Collection
from typing import IO

MAGIC = b'\x89MCAP0\r\n'
LARGEST_CHUNK = 2**30
"""Size of a chunk, uncompressed, or of any record above which it is taken for damage [byte]."""

FILE_HEADER, FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, MESSAGE_INDEX, CHUNK_INDEX = 1, 2, 3, 4, 5, 6, 7, 8
ATTACHMENT, ATTACHMENT_INDEX, STATISTICS, METADATA, METADATA_INDEX, SUMMARY_OFFSET, DATA_END = 9, 10, 11, 12, 13, 14, 15

RECORD = struct.Struct('<BQ')
"""Kind and length of a record, before its content."""

_unpack, _HEADER = RECORD.unpack_from, RECORD.size

_WINDOW = 2**18


class DamageError(Exception):
    """The file breaks off or makes no sense here."""


class RecordFile:
    """Goes from record to record of a file.

    It is read ahead in windows: most records are of an index, short and to be passed over.

    Parameters
    ----------
    file
        Whose content is read, its position neither used nor changed.

    Attributes
    ----------
    position
        Where the next record begins.

    Raises
    ------
    DamageError
        In every method, where the file breaks off or makes no sense.
    """

    def __init__(self, file: IO[bytes]) -> None:
        self.position = 0
        self._descriptor = file.fileno()
        self._size = os.fstat(self._descriptor).st_size
        self._window = b''
        self._begin = 0  # of the window

    def skip_magic(self) -> bytes:
        """Return the first or last bytes of the file, which show that it is one, and go on behind them."""
        length = min(len(MAGIC), self._size - self.position)
        self.position += length
        return self._read(self.position - length, length).tobytes()

    def next(self, kinds: Collection[int]) -> tuple[int, memoryview]:
        """Return kind and content of the next record of one of some kinds, and go on behind it."""
        window, begin = self._window, self._begin
        offset, last = self.position - begin, len(window) - RECORD.size
        kind = 0
        while kind not in kinds:
            if not 0 <= offset <= last:
                self._read(begin + offset, RECORD.size)
                window, begin, offset = self._window, self._begin, begin + offset - self._begin
                last = len(window) - RECORD.size
            kind, length = _unpack(window, offset)
            if not kind:
                raise DamageError(f'byte {begin + offset} does not begin a record')
            offset += _HEADER + length
        self.position = begin + offset
        if self.position <= self._size and length > LARGEST_CHUNK:
            raise DamageError(f'a record claims {length} bytes, more than {LARGEST_CHUNK}')
        return kind, self._read(self.position - length, length)

    def broken_off(self) -> DamageError:
        """Return the error of a file that does not go on."""
        return DamageError(f'the file ends after {self._size} bytes, in the middle')

    def _read(self, position: int, length: int) -> memoryview:
        if position + length > self._size:
            raise self.broken_off()
        offset = position - self._begin
        if not 0 <= offset <= len(self._window) - length:
            self._window = os.pread(self._descriptor, max(length, _WINDOW), position)
            self._begin, offset = position, 0
            if len(self._window) < length:
                raise self.broken_off()
        return memoryview(self._window)[offset : offset + length]
