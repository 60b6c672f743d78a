"""Writing one MCAP file, in memory that does not grow with it (MCAP specification, https://mcap.dev/spec)."""

import struct
from collections import Counter
from contextlib import suppress
from pathlib import Path

from omni_vehicle_ros import __version__
from omni_vehicle_ros.bags.mcap.checksum import crc32
from omni_vehicle_ros.bags.mcap.definitions import Attachment, ChannelDefinition, Metadata, SchemaDefinition
from omni_vehicle_ros.bags.mcap.encoding import (
    ChunkPlace,
    Totals,
    attachment_index_record,
    attachment_record,
    channel_record,
    chunk_index_record,
    header_record,
    metadata_index_record,
    metadata_record,
    record,
    schema_record,
    statistics_record,
)
from omni_vehicle_ros.bags.mcap.open_chunk import COMPRESSIONS, NEVER, OpenChunk, compressor
from omni_vehicle_ros.bags.mcap.records import (
    ATTACHMENT_INDEX,
    CHANNEL,
    CHUNK_INDEX,
    DATA_END,
    FOOTER,
    MAGIC,
    METADATA_INDEX,
    RECORD,
    SCHEMA,
    STATISTICS,
    SUMMARY_OFFSET,
)
from omni_vehicle_ros.bags.mcap.spill import Spill
from omni_vehicle_ros.bags.mcap.whole_writes import write_whole

LIBRARY = f'omni_vehicle_ros {__version__}'

_CHECKSUM = struct.Struct('<I')
_GROUP = struct.Struct('<BQQ')
_FOOTER = struct.Struct('<QQ')


class McapWriter:
    """Writes a file in chunks, with message indexes, checksums and a summary; every method raises OSError.

    What the file says of its chunks comes at its end. Until then it waits in a `Spill` beside the file.

    Parameters
    ----------
    path
        Must not exist.
    profile
        Of the file, such as ``ros2``.
    compression
        A word of `COMPRESSIONS`.
    chunk_size
        Size of the records from which on a chunk is written, before compression [byte].

    Attributes
    ----------
    position
        What was handed to the system [byte]; less than a chunk may wait beside it.
    """

    def __init__(self, path: Path, profile: str, compression: str, chunk_size: int) -> None:
        self.position = 0
        self._file = open(path, 'xb', buffering=0)  # noqa: SIM115  (closed by finish and abandon)
        self._chunk_size = chunk_size
        self._compression, self._compress = COMPRESSIONS[compression], compressor(compression)
        self._chunk = OpenChunk()
        self._checksum = 0
        self._schemas: dict[int, bytes] = {}
        self._channels: dict[int, bytes] = {}
        self._chunk_indexes = Spill(path.parent)
        self._extra_indexes: dict[int, list[bytes]] = {ATTACHMENT_INDEX: [], METADATA_INDEX: []}
        self._chunks = 0
        self._counts: Counter[int] = Counter()
        self._first, self._last = NEVER, 0
        self._put(MAGIC, header_record(profile, LIBRARY))

    @property
    def begin(self) -> int | None:
        """Log time of the earliest message so far [ns], if there is any."""
        first = min(self._first, self._chunk.first)
        return None if first == NEVER else first

    @property
    def span(self) -> tuple[int, int]:
        """Log times of the first and the last message so far [ns]; zeros without any."""
        return self.begin or 0, max(self._last, self._chunk.last)

    @property
    def counts(self) -> Counter[int]:
        """Messages so far of each channel that has any."""
        return self._counts + Counter(self._chunk.counts())

    def add_schema(self, number: int, schema: SchemaDefinition) -> None:
        """Define a message type, before the first channel of it."""
        self._schemas[number] = schema_record(number, schema)
        self._chunk.records += self._schemas[number]

    def add_channel(self, number: int, channel: ChannelDefinition) -> None:
        """Define a channel, before its first message."""
        self._channels[number] = channel_record(number, channel)
        self._chunk.records += self._channels[number]

    def add_message(self, channel: int, sequence: int, log_time: int, publish_time: int, data: bytes) -> None:
        """Write a message of a channel that is defined; times in ns."""
        if self._chunk.add(channel, sequence, log_time, publish_time, data) > self._chunk_size:
            self.flush()

    def add_attachment(self, attachment: Attachment) -> None:
        """Write a file into the file."""
        written = attachment_record(attachment)
        index = attachment_index_record(attachment, self.position, len(written))
        self._put(written)
        self._extra_indexes[ATTACHMENT_INDEX].append(index)

    def add_metadata(self, metadata: Metadata) -> None:
        """Write words about the file."""
        written = metadata_record(metadata)
        index = metadata_index_record(metadata.name, self.position, len(written))
        self._put(written)
        self._extra_indexes[METADATA_INDEX].append(index)

    def flush(self) -> None:
        """Hand all messages to the system: the chunk is written, full or not."""
        chunk = self._chunk
        if not chunk.entries:
            return
        compressed = self._compress(chunk.records)
        head = chunk.head(self._compression, len(compressed))
        begin, length = self.position, len(head) + len(compressed)
        place, places, indexes = begin + length, {}, []
        for channel, index in chunk.indexes():
            places[channel] = place
            place += len(index)
            indexes.append(index)
        self._put(head, compressed, *indexes)
        span = chunk.first, chunk.last
        said = ChunkPlace(
            begin, length, place - begin - length, span, self._compression, len(compressed), len(chunk.records)
        )
        self._chunk_indexes.add(chunk_index_record(said, places))
        self._chunks += 1
        self._counts.update(chunk.counts())
        self._first, self._last = min(self._first, chunk.first), max(self._last, chunk.last)
        self._chunk = OpenChunk()

    def finish(self) -> None:
        """Write the summary, and close."""
        self.flush()
        self._put(record(DATA_END, _CHECKSUM.pack(self._checksum)))
        begin, self._checksum = self.position, 0
        groups = self._put_summary()
        offsets_begin = self.position
        self._put(*(record(SUMMARY_OFFSET, _GROUP.pack(*group)) for group in groups))
        self._put(RECORD.pack(FOOTER, _FOOTER.size + _CHECKSUM.size), _FOOTER.pack(begin, offsets_begin))
        self._put(_CHECKSUM.pack(self._checksum), MAGIC)
        self._chunk_indexes.close()
        self._file.close()

    def abandon(self) -> None:
        """Close as it is."""
        with suppress(OSError):
            self._chunk_indexes.close()
        with suppress(OSError):
            self._file.close()

    def _put_summary(self) -> list[tuple[int, int, int]]:
        """Write the groups of the summary; return kind, begin and length of each that isn't empty."""
        totals = Totals(
            len(self._schemas), len(self._channels), len(self._extra_indexes[ATTACHMENT_INDEX]),
            len(self._extra_indexes[METADATA_INDEX]), self._chunks, self.span, self.counts,
        )
        groups = []
        for opcode, pieces in (
            (SCHEMA, self._schemas.values()),
            (CHANNEL, self._channels.values()),
            (STATISTICS, (statistics_record(totals),)),
            (CHUNK_INDEX, self._chunk_indexes.pieces()),
            *self._extra_indexes.items(),
        ):
            begin = self.position
            for piece in pieces:
                self._put(piece)
            if self.position > begin:
                groups.append((opcode, begin, self.position - begin))
        return groups

    def _put(self, *parts: bytes) -> None:
        """Write parts in one go."""
        data = b''.join(parts)
        write_whole(self._file, data)
        self.position += len(data)
        self._checksum = crc32(data, self._checksum)
