"""A process that publishes: run by the tests of the recorder.

``publishers.py flood FIRST TOPICS RATE SECONDS``: small messages on TOPICS topics, RATE a second on each, numbered from
0 in their stamps; before them some with the stamp -1, until the recorder says on /diagnostics that it hears each topic.
Says what it sent, and at what rate.

``publishers.py mixed``: one message on a latched topic before anybody listens, then slowly others until it is killed.

``publishers.py typed TYPE``: messages of std_msgs/msg/TYPE on the topic ``changing`` until it is killed.

``publishers.py call SERVICE``: calls a Trigger and prints the answer.
"""

import re
import sys
import time

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import TwistStamped
from rclpy.context import Context
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import serialize_message
from rosgraph_msgs.msg import Clock
from std_msgs.msg import Bool, Header, String
from std_srvs.srv import Trigger
from stereo_msgs.msg import DisparityImage

BURST = 20
DEPTH = 4000
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
UNRELIABLE = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)


def flood(node: Node, first: str, topics: str, rate: str, seconds: str) -> None:
    publishers = [
        node.create_publisher(TwistStamped, f'flood/t{int(first) + number}', DEPTH) for number in range(int(topics))
    ]
    template = bytearray(serialize_message(TwistStamped()))
    await_heard(node, publishers, template)
    total = int(int(rate) * float(seconds))
    begin, sent = time.monotonic(), 0
    while sent < total:
        # After a pause, the rest comes no faster than a reader on a busy machine can follow.
        due = min(int((time.monotonic() - begin) * int(rate)), sent + BURST, total)
        for number in range(sent, due):
            template[4:8] = number.to_bytes(4, 'little')
            for publisher in publishers:
                publisher.publish(bytes(template))
        sent = due
        time.sleep(0.002)
    took = time.monotonic() - begin
    for publisher in publishers:
        publisher.wait_for_all_acked(Duration(seconds=10))
    print('sent', sent, round(sent * len(publishers) / took), flush=True)


def await_heard(node: Node, publishers: list[Publisher], template: bytearray) -> None:
    """Publish on each topic until the recorder counts messages of it: when we have matched, it may not have."""
    unheard = {publisher.topic_name: publisher for publisher in publishers}

    def note(array: DiagnosticArray) -> None:
        for value in (value for status in array.status for value in status.values):
            if re.search(r', [1-9]\d* messages, ', value.value):
                unheard.pop(value.key, None)

    subscription = node.create_subscription(DiagnosticArray, '/diagnostics', note, 10)
    template[4:8] = (-1).to_bytes(4, 'little', signed=True)
    while unheard:
        for publisher in unheard.values():
            publisher.publish(bytes(template))
        rclpy.spin_once(node, timeout_sec=0.05)
    node.destroy_subscription(subscription)


def mixed(node: Node) -> None:
    node.create_publisher(String, 'latched', LATCHED).publish(String(data='from before'))
    unreliable = node.create_publisher(Bool, 'unreliable', UNRELIABLE)
    hidden = node.create_publisher(Bool, '_hidden', 10)
    clock = node.create_publisher(Clock, '/clock', 10)
    context = Context()  # a participant of its own: none may publish two types on one topic
    rclpy.init(context=context)
    other = Node('test_other', context=context)
    two = node.create_publisher(Bool, 'two_types', 10), other.create_publisher(Header, 'two_types', 10)
    rare = node.create_publisher(DisparityImage, 'rare', 10)
    both = node.create_publisher(Bool, 'both', 10), node.create_publisher(Bool, 'both', UNRELIABLE)
    while True:
        for publisher in (unreliable, hidden, two[0], *both):
            publisher.publish(Bool(data=True))
        clock.publish(Clock())
        two[1].publish(Header())
        rare.publish(DisparityImage())
        time.sleep(0.02)


def typed(node: Node, name: str) -> None:
    kind = {'Bool': Bool, 'Header': Header}[name]
    publisher = node.create_publisher(kind, 'changing', 10)
    while True:
        publisher.publish(kind())
        time.sleep(0.02)


def call(node: Node, service: str) -> None:
    client = node.create_client(Trigger, service)
    assert client.wait_for_service(20.0)
    future = client.call_async(Trigger.Request())
    rclpy.spin_until_future_complete(node, future, timeout_sec=20.0)
    print(future.result().success, future.result().message, flush=True)


if __name__ == '__main__':
    rclpy.init()
    commands = {'flood': flood, 'mixed': mixed, 'typed': typed, 'call': call}
    commands[sys.argv[1]](Node(f'test_{sys.argv[1]}'), *sys.argv[2:])
