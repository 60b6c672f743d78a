"""A bag that is never written to disk."""

from collections.abc import Collection
from pathlib import Path

from omni_vehicle_ros.bags.bag import Bag
from omni_vehicle_ros.bags.columns.columns import Columns, make_columns
from omni_vehicle_ros.errors import MessageError
from omni_vehicle_ros.interface import Qos
from omni_vehicle_ros.messages import decode


class MemoryWriter:
    """Takes messages as `BagWriter` does, and keeps them for `bag`."""

    def __init__(self) -> None:
        self._types: dict[str, str] = {}
        self._messages: dict[str, list[tuple[int, bytes]]] = {}

    def add_topic(self, name: str, type_name: str, qos: Qos) -> None:
        """Announce a topic by its full name."""
        self._types[name] = type_name

    def write(self, name: str, data: bytes, log_time: int) -> None:
        """Keep a message.

        Parameters
        ----------
        name
            Full name of a topic that was announced.
        data
            The message as it goes over the wire.
        log_time
            When it was recorded [ns].
        """
        self._messages.setdefault(name, []).append((log_time, data))

    def bag(self, name: str) -> Bag:
        """Return what was written so far as a bag; ``name`` stands for its path in error messages."""
        counts = {(topic, self._types[topic]): len(messages) for topic, messages in self._messages.items()}
        return Bag(Path(name), self._types, counts, self._columns)

    def _columns(self, topics: Collection[str]) -> dict[str, Columns | MessageError]:
        return {topic: self._decode(topic) for topic in self._messages if topic in topics}

    def _decode(self, topic: str) -> Columns | MessageError:
        type_name, messages = self._types[topic], self._messages[topic]
        try:
            values = [decode(type_name, data) for _, data in messages]
        except MessageError as error:
            return error
        return make_columns(topic, type_name, [log_time for log_time, _ in messages], values)
