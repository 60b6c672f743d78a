"""The latest messages in memory, which become a bag when somebody asks for them."""

from collections import deque
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

from omni_vehicle_ros.bags.metadata import OfferedQos
from omni_vehicle_ros.bags.schema import Schema
from omni_vehicle_ros.bags.writer import BagWriter, make_directory
from omni_vehicle_ros.interface import Qos

OVERHEAD = 300
"""What a message takes beside its bytes: the objects around it [byte]."""

PORTION = 2000
"""Messages of a snapshot that are written at a time, in some 50 ms."""


class _Kept(NamedTuple):
    name: str
    data: bytes
    log_time: int
    publish_time: int | None


class _Topic(NamedTuple):
    type_name: str
    qos: Qos | Sequence[OfferedQos]
    description: Schema | None


class SnapshotBuffer:
    """Takes messages as `BagWriter` does, and keeps those that came last.

    Parameters
    ----------
    directory
        Gets a bag for each snapshot: ``snapshot_0``, ``snapshot_1`` and so on. Must not exist.
    size
        Of the messages that are kept, the objects around them included [byte]. One that is larger is not kept.
    span
        Log time from the oldest message that is kept to the latest one [ns].
    compression, split_size, split_time
        Of the bags, as for `BagWriter`.

    Attributes
    ----------
    count
        Messages written so far.

    Raises
    ------
    BagError
        The directory exists, or can't be made.
    """

    def __init__(
        self, directory: Path | str, size: int, span: int, *, compression: str = 'zstd', split_size: int = 0,
        split_time: int = 0,
    ) -> None:
        self.directory = Path(directory).resolve()
        self.count = 0
        self._limit, self._span = size, span
        self._options = {'split_size': split_size, 'split_time': split_time}
        self._compression = compression
        self._topics: dict[str, _Topic] = {}
        self._kept: deque[_Kept] = deque()
        self._size = 0
        self._taken = self._oversized = 0
        make_directory(self.directory)

    def __len__(self) -> int:
        """Return how many messages are kept."""
        return len(self._kept)

    def add_topic(
        self, name: str, type_name: str, qos: Qos | Sequence[OfferedQos], description: Schema | None = None
    ) -> None:
        """Announce a topic, as `BagWriter.add_topic`."""
        self._topics.setdefault(name, _Topic(type_name, qos, description))

    def write(self, name: str, data: bytes, log_time_ns: int, publish_time_ns: int | None = None) -> None:
        """Keep a message, and drop what is too old or too much."""
        if len(data) + OVERHEAD > self._limit:
            self._oversized += 1
            return
        self._kept.append(_Kept(name, data, log_time_ns, publish_time_ns))
        self._size += len(data) + OVERHEAD
        while self._size > self._limit or log_time_ns - self._kept[0].log_time > self._span:
            self._size -= len(self._kept.popleft().data) + OVERHEAD

    def take(self, meanwhile: Callable[[], None] = lambda: None) -> str:
        """Write what is kept, which stays, and say how much it was and where it is.

        Parameters
        ----------
        meanwhile
            Is called every now and then, as writing takes a while: it may write new messages to this buffer. They
            are kept, but not part of this snapshot.

        Raises
        ------
        BagError
            The system refuses to write.
        """
        directory = self.directory / f'snapshot_{self._taken}'
        self._taken += 1
        messages = list(self._kept)
        with BagWriter(directory, compression=self._compression, **self._options) as writer:
            for name, topic in self._topics.items():
                writer.add_topic(name, *topic)
            for number, message in enumerate(messages):
                writer.write(*message)
                if number % PORTION == PORTION - 1:
                    meanwhile()
        self.count += len(messages)
        seconds = (messages[-1].log_time - messages[0].log_time) * 1e-9 if messages else 0.0
        over = self._oversized
        tail = f'; {over} so far were too large for snapshot_size, {self._limit} B' if over else ''
        return f'{len(messages)} messages of {seconds:.3f} s in {directory}{tail}'

    def flush(self) -> None:
        """Do nothing: what isn't asked for isn't written."""

    def close(self) -> None:
        """Forget what is kept."""
        self._kept.clear()
