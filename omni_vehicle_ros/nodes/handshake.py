"""Knows when a node is connected to all its peers, so that no message of the first cycle is lost."""

import time
from collections.abc import Iterable

from rclpy.node import Node
from rclpy.publisher import Publisher

from omni_vehicle_ros import interface

CHECK_PERIOD = 0.02


class Handshake:
    """Compares the graph with the wiring table.

    That a publisher has matched a subscription does not mean that the subscription has matched the publisher.
    So every node checks its own ends, in both directions, and then says that it is ready.
    """

    def __init__(
        self,
        node: Node,
        role: str,
        namespace: str,
        topics: Iterable[interface.Topic],
        participants: tuple[str, ...],
        publishers: Iterable[Publisher],
    ) -> None:
        self.done = False
        self._node, self._namespace = node, namespace
        self._checked = 0.0
        self._publishers = {publisher.topic_name: publisher for publisher in publishers}
        self._peers: list[tuple[str, bool, set[str]]] = []
        others = {*participants} - {role}
        for row in topics:
            topic = interface.resolve(row.name, namespace)
            readers = {*row.subscribers} | ({interface.RECORDER} if row.recorded else set())
            if role in row.publishers and row.name != 'ready':
                self._peers.append((topic, True, readers & others))
            if role in readers and row.name != 'ready':
                self._peers.append((topic, False, {*row.publishers} & others))

    def complete(self) -> bool:
        """Whether all peers are connected; asked of the graph every now and then only."""
        now = time.monotonic()
        if now - self._checked < CHECK_PERIOD:
            return False
        self._checked = now
        self.done = all(self._connected(*peer) for peer in self._peers)
        return self.done

    def _connected(self, topic: str, outward: bool, peers: set[str]) -> bool:
        if not peers:
            return True
        look = self._node.get_subscriptions_info_by_topic if outward else self._node.get_publishers_info_by_topic
        present = {f'{info.node_namespace.rstrip("/")}/{info.node_name}' for info in look(topic)}
        if not {f'{self._namespace}/{peer}' for peer in peers} <= present:
            return False
        publisher = self._publishers.get(topic)
        return not outward or publisher is None or publisher.get_subscription_count() >= len(peers)
