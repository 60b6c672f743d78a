"""The messages of any bag as columns, block by block: our MCAP files, and by rosbags what else rosbag2 writes."""

from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path

from omni_vehicle_ros.bags import Columns, read_messages
from omni_vehicle_ros.bags.bag_contents import read_metadata
from omni_vehicle_ros.bags.columns.blocks import ROWS, BlockReader
from omni_vehicle_ros.bags.columns.columns import make_columns
from omni_vehicle_ros.bags.source import RosbagsSource, open_source
from omni_vehicle_ros.errors import BagError, MessageError
from omni_vehicle_ros.messages import VALUE_TYPES, decode

Progress = Callable[[float], None]
MEGABYTE = 1e6
_OTHERS_ROWS = 4096


class BagReader:
    """Gives the blocks of a bag.

    Parameters
    ----------
    path
        A bag directory, an MCAP file or an sqlite3 file with its metadata.yaml beside it.
    rows
        Messages of a block at most.

    Attributes
    ----------
    types
        The types of the topics met so far.
    counts
        Messages read so far, by topic.
    unreadable
        Why messages of a topic could not be read, the first of them.
    damage
        Why the bag is not whole, for each damaged file.
    size
        All files together [MB].

    Raises
    ------
    BagError
        There is no such bag, or it can't be read.
    """

    def __init__(self, path: Path, rows: int = ROWS) -> None:
        self.path, self._rows = path, rows
        self.types: dict[str, str] = {}
        self.counts: Counter[str] = Counter()
        self.unreadable: dict[str, str] = {}
        self.damage: list[str] = []
        source = open_source(path)
        self._other = source if isinstance(source, RosbagsSource) else None
        if self._other is None:
            self._stream = read_messages(path)
        self.size = (self._stream.size if self._other is None else _size(path)) / MEGABYTE

    def blocks(self, progress: Progress) -> Iterator[tuple[str, Columns]]:
        """Give full names of topics and their next messages; ``progress`` gets how much was read [MB]."""
        if self._other is not None:
            yield from self._other_blocks(self._other, progress)
            return
        self.types, self.damage = self._stream.types, self._stream.damage
        blocks = BlockReader(self._stream, self._wanted, self._rows)
        for topic, _, columns in blocks:
            if isinstance(columns, MessageError):
                self.unreadable.setdefault(topic, str(columns))
            else:
                yield topic, columns
            progress(self._stream.position / MEGABYTE)
        for (topic, _), count in blocks.counts.items():
            self.counts[topic] += count
        progress(self.size)

    def _wanted(self, topic: str, type_name: str) -> bool:
        if type_name not in VALUE_TYPES:
            self.unreadable[topic] = f'the type {type_name} is not read here'
        elif type_name != self.types[topic]:
            self.unreadable[topic] = f'it has several types: {self.types[topic]}, {type_name}'
        return topic not in self.unreadable

    def _other_blocks(self, source: RosbagsSource, progress: Progress) -> Iterator[tuple[str, Columns]]:
        self.types, self.damage = {topic: facts.type_name for topic, facts in source.topics.items()}, source.damage
        for topic, type_name in self.types.items():
            self._wanted(topic, type_name)  # and says which are not
        total = read_metadata(self.path).information.get('message_count', 0)
        waiting: dict[str, list[tuple[int, bytes]]] = {}
        for read, message in enumerate(source, 1):
            self.counts[message.topic] += 1
            if message.topic not in self.types:
                self.types[message.topic] = message.type_name
                self._wanted(message.topic, message.type_name)
            if message.topic in self.unreadable:
                continue
            rows = waiting.setdefault(message.topic, [])
            rows.append((message.log_time, message.data))
            if len(rows) >= min(self._rows, _OTHERS_ROWS):
                yield from self._decoded(waiting)
                waiting.clear()
                progress(self.size * read / total if isinstance(total, int) and total > read else self.size)
        yield from self._decoded(waiting)
        progress(self.size)

    def _decoded(self, waiting: dict[str, list[tuple[int, bytes]]]) -> Iterator[tuple[str, Columns]]:
        for topic, rows in waiting.items():
            type_name = self.types[topic]
            try:
                values = [decode(type_name, data) for _, data in rows]
                yield topic, make_columns(topic, type_name, [time for time, _ in rows], values)
            except MessageError as error:
                self.unreadable.setdefault(topic, str(error))


def _size(path: Path) -> int:
    """Return what a bag takes on disk [byte]."""
    files = (path,) if path.is_file() else (file for file in path.iterdir() if file.is_file())
    try:
        return sum(file.stat().st_size for file in files)
    except OSError as error:
        raise BagError(f'{path} can not be read: {error.strerror}') from error
