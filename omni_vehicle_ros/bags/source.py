"""Messages of any rosbag2 bag one after the other, as bytes, and what the bag says about their topics."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

from omni_vehicle_ros.bags.bag_contents import read_metadata
from omni_vehicle_ros.bags.mcap.definitions import SchemaDefinition
from omni_vehicle_ros.bags.mcap.file_reader import ChannelFacts, RecordedMessage
from omni_vehicle_ros.bags.mcap.records import MAGIC
from omni_vehicle_ros.bags.mcap.stream import MessageStream, bag_files
from omni_vehicle_ros.bags.metadata import SECOND, OfferedQos
from omni_vehicle_ros.bags.offers import BROKEN_YAML, convert_offers, read_offers
from omni_vehicle_ros.errors import BagError

if TYPE_CHECKING:
    from rosbags.interfaces import Connection

CDR = 'cdr'


class TopicFacts(NamedTuple):
    """What a bag says about a topic."""

    type_name: str
    offers: tuple[OfferedQos, ...] = ()
    """What its publishers offered, one each; empty if that is not known."""
    encoding: str = CDR
    """How the bytes are to be read."""
    type_hash: str = ''
    """Of its type (REP-2016), empty if that is not known."""


class Source(Protocol):
    """A bag that is read from begin to end, as often as wanted, in bounded memory."""

    @property
    def topics(self) -> Mapping[str, TopicFacts]:
        """The topics known so far; one is known at the latest when its first message is given."""

    @property
    def damage(self) -> list[str]:
        """For each file that is damaged, up to where it was read and why no farther."""

    def __iter__(self) -> Iterator[RecordedMessage]:
        """Give the messages in the order of the bag; raises BagError if it can't be read."""


def open_source(path: Path | str) -> Source:
    """Return the messages of a bag: MCAP, or what else ``rosbags`` reads.

    Parameters
    ----------
    path
        A bag directory, or one of its files.

    Raises
    ------
    BagError
        There is no such bag, or it can't be read.
    """
    path = Path(path)
    if not path.exists():
        raise BagError(f'{path} does not exist; name a bag directory, or an MCAP or db3 file')
    if _is_mcap(path):
        return McapSource(path)
    return RosbagsSource(path)


def _is_mcap(path: Path) -> bool:
    if path.is_dir():
        return any(path.glob('*.mcap'))
    try:
        with path.open('rb') as file:
            return path.suffix == '.mcap' or file.read(len(MAGIC)) == MAGIC
    except OSError as error:
        raise BagError(f'{path} can not be read: {error.strerror}') from None


class McapSource:
    """A bag of MCAP files, whole or broken."""

    def __init__(self, path: Path) -> None:
        self._stream = MessageStream(bag_files(path))
        self._told = _told_topics(path)

    @property
    def topics(self) -> Mapping[str, TopicFacts]:
        """Those met so far, and those that ``metadata.yaml`` tells of."""
        return {**self._told, **{topic: self._met(topic, facts) for topic, facts in self._stream.facts.items()}}

    def _met(self, topic: str, facts: ChannelFacts) -> TopicFacts:
        words, told = facts.metadata, self._told.get(topic, TopicFacts(''))
        offers = read_offers(words.get('offered_qos_profiles', '')) or told.offers
        type_hash = words.get('topic_type_hash', '') or told.type_hash
        return TopicFacts(self._stream.types[topic], offers, facts.encoding, type_hash)

    @property
    def damage(self) -> list[str]:
        """For each file that is damaged, up to where it was read and why no farther."""
        return self._stream.damage

    def __iter__(self) -> Iterator[RecordedMessage]:
        """Give the messages in the order of the files."""
        return iter(self._stream)


def _told_topics(path: Path) -> dict[str, TopicFacts]:
    """Return the topics with messages that ``metadata.yaml`` tells of; none if it is missing or broken."""
    try:
        rows = read_metadata(path).information.get('topics_with_message_count', [])
        return {row['topic_metadata']['name']: _told(row['topic_metadata']) for row in rows if row['message_count']}
    except (OSError, *BROKEN_YAML):
        return {}


def _told(topic: Mapping[str, Any]) -> TopicFacts:
    profiles = topic.get('offered_qos_profiles', '')
    offers = read_offers(profiles) if isinstance(profiles, str) else convert_offers(profiles)
    hashed = topic.get('type_description_hash', '')
    return TopicFacts(str(topic['type']), offers, str(topic['serialization_format']), str(hashed))


class RosbagsSource:
    """A bag that the package ``rosbags`` reads: sqlite3, or compressed as a whole.

    Attributes
    ----------
    schemas
        The definitions in it, by type.
    """

    def __init__(self, path: Path) -> None:
        from rosbags.rosbag2 import Reader

        try:
            self._reader = Reader(path)
            with self._reader as reader:
                self.topics = {one.topic: _facts(one) for one in reader.connections if one.msgcount}
                self.schemas = dict(map(_schema, (one for one in reader.connections if one.msgdef.data)))
        except Exception as error:  # as below
            raise BagError(f'{path} is no bag that can be read here: {_one_line(error)}') from error
        self.damage: list[str] = []
        self._path = path

    def __iter__(self) -> Iterator[RecordedMessage]:
        """Give the messages by their time."""
        self.damage.clear()
        count = 0
        try:
            with self._reader as reader:
                for connection, time, data in reader.messages():
                    yield RecordedMessage(connection.topic, connection.msgtype, time, bytes(data))
                    count += 1
        except Exception as error:  # rosbags lets through what its decompressor, its database and a text may raise
            self.damage.append(f'{self._path}: {_one_line(error)}; {count} messages before that are good')


def _schema(connection: 'Connection') -> tuple[str, SchemaDefinition]:
    encoding = 'ros2idl' if connection.msgdef.format.name == 'IDL' else 'ros2msg'
    return connection.msgtype, SchemaDefinition(connection.msgtype, encoding, connection.msgdef.data.encode())


def _facts(connection: 'Connection') -> TopicFacts:
    offers = tuple(_offer(profile._asdict()) for profile in getattr(connection.ext, 'offered_qos_profiles', ()))
    encoding = getattr(connection.ext, 'serialization_format', CDR)
    return TopicFacts(connection.msgtype, offers, encoding, connection.digest)


def _offer(profile: Mapping[str, Any]) -> OfferedQos:
    """Return a quality of service of ``rosbags`` in rosbag2's words."""
    return OfferedQos(**{name: _plain(value) for name, value in profile.items()})


def _plain(value: Any) -> Any:
    if hasattr(value, 'nsec'):
        return min(value.sec * SECOND + value.nsec, OfferedQos._field_defaults['deadline'])
    return value.name.lower() if hasattr(value, 'name') else value


def _one_line(error: Exception) -> str:
    return ' '.join(str(error).split()) or type(error).__name__
