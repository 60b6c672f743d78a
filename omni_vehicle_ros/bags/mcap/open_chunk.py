"""A chunk of an MCAP file while it is filled."""

import struct
from collections.abc import Callable, Iterator

import lz4.frame  # type: ignore[import-untyped]
import zstandard

from omni_vehicle_ros.bags.mcap.checksum import crc32
from omni_vehicle_ros.bags.mcap.records import CHUNK, MESSAGE, MESSAGE_INDEX, RECORD

COMPRESSIONS = {'none': '', 'lz4': 'lz4', 'zstd': 'zstd'}
"""The words for a compression, and those that stand for them in a file."""

NEVER = 2**64
"""Later than any time [ns]."""

_ENTRY = struct.Struct('<QQ')
_MESSAGE = struct.Struct('<BQHIQQ')
_MESSAGE_FIELDS = _MESSAGE.size - RECORD.size
_CHUNK_FIELDS = struct.Struct('<QQQII')
_LENGTH = struct.Struct('<Q')
_INDEX = struct.Struct('<BQHI')
_ZSTD_LEVEL = -1
"""What messages of a vehicle take hardly differs from level 3 (2 %); to write and to read them takes half the time."""


def compressor(compression: str) -> Callable[[bytes | bytearray], bytes]:
    """Return what compresses chunks, by a word of `COMPRESSIONS`; not to be shared by threads."""
    if compression == 'lz4':
        return lz4.frame.compress  # type: ignore[no-any-return]
    return zstandard.ZstdCompressor(level=_ZSTD_LEVEL).compress if compression == 'zstd' else bytes


class OpenChunk:
    """Records, and where the messages of each channel lie among them.

    Attributes
    ----------
    records
        As they will lie in the chunk.
    entries
        Entries of the message index by channel, in the order of their first messages: flat, ready to be written.
    first, last
        Log times of its messages [ns]; `NEVER` and 0 as long as there is none.
    """

    __slots__ = ('entries', 'first', 'last', 'records')

    def __init__(self) -> None:
        self.records = bytearray()
        self.entries: dict[int, bytearray] = {}
        self.first, self.last = NEVER, 0

    def add(self, channel: int, sequence: int, log_time: int, publish_time: int, data: bytes) -> int:
        """Add a message; return the size of the records [byte]."""
        records, entry = self.records, _ENTRY.pack(log_time, len(self.records))
        try:
            self.entries[channel] += entry
        except KeyError:
            self.entries[channel] = bytearray(entry)
        if log_time < self.first:
            self.first = log_time
        if log_time > self.last:
            self.last = log_time
        records += _MESSAGE.pack(MESSAGE, _MESSAGE_FIELDS + len(data), channel, sequence, log_time, publish_time)
        records += data
        return len(records)

    def counts(self) -> dict[int, int]:
        """Return the number of messages of each channel that has any."""
        return {channel: len(entries) // _ENTRY.size for channel, entries in self.entries.items()}

    def head(self, compression: str, compressed: int) -> bytes:
        """Return the beginning of the record of this chunk, up to its records, compressed to so many bytes."""
        word = compression.encode()
        length = _CHUNK_FIELDS.size + len(word) + _LENGTH.size + compressed
        fields = self.first, self.last, len(self.records), crc32(self.records), len(word)
        return b''.join(
            (RECORD.pack(CHUNK, length), _CHUNK_FIELDS.pack(*fields), word, _LENGTH.pack(compressed))
        )

    def indexes(self) -> Iterator[tuple[int, bytes]]:
        """Give each channel with its message index, a record."""
        for channel, entries in self.entries.items():
            length = _INDEX.size - RECORD.size + len(entries)
            yield channel, _INDEX.pack(MESSAGE_INDEX, length, channel, len(entries)) + entries
