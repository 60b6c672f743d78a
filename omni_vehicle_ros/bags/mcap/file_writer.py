"""One MCAP file while it is written: it has all schemas and channels itself, so that it can be read alone."""

from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import IO, cast

from mcap.writer import CompressionType, Writer

from omni_vehicle_ros import __version__
from omni_vehicle_ros.bags.metadata import FileRecord, TopicRecord, as_yaml, bag_information, qos_profiles
from omni_vehicle_ros.bags.schema import ENCODING

CHUNK_SIZE = 65536
"""A chunk is written when it is full or at a flush: what is lost at a kill is less than one."""

COMPRESSIONS = {'none': CompressionType.NONE, 'lz4': CompressionType.LZ4, 'zstd': CompressionType.ZSTD}


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
    counts
        Messages by topic.
    """

    def __init__(self, path: Path, compression: str) -> None:
        self.path = path
        self.counts: dict[str, int] = {}
        self._file = _WholeWrites(path)
        stream = cast('IO[bytes]', self._file)
        self._writer = Writer(stream, CHUNK_SIZE, COMPRESSIONS[compression], enable_data_crcs=True)
        self._schemas: dict[str, int] = {}
        self._channels: dict[str, int] = {}
        self._topics: list[TopicRecord] = []
        self._first: int | None = None
        self._last = 0
        self._writer.start(profile='ros2', library=f'omni_vehicle_ros {__version__}')

    @property
    def size(self) -> int:
        """What was handed to the system [byte]; less than a chunk may wait beside it."""
        return self._file.tell()

    @property
    def record(self) -> FileRecord:
        """What ``metadata.yaml`` says about this file."""
        return FileRecord(self.path.name, (self._first or 0, self._last), sum(self.counts.values()))

    @property
    def begin(self) -> int | None:
        """Log time of the earliest message [ns], if there is any."""
        return self._first

    def add_topic(self, topic: TopicRecord, definition: str) -> None:
        """Announce a topic, with the definition of its type."""
        kind = topic.type_name
        if kind not in self._schemas:
            self._schemas[kind] = self._writer.register_schema(kind, ENCODING, definition.encode())
        self._channels[topic.name] = self._writer.register_channel(
            topic.name, 'cdr', self._schemas[kind],
            {'offered_qos_profiles': as_yaml(qos_profiles(topic.offers)), 'topic_type_hash': topic.type_hash},
        )
        self._topics.append(topic)
        self.counts[topic.name] = 0

    def write(self, name: str, data: bytes, log_time: int, publish_time: int, sequence: int) -> None:
        """Write one message of a topic that was announced."""
        self._writer.add_message(self._channels[name], log_time, data, publish_time, sequence & 0xFFFFFFFF)
        self.counts[name] += 1
        if self._first is None or log_time < self._first:
            self._first = log_time
        if log_time > self._last:
            self._last = log_time

    def flush(self) -> None:
        """Hand all that was written to the system."""
        self._writer.flush()

    def finish(self, custom: Mapping[str, str]) -> None:
        """Write index and summary, and close."""
        topics = [topic._replace(message_count=self.counts[topic.name]) for topic in self._topics]
        information = bag_information([self.record], topics, custom)
        self._writer.add_metadata('rosbag2', {'serialized_metadata': as_yaml(information)})
        self._writer.finish()
        self._file.close()

    def abandon(self) -> None:
        """Close as it is."""
        with suppress(OSError):
            self._file.close()


class _WholeWrites:
    """A file without a buffer in this process, which either takes all of what is written or raises.

    A buffer would hide an error of the system until later, and be lost when the process is killed.
    """

    def __init__(self, path: Path) -> None:
        self._file = open(path, 'xb', buffering=0)  # noqa: SIM115  (closed by close)
        self._position = 0

    def write(self, data: bytes) -> int:
        rest = memoryview(data)
        while rest:
            rest = rest[self._file.write(rest) :]
        self._position += len(data)
        return len(data)

    def tell(self) -> int:
        return self._position

    def flush(self) -> None:
        pass

    def close(self) -> None:
        self._file.close()
