"""A bag as columns: ``open_bag(path)['odom'].x``."""

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from omni_vehicle_ros.bags.blocks import BlockReader, check_type
from omni_vehicle_ros.bags.columns import Columns, join_columns, make_columns
from omni_vehicle_ros.bags.mcap_stream import read_messages
from omni_vehicle_ros.errors import BagError
from omni_vehicle_ros.interface import TOPICS, resolve
from omni_vehicle_ros.messages import VALUE_TYPES, MessageError
from omni_vehicle_ros.parameters import did_you_mean

VEHICLE_TOPIC = 'joint_states'
"""The topic that every vehicle has, by which its namespace is found."""

AT_ONCE = 1_000_000
"""Messages of a bag up to which the columns of all its topics, some 200 MB, are made when one is asked for: to read
the file for each topic by itself would take longer."""

Source = Callable[[Collection[str]], Mapping[str, Columns | MessageError]]
"""Gives the columns of topics that have messages, by full names, or why they can't be decoded."""

GLOBAL_TOPICS = frozenset(row.name for row in TOPICS if row.name.startswith('/'))


class TopicInfo(NamedTuple):
    """A topic of a bag."""

    type_name: str
    message_count: int


class Bag:
    """The messages of a bag, by topic; columns are read when they are asked for, and kept.

    Topic names are relative to the vehicle's namespace, as in the wiring table, or begin with ``/``.

    Parameters
    ----------
    path
        What was opened, for error messages.
    types
        The type of every topic, by its full name.
    counts
        How many messages there are, by full name and type.
    source
        Where the columns come from.
    damage
        Why they aren't all, if so.
    namespace
        Of the vehicle that names are relative to; by default that of the only one among the topics.

    Attributes
    ----------
    path
        What was opened.
    namespace
        Of the vehicle: ``''`` or ``/name``.
    topics
        Type and number of messages, by name.
    damage
        Why the bag isn't whole, for each damaged file; empty if it is.
    """

    def __init__(
        self,
        path: Path,
        types: Mapping[str, str],
        counts: Mapping[tuple[str, str], int],
        source: Source,
        damage: tuple[str, ...] = (),
        namespace: str | None = None,
    ) -> None:
        self.path = path
        self.damage = damage
        if namespace is None:
            namespace = _detect_namespace(path, list(types))
        self.namespace = f'/{namespace.strip("/")}'.rstrip('/')
        self.topics = {
            self._short(topic): TopicInfo(type_name, sum(counts[key] for key in counts if key[0] == topic))
            for topic, type_name in sorted(types.items())
        }
        self._full = {self._short(topic): topic for topic in types}
        self._met = {key for key, count in counts.items() if count}
        self._source = source
        self._columns: dict[str, Columns | MessageError] = {}

    @property
    def complete(self) -> bool:
        """Whether the bag is whole."""
        return not self.damage

    def __contains__(self, topic: str) -> bool:
        """Tell whether the bag knows a topic, if only without messages."""
        return self._short(topic) in self.topics

    def __iter__(self) -> Iterator[str]:
        """Give the names of the topics."""
        return iter(self.topics)

    def __getitem__(self, topic: str) -> Columns:
        """Return the messages of a topic as columns.

        Raises
        ------
        BagError
            The bag has no such topic, or its messages can't be decoded.
        """
        name = self._short(topic)
        if name not in self.topics:
            raise BagError(f'{self.path} has no topic {topic!r}{did_you_mean(topic, list(self.topics))}')
        self._check(name)
        if name not in self._columns:
            self._read(name)
        columns = self._columns[name]
        if isinstance(columns, MessageError):
            raise BagError(f'{self.path}: topic {name}: {columns}') from columns
        return columns

    def _short(self, topic: str) -> str:
        full = resolve(topic, self.namespace)
        begin = f'{self.namespace}/'
        return full.removeprefix(begin) if full not in GLOBAL_TOPICS and full.startswith(begin) else full

    def _check(self, name: str) -> None:
        type_name = self.topics[name].type_name
        others = {other for topic, other in self._met if topic == self._full[name]} - {type_name}
        if others:
            raise BagError(f'{self.path}: topic {name} has several types: {type_name}, {", ".join(sorted(others))}')
        check_type(self.path, name, type_name, type_name)

    def _read(self, name: str) -> None:
        at_once = sum(info.message_count for info in self.topics.values()) <= AT_ONCE
        names = [other for other, info in self.topics.items() if info.type_name in VALUE_TYPES] if at_once else [name]
        found = self._source([self._full[other] for other in names])
        for other in names:
            columns = found.get(self._full[other], make_columns(other, self.topics[other].type_name, [], []))
            self._columns[other] = columns if isinstance(columns, MessageError) else replace(columns, topic=other)


def open_bag(path: Path | str, *, namespace: str | None = None) -> Bag:
    """Open a bag for reading by columns; one that breaks off gives what there is and says so in ``damage``.

    Parameters
    ----------
    path
        A bag directory or one MCAP file.
    namespace
        Of the vehicle that names are relative to; by default that of the only one in the bag.

    Raises
    ------
    BagError
        There is no such bag, or it holds several vehicles and no namespace was given.
    """
    stream = read_messages(path)
    counter = BlockReader(stream, lambda topic, type_name: False)
    for _ in counter:
        pass
    return Bag(Path(path), stream.types, counter.counts, _FileSource(path), tuple(stream.damage), namespace)


class _FileSource:
    """Reads a bag again for every request."""

    def __init__(self, path: Path | str) -> None:
        self._path = path

    def __call__(self, topics: Collection[str]) -> dict[str, Columns | MessageError]:
        stream = read_messages(self._path)
        blocks: dict[str, list[Columns]] = {}
        errors: dict[str, MessageError] = {}
        for topic, _, columns in BlockReader(
            stream, lambda topic, type_name: topic in topics and type_name == stream.types[topic]
        ):
            if isinstance(columns, MessageError):
                errors.setdefault(topic, columns)
            else:
                blocks.setdefault(topic, []).append(columns)
        return {topic: join_columns(parts) for topic, parts in blocks.items()} | errors


def _detect_namespace(path: Path, topics: list[str]) -> str:
    ending = f'/{VEHICLE_TOPIC}'
    found = sorted(topic.removesuffix(ending) for topic in topics if topic.endswith(ending))
    if len(found) > 1:
        names = ', '.join(name or '/' for name in found)
        raise BagError(f'{path} holds several vehicles; name the namespace of one: {names}')
    return found[0] if found else ''
