"""A bag as columns: ``open_bag(path)['odom'].x``."""

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from omni_vehicle_ros.bags.columns.blocks import Block
from omni_vehicle_ros.bags.columns.columns import Columns, join_columns, make_columns
from omni_vehicle_ros.bags.columns.foreign import join_blocks
from omni_vehicle_ros.bags.columns.topic_blocks import TopicBlocks
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

    def _read(self, name: str) -> None:
        ours = [other for other, info in self.topics.items() if info.type_name in VALUE_TYPES]
        at_once = name in ours and sum(info.message_count for info in self.topics.values()) <= AT_ONCE
        names = ours if at_once else [name]
        found = self._source([self._full[other] for other in names])
        for other in names:
            columns = found.get(self._full[other])
            if columns is None:
                columns = make_columns(other, self.topics[other].type_name, [], [])
            self._columns[other] = columns if isinstance(columns, MessageError) else replace(columns, topic=other)


def open_bag(path: Path | str, *, namespace: str | None = None) -> Bag:
    """Open a bag for reading by columns; one that breaks off gives what there is and says so in ``damage``.

    Parameters
    ----------
    path
        A bag directory, one MCAP file, or what else ``rosbags`` reads.
    namespace
        Of the vehicle that names are relative to; by default that of the only one in the bag.

    Notes
    -----
    Types that are not ours are decoded one by one by their definition in the bag (`foreign.ForeignType`): a column for
    each field, those of fields named as in ``pose_position_x``.

    Raises
    ------
    BagError
        There is no such bag, or it holds several vehicles and no namespace was given.
    """
    blocks = TopicBlocks(path)
    for _ in blocks.ours(lambda topic: False):
        pass
    return Bag(Path(path), blocks.types, blocks.counts, _FileSource(path, blocks.types), blocks.damage, namespace)


class _FileSource:
    """Reads a bag again for every request."""

    def __init__(self, path: Path | str, types: Mapping[str, str]) -> None:
        self._path, self._types = path, types

    def __call__(self, topics: Collection[str]) -> dict[str, Columns | MessageError]:
        blocks = TopicBlocks(self._path)
        blocks.types.update(self._types)
        ours = {topic for topic in topics if self._types[topic] in VALUE_TYPES}
        found = _joined(blocks.ours(ours.__contains__), join_columns) if ours else {}
        others = set(topics) - ours
        return found | (_joined(blocks.foreign(others), join_blocks) if others else {})


def _joined(
    blocks: Iterator[Block], join: Callable[[list[Columns]], Columns]
) -> dict[str, Columns | MessageError]:
    parts: dict[str, list[Columns]] = {}
    errors: dict[str, MessageError] = {}
    for topic, _, columns in blocks:
        if isinstance(columns, MessageError):
            errors.setdefault(topic, columns)
        else:
            parts.setdefault(topic, []).append(columns)
    return {topic: join(some) for topic, some in parts.items()} | errors


def _detect_namespace(path: Path, topics: list[str]) -> str:
    ending = f'/{VEHICLE_TOPIC}'
    found = sorted(topic.removesuffix(ending) for topic in topics if topic.endswith(ending))
    if len(found) > 1:
        names = ', '.join(name or '/' for name in found)
        raise BagError(f'{path} holds several vehicles; name the namespace of one: {names}')
    return found[0] if found else ''
