"""Messages that are lost, late, doubled, out of order or broken, on their way to the one who takes them."""

import math
from collections import deque
from collections.abc import Callable
from random import Random
from typing import Any

from omni_vehicle_ros.components.component import NANOSECONDS
from omni_vehicle_ros.faults import Fault
from omni_vehicle_ros.messages import Value


class MessageFault:
    """What a fault makes of the messages of one topic.

    Parameters
    ----------
    fault
        Of a component ``messages/...``, other than ok.
    receiver
        Who takes the messages: what is lost at random is lost to each alone.
    """

    def __init__(self, fault: Fault, receiver: str) -> None:
        self._fault = fault
        self._random = Random(f'{receiver} {fault.component}')
        self._delay = round(fault.value * NANOSECONDS)
        self._waiting: deque[tuple[int, Value]] = deque()

    def take(self, value: Value, now: int) -> list[Value]:
        """Take a message that came at ``now`` [ns], and return those that get through with it."""
        failure = self._fault.failure
        if failure == 'garbage':
            return [changed(value, lambda number: math.nan)]
        if failure == 'duplicated':
            return [value, value]
        if failure == 'intermittent':
            return [] if self._random.random() < self._fault.value else [value]
        if failure == 'reordered' and self._waiting:
            return [value, self._waiting.popleft()[1]]
        if failure in ('delayed', 'reordered'):
            self._waiting.append((now, value))
        return []

    def due(self, now: int) -> list[Value]:
        """Return late messages whose time has come at ``now`` [ns]."""
        ready = []
        while self._fault.failure == 'delayed' and self._waiting and self._is_due(self._waiting[0][0], now):
            ready.append(self._waiting.popleft()[1])
        return ready

    def _is_due(self, came: int, now: int) -> bool:
        return not 0 <= now - came < self._delay


def changed(value: Value, change: Callable[[float], float]) -> Value:
    """Return a message with each number changed; stamp and words stay."""

    def turned(entry: Any) -> Any:
        if isinstance(entry, float):
            return change(entry)
        return tuple(map(turned, entry)) if isinstance(entry, tuple) else entry

    return value._replace(**{name: turned(entry) for name, entry in value._asdict().items()})
