"""A bag that is never written to disk."""

from pathlib import Path

from omni_vehicle_ros.bags.bag import Bag
from omni_vehicle_ros.bags.mcap_stream import RecordedMessage
from omni_vehicle_ros.interface import Qos


class MemoryWriter:
    """Takes messages as `BagWriter` does, and keeps them for `bag`."""

    def __init__(self) -> None:
        self._types: dict[str, str] = {}
        self._messages: list[RecordedMessage] = []

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
        self._messages.append(RecordedMessage(name, self._types[name], log_time, data))

    def bag(self, name: str) -> Bag:
        """Return what was written so far as a bag; ``name`` stands for its path in error messages."""
        return Bag(Path(name), self._types, self._messages)
