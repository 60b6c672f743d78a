"""Knows who may publish what, and sees who does it beside them."""

import time
from collections.abc import Iterable

from rclpy.node import Node

from omni_vehicle_ros.interface import ANYONE, Topic, resolve

LOOK_PERIOD = 1.0


class Owners:
    """Counts the publishers of topics that belong to one node.

    A look takes 11 us a topic, and a node has at most six of them: less than 0.1 ms of a second.

    Parameters
    ----------
    node
        Asks the graph.
    namespace
        Of the vehicle.
    topics
        Rows of the wiring table; those that several nodes, or anyone, may publish don't count.
    """

    def __init__(self, node: Node, namespace: str, topics: Iterable[Topic]) -> None:
        self._node = node
        self._owners = {
            resolve(row.name, namespace): resolve(row.publishers[0], namespace)
            for row in topics
            if len(row.publishers) == 1 and ANYONE not in row.publishers
        }
        self._looked = time.monotonic()
        self.strangers = ''

    def look(self) -> bool:
        """Look once a second, and return whether there is something to say: ``strangers``, or that they are gone."""
        now = time.monotonic()
        if now - self._looked < LOOK_PERIOD:
            return False
        self._looked = now
        before, node = self.strangers, self._node
        crowded = [topic for topic in self._owners if node.count_publishers(topic) > 1]
        self.strangers = '; '.join(map(self._names, crowded))
        return bool(before or self.strangers)

    def _names(self, topic: str) -> str:
        found = self._node.get_publishers_info_by_topic(topic)
        names = sorted({f'{info.node_namespace.rstrip("/")}/{info.node_name}' for info in found})
        return f'{topic} has {len(found)} publishers ({", ".join(names)}): end all but one of {self._owners[topic]}'
