"""When a message that bears no stamp was said: in the cycle whose driver/step names its topic, if one does."""

from collections import deque

from omni_vehicle_ros import interface
from omni_vehicle_ros.messages import Step

TOPICS = frozenset(row.name for row in interface.TOPICS if row.recorded and row.type == 'std_msgs/msg/Bool')
"""Recorded topics whose messages have no stamp."""


class Unstamped:
    """Finds the times of messages without stamps, the same in every run in lock step.

    A message and the driver/step that names it come in either order. One that no step names, because somebody else
    said it, has the time at which it came in.
    """

    def __init__(self) -> None:
        self._waiting: dict[str, deque[tuple[int, bytes]]] = {topic: deque() for topic in TOPICS}
        self._named: dict[str, deque[int]] = {topic: deque() for topic in TOPICS}

    def hear(self, topic: str, data: bytes, now: int) -> list[tuple[str, bytes, int]]:
        """Take a message that came in at ``now`` [ns]; return topics, messages and stamps that are known by it."""
        self._waiting[topic].append((now, data))
        return self._matched(topic)

    def name(self, step: Step) -> list[tuple[str, bytes, int]]:
        """Take a driver/step; return as `hear`."""
        found = []
        for topic in TOPICS.intersection(step.topics):
            self._named[topic].append(step.stamp)
            found += self._matched(topic)
        return found

    def give_up(self, until: int | None) -> list[tuple[str, bytes, int]]:
        """Return what came in up to ``until`` [ns], or all, and was not named since; nothing is awaited any more."""
        found = []
        for topic, waiting in self._waiting.items():
            while waiting and (until is None or waiting[0][0] <= until):
                now, data = waiting.popleft()
                found.append((topic, data, now))
            named = self._named[topic]
            while named and (until is None or named[0] <= until):
                named.popleft()
        return found

    def _matched(self, topic: str) -> list[tuple[str, bytes, int]]:
        waiting, named = self._waiting[topic], self._named[topic]
        return [(topic, waiting.popleft()[1], named.popleft())] if waiting and named else []
