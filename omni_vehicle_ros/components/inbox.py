"""The messages that wait for the next cycle of a component, and what faults make of them."""

from collections import deque
from operator import itemgetter

from omni_vehicle_ros.components.component import Component, Fallible
from omni_vehicle_ros.components.message_fault import MessageFault
from omni_vehicle_ros.faults import FAULTS, MESSAGES, OK, PROCESSES, Fault, read_faults
from omni_vehicle_ros.interface import TOPICS
from omni_vehicle_ros.messages import Diagnostics, Value

LARGEST = 512
"""Messages that may wait; of a flood, the latest are kept."""

_ORDER = {row.name: number for number, row in enumerate(TOPICS)} | {FAULTS: -1}
_BY_TOPIC = itemgetter(0)


class Inbox:
    """Gives a component its messages cycle by cycle, always in the same order, whatever order they came in.

    Faults come first: they hold for all messages of their cycle.

    Parameters
    ----------
    role
        Node of the component, as in `omni_vehicle_ros.interface.NODES`.
    component
        Who takes the messages.
    fault_injection
        Whether faults are taken.

    Attributes
    ----------
    process
        What has happened to the process of the component.
    refused
        Why faults were not taken; whoever reads it empties it.
    """

    def __init__(self, role: str, component: Component, *, fault_injection: bool) -> None:
        self.process = Fault('')
        self.refused: list[str] = []
        self._role, self._component = role, component
        self._fault_injection = fault_injection
        self._waiting: deque[tuple[int, str, Value]] = deque(maxlen=LARGEST)
        self._faults: dict[str, MessageFault] = {}

    def put(self, topic: str, value: Value) -> None:
        """Keep a message for the next cycle."""
        self._waiting.append((_ORDER[topic], topic, value))

    def hand_over(self, now: int) -> tuple[str, ...]:
        """Hand what waits to the component at ``now`` [ns]; return the topics of which faults let nothing through."""
        waiting = sorted(self._waiting, key=_BY_TOPIC)
        self._waiting.clear()
        receive, faults = self._component.receive, self._faults
        for _, topic, value in waiting:
            if topic == FAULTS:
                self.inject(value, now)
            elif topic not in faults:
                receive(topic, value, now)
        return self._hand_over_faulty(waiting, now) if faults else ()

    def _hand_over_faulty(self, waiting: list[tuple[int, str, Value]], now: int) -> tuple[str, ...]:
        blocked = []
        for name, fault in self._faults.items():
            values = fault.due(now)
            for _, topic, value in waiting:
                values += fault.take(value, now) if topic == name else []
            values += fault.due(now)
            for value in values:
                self._component.receive(name, value, now)
            if not values:
                blocked.append(name)
        return tuple(blocked)

    def inject(self, message: Value, now: int) -> None:
        """Take the faults of a message of the topic ``faults``."""
        if not isinstance(message, Diagnostics):
            return
        faults, refused = read_faults(message)
        if not self._fault_injection:
            faults, refused = [], ['faults refused: fault_injection is false; start the node with it set to true']
        self.refused += refused
        for fault in faults:
            self._take(fault, now)

    def _take(self, fault: Fault, now: int) -> None:
        if fault.component.startswith(MESSAGES):
            topic = fault.component.removeprefix(MESSAGES)
            self._faults.pop(topic, None)
            if fault.failure != OK:
                self._faults[topic] = MessageFault(fault, self._role)
        elif PROCESSES.get(fault.component) == self._role:
            self.process = fault
        elif isinstance(self._component, Fallible):
            self._component.fail(fault, now)

    @property
    def silent(self) -> bool:
        """Whether the process of the component says nothing any more."""
        return self.process.failure in ('off', 'stuck')
