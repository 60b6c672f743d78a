"""The bare limit of the graph: plain rclpy nodes wired as ours, that take and say typed messages, and no more."""

import argparse
import sys
from functools import partial
from itertools import repeat
from typing import Any

from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.serialization import deserialize_message
from rclpy.utilities import remove_ros_args

from omni_vehicle_ros.bench.examples import example
from omni_vehicle_ros.components.icr_steering import STATES, TRIMS
from omni_vehicle_ros.interface import ICR_STEERING, NODES, PLANT, TOPICS, Topic, resolve, topic
from omni_vehicle_ros.messages import SECOND, Diagnostics, Status, encode
from omni_vehicle_ros.nodes.exchange import Exchange
from omni_vehicle_ros.nodes.ports import message_class, publisher_profile
from omni_vehicle_ros.nodes.process import LOOK_PERIOD, run

PERIOD = SECOND // 200
RESEND = 1.0
"""Standstill after which the plant says again what it said last: at the start not all are connected [s]."""
BEAT = 'joint_states'
"""What is answered again when it is said again."""


class BareNode(Node):  # type: ignore[misc]
    """Answers each cycle when all that belongs to it has come; its messages differ in their stamps only.

    The plant says the next cycle, and once in a second of simulated time on /diagnostics which one that is.

    Parameters
    ----------
    role
        One of the nodes of the wiring table; it has their topics, types and quality of service.
    nodes
        All that take part.
    """

    def __init__(self, role: str, nodes: list[str], namespace: str, context: Context) -> None:
        wheel, _, name = role.rpartition('/')
        super().__init__(name, context=context, namespace=resolve(wheel, namespace))
        self.finished = False
        self._ahead = PERIOD if role == PLANT else 0
        self._said = self._looked_at = 0
        self._answered = -1
        rows = [row for row in TOPICS if row.cyclic and row.name != '/clock']
        inputs = [row for row in rows if role in row.subscribers and {*row.publishers} & {*nodes}]
        earlier = {*STATES, *TRIMS} if role == ICR_STEERING else set()  # of the cycle before
        self._came = {row.name: -1 for row in inputs if row.name not in earlier}
        self._outlets = [self._outlet(row, namespace) for row in rows if role in row.publishers]
        self._diagnostics = self._outlet(topic('/diagnostics'), namespace) if role == PLANT else None
        self.create_timer(LOOK_PERIOD, int)  # wakes an executor that waits without a time-out
        for row in inputs:
            take = partial(self._take, row.name)
            full = resolve(row.name, namespace)
            self.create_subscription(message_class(row.type), full, take, publisher_profile(row.qos))

    def _outlet(self, row: Topic, namespace: str) -> tuple[Any, Any]:
        kind = message_class(row.type)
        publisher = self.create_publisher(kind, resolve(row.name, namespace), publisher_profile(row.qos))
        if row.name == '/diagnostics':
            status = Status(0, f'{self.get_namespace().rstrip("/")}/{self.get_name()}', 'driving')
            return publisher, deserialize_message(encode(row.type, Diagnostics(0, (status,))), kind)
        return publisher, deserialize_message(encode(row.type, example(row, 0, repeat(0.5))), kind)

    def _take(self, topic: str, message: Any) -> None:
        stamp = message.header.stamp
        time = stamp.sec * SECOND + stamp.nanosec
        came = self._came
        if topic in came:
            came[topic] = max(time, came[topic])
        if all(one == time for one in came.values()) and (time > self._answered or topic == BEAT):
            self._answered = time
            self._answer(time + self._ahead)

    def _answer(self, time: int) -> None:
        self._said = time
        seconds, nanoseconds = divmod(time, SECOND)
        outlets = self._outlets
        if self._diagnostics is not None and nanoseconds == 0:
            outlets = [*outlets, self._diagnostics]
        for publisher, message in outlets:
            stamp = message.header.stamp
            stamp.sec, stamp.nanosec = seconds, nanoseconds
            publisher.publish(message)

    def poll(self) -> None:
        """Begin, or go on after a standstill."""
        if self._ahead and self._said == self._looked_at:
            self._answer(self._said)
        self._looked_at = self._said

    def wait(self) -> float:
        """Return how long a standstill may take [s]."""
        return RESEND

    def end(self) -> None:
        """Do nothing: nothing is half done."""


class PlainExecutor(SingleThreadedExecutor):  # type: ignore[misc]
    """Waits as its ``spin`` does: without a time-out, whose change would have it make its wait set anew each time."""

    def spin_once(self, timeout_sec: float | None = None) -> None:
        """Serve one callback, at the latest that of a timer."""
        super().spin_once()


def main() -> None:
    """Run nodes until a signal comes."""
    parser = argparse.ArgumentParser(description='Nodes of a bare chain.')
    parser.add_argument('--namespace', required=True, help='of the vehicle')
    parser.add_argument('--all', nargs='+', choices=NODES, required=True, help='nodes of the chain')
    parser.add_argument('--nodes', nargs='+', choices=NODES, required=True, help='which of them run in this process')
    options = parser.parse_args(remove_ros_args(sys.argv)[1:])

    def make(context: Context, _: Exchange) -> list[BareNode]:
        return [BareNode(role, options.all, options.namespace, context) for role in options.nodes]

    sys.exit(run(make, PlainExecutor))
