"""A process that publishes: run by the tests of the recorder.

``publishers.py flood FIRST TOPICS RATE SECONDS``: small messages on TOPICS topics, RATE a second on each, numbered from
0 in their stamps. Says what it sent, and at what rate.

``publishers.py mixed``: one message on a latched topic before anybody listens, then slowly others until it is killed.

``publishers.py call SERVICE``: calls a Trigger and prints the answer.
"""

import sys
import time

import rclpy
from geometry_msgs.msg import TwistStamped
from rclpy.context import Context
from rclpy.duration import Duration
from rclpy.node import Node
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
    while not all(publisher.get_subscription_count() for publisher in publishers):
        time.sleep(0.02)
    time.sleep(0.5)  # that one side has matched does not mean that the other has
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


def call(node: Node, service: str) -> None:
    client = node.create_client(Trigger, service)
    assert client.wait_for_service(20.0)
    future = client.call_async(Trigger.Request())
    rclpy.spin_until_future_complete(node, future, timeout_sec=20.0)
    print(future.result().success, future.result().message, flush=True)


if __name__ == '__main__':
    rclpy.init()
    {'flood': flood, 'mixed': mixed, 'call': call}[sys.argv[1]](Node(f'test_{sys.argv[1]}'), *sys.argv[2:])
