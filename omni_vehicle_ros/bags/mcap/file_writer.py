"""One MCAP file of a bag while it is written: it has all schemas and channels itself, so that it can be read alone."""

from collections.abc import Mapping
from pathlib import Path

from omni_vehicle_ros.bags.mcap.definitions import ChannelDefinition, Metadata, SchemaDefinition
from omni_vehicle_ros.bags.mcap.open_chunk import COMPRESSIONS
from omni_vehicle_ros.bags.mcap.writer import McapWriter
from omni_vehicle_ros.bags.metadata import FileRecord, TopicRecord, as_yaml, bag_information, qos_profiles
from omni_vehicle_ros.bags.schema import ENCODING

__all__ = ['BAG_RECORD', 'CHUNK_SIZE', 'COMPRESSIONS', 'McapFile', 'bag_record']

CHUNK_SIZE = 65536
"""A chunk is written when it is full or at a flush: what is lost at a kill is less than one."""

BAG_RECORD = 'rosbag2'
"""Name of the metadata record with the metadata of the bag."""


class McapFile:
    """A file that is written; every method raises OSError if the system refuses.

    Parameters
    ----------
    path
        Must not exist.
    compression
        A word of `COMPRESSIONS`.

    Attributes
    ----------
    path
        As given.
    """

    def __init__(self, path: Path, compression: str) -> None:
        self.path = path
        self._writer = McapWriter(path, 'ros2', compression, CHUNK_SIZE)
        self._schemas: dict[str, int] = {}
        self._channels: dict[str, int] = {}
        self._topics: list[TopicRecord] = []

    @property
    def size(self) -> int:
        """What was handed to the system [byte]; less than a chunk may wait beside it."""
        return self._writer.position

    @property
    def record(self) -> FileRecord:
        """What ``metadata.yaml`` says about this file."""
        return FileRecord(self.path.name, self._writer.span, sum(self._writer.counts.values()))

    @property
    def begin(self) -> int | None:
        """Log time of the earliest message [ns], if there is any."""
        return self._writer.begin

    def add_topic(self, topic: TopicRecord, definition: str) -> None:
        """Announce a topic, with the definition of its type."""
        kind = topic.type_name
        if kind not in self._schemas:
            self._schemas[kind] = len(self._schemas) + 1
            self._writer.add_schema(self._schemas[kind], SchemaDefinition(kind, ENCODING, definition.encode()))
        words = ('offered_qos_profiles', as_yaml(qos_profiles(topic.offers))), ('topic_type_hash', topic.type_hash)
        number = self._channels[topic.name] = len(self._channels) + 1
        self._writer.add_channel(number, ChannelDefinition(self._schemas[kind], topic.name, 'cdr', words))
        self._topics.append(topic)

    def write(self, name: str, data: bytes, log_time: int, publish_time: int, sequence: int) -> None:
        """Write one message of a topic that was announced."""
        self._writer.add_message(self._channels[name], sequence & 0xFFFFFFFF, log_time, publish_time, data)

    def flush(self) -> None:
        """Hand all that was written to the system."""
        self._writer.flush()

    def finish(self, custom: Mapping[str, str]) -> None:
        """Write index and summary, and close."""
        counts = self._writer.counts
        topics = [topic._replace(message_count=counts[self._channels[topic.name]]) for topic in self._topics]
        self._writer.add_metadata(bag_record(bag_information([self.record], topics, custom)))
        self._writer.finish()

    def abandon(self) -> None:
        """Close as it is."""
        self._writer.abandon()


def bag_record(information: Mapping[str, object]) -> Metadata:
    """Return the metadata of a bag of one file, as `bag_information` gives them, for that file."""
    return Metadata(BAG_RECORD, {'serialized_metadata': as_yaml(information)})
