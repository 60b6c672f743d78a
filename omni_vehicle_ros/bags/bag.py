"""A bag as columns: ``open_bag(path)['odom'].x``."""

from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import NamedTuple

from omni_vehicle_ros.bags.columns import Columns, make_columns
from omni_vehicle_ros.bags.mcap_stream import RecordedMessage, read_messages
from omni_vehicle_ros.errors import BagError
from omni_vehicle_ros.interface import TOPICS, resolve
from omni_vehicle_ros.messages import VALUE_TYPES, MessageError, decode
from omni_vehicle_ros.parameters import did_you_mean

VEHICLE_TOPIC = 'joint_states'
"""The topic that every vehicle has, by which its namespace is found."""

GLOBAL_TOPICS = frozenset(row.name for row in TOPICS if row.name.startswith('/'))


class TopicInfo(NamedTuple):
    """A topic of a bag."""

    type_name: str
    message_count: int


class Bag:
    """The messages of a bag, by topic; columns are made when they are asked for.

    Topic names are relative to the vehicle's namespace, as in the wiring table, or begin with ``/``.

    Parameters
    ----------
    path
        What was opened, for error messages.
    types
        The type of every topic, by its full name.
    messages
        In the order of recording.
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
        messages: Iterable[RecordedMessage],
        damage: tuple[str, ...] = (),
        namespace: str | None = None,
    ) -> None:
        by_topic: dict[str, list[RecordedMessage]] = {}
        for message in messages:
            by_topic.setdefault(message.topic, []).append(message)
        self.path = path
        self.damage = damage
        if namespace is None:
            namespace = _detect_namespace(path, list(types))
        self.namespace = f'/{namespace.strip("/")}'.rstrip('/')
        self.topics = {
            self._short(topic): TopicInfo(type_name, len(by_topic.get(topic, ())))
            for topic, type_name in sorted(types.items())
        }
        self._messages = {self._short(topic): found for topic, found in by_topic.items()}
        self._columns: dict[str, Columns] = {}

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
        if name not in self._columns:
            self._columns[name] = self._read(name)
        return self._columns[name]

    def _short(self, topic: str) -> str:
        full = resolve(topic, self.namespace)
        begin = f'{self.namespace}/'
        return full.removeprefix(begin) if full not in GLOBAL_TOPICS and full.startswith(begin) else full

    def _read(self, name: str) -> Columns:
        type_name, messages = self.topics[name].type_name, self._messages.get(name, [])
        others = {message.type_name for message in messages} - {type_name}
        if others:
            raise BagError(f'{self.path}: topic {name} has several types: {type_name}, {", ".join(sorted(others))}')
        if type_name not in VALUE_TYPES:
            raise BagError(f'{self.path}: topic {name} has the type {type_name}, which is not read here')
        try:
            values = [decode(type_name, message.data) for message in messages]
            return make_columns(name, type_name, [message.log_time for message in messages], values)
        except MessageError as error:
            raise BagError(f'{self.path}: topic {name}: {error}') from error


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
    messages = list(stream)
    return Bag(Path(path), stream.types, messages, tuple(stream.damage), namespace)


def _detect_namespace(path: Path, topics: list[str]) -> str:
    ending = f'/{VEHICLE_TOPIC}'
    found = sorted(topic.removesuffix(ending) for topic in topics if topic.endswith(ending))
    if len(found) > 1:
        names = ', '.join(name or '/' for name in found)
        raise BagError(f'{path} holds several vehicles; name the namespace of one: {names}')
    return found[0] if found else ''
