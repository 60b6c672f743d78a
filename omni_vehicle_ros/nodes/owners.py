"""Knows who may publish what, and sees who does it beside them, or that several drive on one topic."""

import time
from collections.abc import Sequence

from rclpy.node import Node
from rclpy.topic_endpoint_info import TopicEndpointInfo

from omni_vehicle_ros.faults import FAULTS
from omni_vehicle_ros.interface import ANYONE, Topic, resolve

LOOK_PERIOD = 1.0


class Owners:
    """Counts the publishers of topics that belong to one node, and of those that drive, of which there should be one.

    Messages do not bear the name of who sent them: of two that publish the same command, the last one holds, time
    after time.

    A look takes 11 us a topic, and a node has at most six of them: less than 0.1 ms of a second.

    Parameters
    ----------
    node
        Asks the graph.
    namespace
        Of the vehicle.
    topics
        Rows of the wiring table; what several nodes may publish, such as faults, and latched topics that anyone may,
        don't count.
    """

    def __init__(self, node: Node, namespace: str, topics: Sequence[Topic]) -> None:
        self._node = node
        self._owners = {
            resolve(row.name, namespace): resolve(row.publishers[0], namespace)
            for row in topics
            if len(row.publishers) == 1 and ANYONE not in row.publishers
        }
        self._drivers = [
            resolve(row.name, namespace)
            for row in topics
            if ANYONE in row.publishers and not row.qos.latched and row.name != FAULTS
        ]
        self._namespace = namespace
        self._dead: set[bytes] = set()
        self._looked = time.monotonic()
        self.strangers = ''

    def bury(self, role: str) -> None:
        """Count the publishers of a node no more that has died: they are in the graph for some seconds yet."""
        name = resolve(role, self._namespace)
        self._dead |= {
            bytes(info.endpoint_gid)
            for topic in (*self._owners, *self._drivers)
            for info in self._node.get_publishers_info_by_topic(topic)
            if _name(info) == name
        }

    def look(self) -> bool:
        """Look once a second, and return whether there is something to say: ``strangers``, or that they are gone."""
        now = time.monotonic()
        if now - self._looked < LOOK_PERIOD:
            return False
        self._looked = now
        before, node = self.strangers, self._node
        crowded = [topic for topic in (*self._owners, *self._drivers) if node.count_publishers(topic) > 1]
        self.strangers = '; '.join(filter(None, map(self._names, crowded)))
        return bool(before or self.strangers)

    def _names(self, topic: str) -> str:
        all_known = self._node.get_publishers_info_by_topic(topic)
        found = [info for info in all_known if bytes(info.endpoint_gid) not in self._dead]
        if len(found) < 2:
            return ''
        names = sorted({_name(info) for info in found})
        who = f'{topic} has {len(found)} publishers ({", ".join(names)}): '
        if topic in self._owners:
            return who + f'end all but one of {self._owners[topic]}'
        return who + 'of two that speak the last one holds, time after time; end all but one'


def _name(info: TopicEndpointInfo) -> str:
    return f'{info.node_namespace.rstrip("/")}/{info.node_name}'
