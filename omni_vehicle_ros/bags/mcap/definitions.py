"""Small records of an MCAP file that may be damaged: schemas, channels, statistics, metadata."""

import struct
from typing import NamedTuple

from omni_vehicle_ros.bags.mcap.checksum import crc32
from omni_vehicle_ros.bags.mcap.records import DamageError

LARGEST_SCHEMAS = 2**26
LARGEST_CHANNELS = 2**22
"""Size of all schemas and of all channels of a file above which more are taken for damage [byte]."""


class SchemaDefinition(NamedTuple):
    """A message type, as a file defines it."""

    name: str
    encoding: str
    data: bytes


class ChannelDefinition(NamedTuple):
    """A channel, as a file defines it; schema 0 means that it has none."""

    schema: int
    topic: str
    encoding: str
    metadata: tuple[tuple[str, str], ...]


class Attachment(NamedTuple):
    """A file in the file."""

    log_time: int
    create_time: int
    name: str
    media_type: str
    data: bytes


class Metadata(NamedTuple):
    """Words about the file."""

    name: str
    texts: dict[str, str]


class Statistics(NamedTuple):
    """What a file says that it holds."""

    messages: int
    chunks: int
    channel_messages: dict[int, int]


class Fields:
    """Takes the fields of a record one after the other."""

    def __init__(self, content: bytes) -> None:
        self._content = content
        self._position = 0

    def numbers(self, form: str) -> tuple[int, ...]:
        """Take little-endian numbers, by their `struct` form.

        Raises
        ------
        DamageError
            The record is too short.
        """
        try:
            found = struct.unpack_from('<' + form, self._content, self._position)
        except struct.error as error:
            raise DamageError('a record is too short') from error
        self._position += struct.calcsize('<' + form)
        return found

    def data(self, form: str = 'I') -> bytes:
        """Take bytes that come after their number."""
        (length,) = self.numbers(form)
        found = self._content[self._position : self._position + length]
        if len(found) < length:
            raise DamageError('a record is too short')
        self._position += length
        return found

    def text(self) -> str:
        """Take a text."""
        try:
            return self.data().decode()
        except UnicodeDecodeError as error:
            raise DamageError(f'a text makes no sense: {error.reason}') from error

    def texts(self) -> tuple[tuple[str, str], ...]:
        """Take a map of texts."""
        fields, found = Fields(self.data()), []
        while not fields.ended:
            found.append((fields.text(), fields.text()))
        return tuple(found)

    @property
    def ended(self) -> bool:
        """Whether nothing is left."""
        return self._position == len(self._content)


def read_header(content: bytes) -> str:
    """Read the profile of a file."""
    fields = Fields(content)
    profile, _ = fields.text(), fields.text()
    if not fields.ended:
        raise DamageError('the header makes no sense')
    return profile


def read_schema(content: bytes) -> tuple[int, SchemaDefinition]:
    """Read a schema and its number."""
    fields = Fields(content)
    (number,) = fields.numbers('H')
    schema = SchemaDefinition(fields.text(), fields.text(), fields.data())
    if not number or not fields.ended or not schema.name.isprintable():
        raise DamageError(f'schema {number} makes no sense')
    return number, schema


def read_channel(content: bytes) -> tuple[int, ChannelDefinition]:
    """Read a channel and its number."""
    fields = Fields(content)
    number, schema = fields.numbers('HH')
    channel = ChannelDefinition(schema, fields.text(), fields.text(), fields.texts())
    if not fields.ended or not channel.topic or not channel.topic.isprintable():
        raise DamageError(f'channel {number} makes no sense')
    return number, channel


def read_statistics(content: bytes) -> Statistics:
    """Read what a file says that it holds."""
    fields = Fields(content)
    messages, _, _, _, _, chunks, _, _ = fields.numbers('QHIIIIQQ')
    counts = fields.data()
    if len(counts) % 10:
        raise DamageError('the statistics make no sense')
    return Statistics(messages, chunks, dict(struct.iter_unpack('<HQ', counts)))


def read_attachment(content: bytes) -> Attachment:
    """Read an attachment, and compare it with its checksum."""
    fields = Fields(content)
    log_time, create_time = fields.numbers('QQ')
    attachment = Attachment(log_time, create_time, fields.text(), fields.text(), fields.data('Q'))
    (checksum,) = fields.numbers('I')
    if not fields.ended or (checksum and crc32(content[:-4]) != checksum):
        raise DamageError('an attachment does not match its checksum')
    return attachment


def read_metadata_record(content: bytes) -> Metadata:
    """Read words about the file."""
    fields = Fields(content)
    metadata = Metadata(fields.text(), dict(fields.texts()))
    if not fields.ended:
        raise DamageError('a metadata record makes no sense')
    return metadata


class Definitions:
    """The schemas and channels of one file, by number."""

    def __init__(self) -> None:
        self.schemas: dict[int, SchemaDefinition] = {}
        self.channels: dict[int, ChannelDefinition] = {}
        self._schema_size = 0
        self._channel_size = 0

    def add_schema(self, content: bytes) -> None:
        """Add a schema; one that is there already may be said again, but not another with its number."""
        number, schema = read_schema(content)
        if self.schemas.get(number, schema) != schema:
            raise DamageError(f'schema {number} is defined in two ways')
        self._schema_size += 0 if number in self.schemas else len(content)
        if self._schema_size > LARGEST_SCHEMAS:
            raise DamageError(f'the schemas have more than {LARGEST_SCHEMAS} bytes')
        self.schemas[number] = schema

    def add_channel(self, content: bytes) -> None:
        """Add a channel, as `add_schema` does."""
        number, channel = read_channel(content)
        if channel.schema and channel.schema not in self.schemas:
            raise DamageError(f'channel {number} refers to schema {channel.schema}, which is unknown')
        if self.channels.get(number, channel) != channel:
            raise DamageError(f'channel {number} is defined in two ways')
        self._channel_size += 0 if number in self.channels else len(content)
        if self._channel_size > LARGEST_CHANNELS:
            raise DamageError(f'the channels have more than {LARGEST_CHANNELS} bytes')
        self.channels[number] = channel
