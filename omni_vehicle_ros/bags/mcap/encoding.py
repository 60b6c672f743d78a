"""Records of an MCAP file as bytes, the counterpart of `definitions` (MCAP specification, https://mcap.dev/spec)."""

import struct
from collections.abc import Iterable, Mapping
from typing import NamedTuple

from omni_vehicle_ros.bags.mcap.checksum import crc32
from omni_vehicle_ros.bags.mcap.definitions import Attachment, ChannelDefinition, Metadata, SchemaDefinition
from omni_vehicle_ros.bags.mcap.records import (
    ATTACHMENT,
    ATTACHMENT_INDEX,
    CHANNEL,
    CHUNK_INDEX,
    FILE_HEADER,
    METADATA,
    METADATA_INDEX,
    RECORD,
    SCHEMA,
    STATISTICS,
)

_SHORT, _LONG = struct.Struct('<H'), struct.Struct('<I')
_NUMBERS = struct.Struct('<HH')
_STATISTICS = struct.Struct('<QHIIIIQQ')
_PLACE = struct.Struct('<QQ')
_FOUR = struct.Struct('<QQQQ')
_THREE = struct.Struct('<QQQ')
_COUNT = struct.Struct('<HQ')


class Totals(NamedTuple):
    """What a file holds, as its statistics say it."""

    schemas: int
    channels: int
    attachments: int
    metadata: int
    chunks: int
    span: tuple[int, int]
    """Log times of the first and the last message [ns]; zeros without any."""
    channel_messages: Mapping[int, int]


class ChunkPlace(NamedTuple):
    """Where a chunk and its message indexes lie in the file, and what the chunk says."""

    begin: int
    length: int
    index_length: int
    span: tuple[int, int]
    """Log times of the first and the last message [ns]."""
    compression: str
    compressed: int
    """Size of the compressed records [byte]."""
    size: int
    """Of the records [byte]."""


def record(opcode: int, *parts: bytes) -> bytes:
    """Return a record of one kind."""
    content = b''.join(parts)
    return RECORD.pack(opcode, len(content)) + content


def header_record(profile: str, library: str) -> bytes:
    """Return the first record of a file."""
    return record(FILE_HEADER, _text(profile), _text(library))


def schema_record(number: int, schema: SchemaDefinition) -> bytes:
    """Return the record of a message type."""
    return record(SCHEMA, _SHORT.pack(number), _text(schema.name), _text(schema.encoding), _data(schema.data))


def channel_record(number: int, channel: ChannelDefinition) -> bytes:
    """Return the record of a channel."""
    numbers = _NUMBERS.pack(number, channel.schema)
    return record(CHANNEL, numbers, _text(channel.topic), _text(channel.encoding), _texts(channel.metadata))


def attachment_record(attachment: Attachment) -> bytes:
    """Return the record of a file in the file, with its checksum."""
    content = b''.join((
        _PLACE.pack(attachment.log_time, attachment.create_time), _text(attachment.name), _text(attachment.media_type),
        struct.pack('<Q', len(attachment.data)), attachment.data,
    ))
    return record(ATTACHMENT, content, _LONG.pack(crc32(content)))


def attachment_index_record(attachment: Attachment, begin: int, length: int) -> bytes:
    """Return the index of an attachment whose record begins at ``begin`` and has ``length`` bytes."""
    numbers = (attachment.log_time, attachment.create_time, len(attachment.data))
    names = _text(attachment.name), _text(attachment.media_type)
    return record(ATTACHMENT_INDEX, _PLACE.pack(begin, length), _THREE.pack(*numbers), *names)


def metadata_record(metadata: Metadata) -> bytes:
    """Return the record of words about the file."""
    return record(METADATA, _text(metadata.name), _texts(metadata.texts.items()))


def metadata_index_record(name: str, begin: int, length: int) -> bytes:
    """Return the index of words about the file whose record begins at ``begin`` and has ``length`` bytes."""
    return record(METADATA_INDEX, _PLACE.pack(begin, length), _text(name))


def statistics_record(totals: Totals) -> bytes:
    """Return what a file says that it holds."""
    counts = totals.channel_messages
    numbers = _STATISTICS.pack(
        sum(counts.values()), totals.schemas, totals.channels, totals.attachments, totals.metadata, totals.chunks,
        *totals.span,
    )
    return record(STATISTICS, numbers, _data(b''.join(_COUNT.pack(*item) for item in counts.items())))


def chunk_index_record(place: ChunkPlace, index_places: Mapping[int, int]) -> bytes:
    """Return the index of a chunk.

    Parameters
    ----------
    place
        Of the chunk.
    index_places
        Where the message index of each of its channels begins in the file.
    """
    return record(
        CHUNK_INDEX,
        _FOUR.pack(*place.span, place.begin, place.length),
        _data(b''.join(_COUNT.pack(*item) for item in index_places.items())),
        struct.pack('<Q', place.index_length), _text(place.compression), _PLACE.pack(place.compressed, place.size),
    )


def _data(content: bytes) -> bytes:
    return _LONG.pack(len(content)) + content


def _text(words: str) -> bytes:
    return _data(words.encode())


def _texts(pairs: Iterable[tuple[str, str]]) -> bytes:
    return _data(b''.join(_text(key) + _text(word) for key, word in pairs))
