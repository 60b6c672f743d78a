"""The blocks of all topics of any bag: of our types at the speed of the file, of others and from sqlite3 one by one."""

from collections import Counter
from collections.abc import Callable, Collection, Iterator
from pathlib import Path

from omni_vehicle_ros.bags.columns.blocks import Block, BlockReader
from omni_vehicle_ros.bags.columns.columns import Columns, make_columns
from omni_vehicle_ros.bags.columns.foreign import ForeignType, bag_schemas
from omni_vehicle_ros.bags.mcap.definitions import SchemaDefinition
from omni_vehicle_ros.bags.mcap.file_reader import RecordedMessage
from omni_vehicle_ros.bags.mcap.stream import read_messages
from omni_vehicle_ros.bags.source import CDR, RosbagsSource
from omni_vehicle_ros.errors import MessageError
from omni_vehicle_ros.messages import VALUE_TYPES, decode

ROWS, BYTES = 4096, 32 * 2**20
"""What is decoded one by one at a time, at most: messages of a topic, and of all."""

Progress = Callable[[float], None]
MakeColumns = Callable[[str, str, list[RecordedMessage]], Columns]


class TopicBlocks:
    """Reads a bag as often as it is asked for, in bounded memory.

    Parameters
    ----------
    path
        A bag directory, one MCAP file, or what else ``rosbags`` reads.

    Attributes
    ----------
    types
        Of the topics met so far.
    counts
        Messages by topic and type; known after `ours` has ended.
    units
        Of the columns of each topic that `foreign` has given.

    Raises
    ------
    BagError
        There is no such bag, or, when it is read, it can't be.
    """

    def __init__(self, path: Path | str) -> None:
        self._path = Path(path)
        self._other = RosbagsSource(self._path) if _is_other(self._path) else None
        self._stream = None if self._other else read_messages(path)
        self.types: dict[str, str] = self._stream.types if self._stream else {}
        self.counts: dict[tuple[str, str], int] = {}
        self.units: dict[str, dict[str, str]] = {}

    @property
    def damage(self) -> tuple[str, ...]:
        """For each file that is damaged, up to where it was read and why no farther."""
        return tuple(self._stream.damage if self._stream else self._other.damage if self._other else ())

    def ours(self, wanted: Callable[[str], bool], progress: Progress = lambda done: None) -> Iterator[Block]:
        """Give the blocks of topics whose type is one of ours; ``progress`` gets how far it is, 0 .. 1."""
        if self._stream is None:
            yield from self._one_by_one(
                lambda topic, name: name in VALUE_TYPES and wanted(topic), _our_columns, progress
            )
            return
        types = self._stream.types
        reader = BlockReader(
            self._stream, lambda topic, name: name in VALUE_TYPES and types[topic] == name and wanted(topic)
        )
        for block in reader:
            yield block
            progress(self._stream.position / self._stream.size)
        self.counts = reader.counts

    def foreign(self, topics: Collection[str], progress: Progress = lambda done: None) -> Iterator[Block]:
        """Give the blocks of topics of other types; each at least one, if only an empty one or why there is none."""
        types = {topic: self.types[topic] for topic in topics}
        readers, found = self._types_of(types), set()
        facts = self._stream.facts if self._stream else {}

        def make(topic: str, name: str, rows: list[RecordedMessage]) -> Columns:
            reader = readers[topic]
            if topic in facts and facts[topic].encoding != CDR:
                raise MessageError(f'the encoding {facts[topic].encoding!r} is not read here')
            if isinstance(reader, MessageError):
                raise reader
            return reader.columns(topic, [row.log_time for row in rows], [row.data for row in rows])

        for block in self._one_by_one(lambda topic, name: types.get(topic) == name, make, progress):
            found.add(block.topic)
            yield block
        for topic in types.keys() - found:
            yield _block(topic, types[topic], [], make)

    def _types_of(self, types: dict[str, str]) -> dict[str, ForeignType | MessageError]:
        schemas = self._schemas(set(types.values()))
        found: dict[str, ForeignType | MessageError] = {}
        for topic, name in types.items():
            try:
                found[topic] = reader = ForeignType(name, schemas.get(name))
                self.units[topic] = reader.units
            except MessageError as error:
                found[topic] = error
        return found

    def _schemas(self, types: set[str]) -> dict[str, SchemaDefinition]:
        if self._other is None:
            return bag_schemas(self._path, types)
        return {name: schema for name, schema in self._other.schemas.items() if name in types}

    def _one_by_one(
        self, wanted: Callable[[str, str], bool], make: MakeColumns, progress: Progress
    ) -> Iterator[Block]:
        counts: Counter[tuple[str, str]] = Counter()
        waiting: dict[str, list[RecordedMessage]] = {}
        total, size = sum(self.counts.values()), 0
        for read, message in enumerate(self._stream or self._other or (), 1):
            counts[message.topic, message.type_name] += 1
            if self.types.setdefault(message.topic, message.type_name) != message.type_name:
                continue
            if not wanted(message.topic, message.type_name):
                continue
            rows = waiting.setdefault(message.topic, [])
            rows.append(message)
            size += len(message.data)
            if len(rows) >= ROWS or size >= BYTES:
                yield from (_block(topic, self.types[topic], some, make) for topic, some in waiting.items())
                waiting, size = {}, 0
                progress(min(read / total, 1.0) if total else 0.0)
        yield from (_block(topic, self.types[topic], some, make) for topic, some in waiting.items())
        self.counts = dict(counts)


def _is_other(path: Path) -> bool:
    if path.is_dir():
        return not any(path.glob('*.mcap')) and (path / 'metadata.yaml').is_file()
    return path.suffix == '.db3' and path.is_file()


def _our_columns(topic: str, name: str, rows: list[RecordedMessage]) -> Columns:
    return make_columns(topic, name, [row.log_time for row in rows], [decode(name, row.data) for row in rows])


def _block(topic: str, name: str, rows: list[RecordedMessage], make: MakeColumns) -> Block:
    try:
        return Block(topic, name, make(topic, name, rows))
    except MessageError as error:
        return Block(topic, name, error)
