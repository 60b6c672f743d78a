"""The records of an MCAP file that may be damaged, one after the other; past damage, the next that makes sense."""

import os
import re
import struct
from collections.abc import Iterator
from typing import IO, NamedTuple

from omni_vehicle_ros.bags.mcap.records import CHANNEL, CHUNK, FOOTER, MAGIC, MESSAGE, RECORD, SCHEMA
from omni_vehicle_ros.bags.repair.chunk import LARGEST_RECORD, Chunk, read_chunk_header

LAST_OPCODE, FIRST_OWN_OPCODE = 15, 128
MESSAGE_HEADER = struct.Struct('<HIQQ')
DAMAGES_SHOWN = 5
"""Damages that are described; of more, only their bytes are counted."""

_BLOCK = 2**20
_FOOTER_LENGTH = 20
_CHAIN = 3
"""Records in a row that must make sense where a bare message is taken for one: its bytes have no checksum."""
_SECOND_LOOKS = 4
"""How many times its own size a file may cost in records that make no sense and are searched for others."""

_ANY = re.compile(rb'(?=[\x03-\x06].{4}\x00{4})', re.DOTALL)
_CHUNKS = re.compile(rb'(?=\x06.{4}\x00{4})', re.DOTALL)


class Record(NamedTuple):
    """Where a record lies in the file."""

    opcode: int
    position: int
    """Of its first byte."""
    begin: int
    """Of its content."""
    length: int
    """Of its content [byte]."""
    chunk: Chunk | None = None
    """What it says, if it is a chunk."""
    cut: bool = False
    """Whether the file ends before it does."""

    @property
    def end(self) -> int:
        """Position of what comes after it."""
        return self.begin + self.length


class DamagedFile:
    """Iterates over the records of a file. Time is bounded by its size, memory by a constant.

    Whoever finds that the content of a record makes no sense says so by `reject`.

    Attributes
    ----------
    size
        Of the file [byte].
    position
        How far the walk is [byte].
    finished
        Whether the footer was reached, at the end of the file.
    damages
        The first `DAMAGES_SHOWN` damages, in words.
    damage_count
        How many there are.
    lost_bytes
        In records that were rejected, and where there are none.
    """

    def __init__(self, file: IO[bytes]) -> None:
        self._descriptor = file.fileno()
        self._file = file
        self.size = os.fstat(self._descriptor).st_size
        self.position = 0
        self.finished = False
        self.damages: list[str] = []
        self.damage_count = 0
        self.lost_bytes = 0
        self._chunked = False
        self._rejected = False
        self._second_looks = _SECOND_LOOKS * self.size

    def __iter__(self) -> Iterator[Record]:
        """Give the records up to the footer, or the end of the file."""
        self._begin()
        while self.position < self.size and not self.finished:
            record = self._record(self.position)
            if record is None:
                yield from self._pass_damage()
                continue
            self._chunked |= record.opcode == CHUNK
            self.finished = record.opcode == FOOTER
            self._rejected = False
            yield record
            self.position = self._after(record)
        if not self.finished:
            self.note('the file has no end')
        elif self.read(self.size - len(MAGIC), len(MAGIC)) != MAGIC:
            self.note('the file does not end as an MCAP file does')

    def read(self, position: int, length: int) -> bytes:
        """Read a part of the file, as far as it goes."""
        return os.pread(self._descriptor, length, position)

    def note(self, words: str, lost_bytes: int = 0) -> None:
        """Note damage."""
        if self.damage_count < DAMAGES_SHOWN:
            self.damages.append(words)
        self.damage_count += 1
        self.lost_bytes += lost_bytes

    def reject(self, record: Record, reason: object) -> None:
        """Say that the content of the record given last makes no sense."""
        self._rejected = True
        self.note(f'byte {record.position}: {reason}', record.end - record.position)

    def _begin(self) -> None:
        magic = self.read(0, len(MAGIC))
        if magic != MAGIC:
            self.note('the file does not begin as an MCAP file does')
        if magic == MAGIC or self._header(len(MAGIC)):
            self.position = len(MAGIC)

    def _header(self, position: int) -> tuple[int, int] | None:
        """Return opcode and length, if a record may begin here and end in the file."""
        header = self.read(position, RECORD.size)
        if len(header) < RECORD.size:
            return None
        opcode, length = RECORD.unpack(header)
        end = position + RECORD.size + length
        if not (0 < opcode <= LAST_OPCODE or opcode >= FIRST_OWN_OPCODE) or end > self.size:
            return None
        if opcode == FOOTER and (length, end + len(MAGIC)) != (_FOOTER_LENGTH, self.size):
            return None
        return opcode, length

    def _record(self, position: int) -> Record | None:
        header = self._header(position)
        if header is None:
            return None
        opcode, length = header
        begin = position + RECORD.size
        chunk = read_chunk_header(self._file, begin, length) if opcode == CHUNK else None
        if opcode == CHUNK and chunk is None and not self._follows(begin + length):
            self._chunked = True
            return None
        return Record(opcode, position, begin, length, chunk)

    def _follows(self, position: int) -> bool:
        """Tell whether what comes after a record makes sense."""
        header = self._header(position)
        return header is not None and header[0] <= LAST_OPCODE

    def _after(self, record: Record) -> int:
        if not self._rejected or self._follows(record.end):
            return record.end
        self._second_looks -= record.chunk.size if record.chunk else record.length
        if self._second_looks < 0:
            return record.end
        found = self._search(record.position + 1)
        self.lost_bytes += found - record.end
        return found

    def _pass_damage(self) -> Iterator[Record]:
        """Go on with the next record that makes sense; give a chunk that the file ends in."""
        begin = self.position
        cut = self._cut_chunk(begin)
        self.position = self._search(begin + 1)
        lost = self.position - begin
        if cut and self.position == self.size:
            self.note(f'byte {begin}: the file ends in the middle of a chunk', lost)
            yield cut
            return
        self.note(f'byte {begin}: no record that makes sense in {lost} bytes', lost)

    def _cut_chunk(self, position: int) -> Record | None:
        header = self.read(position, RECORD.size)
        if len(header) < RECORD.size or header[0] != CHUNK:
            return None
        self._chunked = True
        begin = position + RECORD.size
        chunk = read_chunk_header(self._file, begin, RECORD.unpack(header)[1])
        if chunk is None:
            return None
        return Record(CHUNK, position, begin, self.size - begin, chunk, cut=True)

    def _search(self, position: int) -> int:
        """Return where the next record that makes sense begins; the size of the file if there is none."""
        pattern = _CHUNKS if self._chunked else _ANY
        while position < self.size:
            block = self.read(position, _BLOCK + RECORD.size - 1)
            for match in pattern.finditer(block):
                if self._makes_sense(position + match.start()):
                    return position + match.start()
            position += _BLOCK
        return self.size

    def _makes_sense(self, position: int) -> bool:
        """Tell whether a record begins here, more strictly than `_record` where it follows another."""
        header = self._header(position)
        if header is None:
            return False
        opcode, length = header
        end = position + RECORD.size + length
        if opcode == CHUNK:
            return read_chunk_header(self._file, position + RECORD.size, length) is not None
        if opcode in (SCHEMA, CHANNEL, MESSAGE) and length > LARGEST_RECORD:
            return False
        for _ in range(_CHAIN):
            following = self._header(end)
            if following is None or following[0] > LAST_OPCODE:
                return False
            if following[0] == FOOTER:
                return True
            end += RECORD.size + following[1]
        return True
