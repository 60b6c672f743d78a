"""A process that floods a vehicle: run beside ``omni_vehicle start``.

``flooding.py commands RATE SECONDS``: driver/icr, driver/speed and cmd_vel in turn, RATE messages a second in sum.

``flooding.py garbage SECONDS``: on every topic of the wiring table its own type with random content,
which hypothesis makes.

``flooding.py siege RATE SECONDS``: ``commands``, and between them garbage of at most 64 KiB a message; then says how
many messages that were. It stays, and does it again, with other garbage, at each SIGUSR1.

``flooding.py strangers``: every installed type of common_interfaces on one of the topics of the vehicle, with random
content.

``flooding.py huge COUNT``: messages of 10 MB on topics with arrays.

``flooding.py drive SECONDS``: a sane driver, until the vehicle obeys; says how fast it goes.

Each but ``siege`` says in the end how many messages were sent, and how many a second.
"""

import importlib
import math
import os
import random
import re
import signal
import sys
import threading
import time
from array import array
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import rclpy
from ament_index_python.packages import get_package_share_directory
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from geometry_msgs.msg import PointStamped, TwistStamped
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st
from nav_msgs.msg import Odometry
from rclpy.context import Context
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.serialization import serialize_message
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool

from omni_vehicle_ros.interface import TOPICS
from omni_vehicle_ros.wheels import WHEELS

PACKAGES = (
    'actionlib_msgs', 'diagnostic_msgs', 'geometry_msgs', 'nav_msgs', 'sensor_msgs', 'shape_msgs', 'std_msgs',
    'stereo_msgs', 'trajectory_msgs', 'visualization_msgs',
)
ROUND = 100
"""Examples that hypothesis makes at a time."""

LONGEST = 1 << 16
"""Fast DDS takes longer messages to pieces [byte]."""
LARGEST = 10_000_000 // 8
MOST = 20
"""Elements of the arrays of arrays."""

Said = tuple[Publisher, bytes]

INTEGERS = {f'{sign}int{bits}': (sign, bits) for sign in ('', 'u') for bits in (8, 16, 32, 64)}

WORDS = [
    '', 'base_link', 'odom', 'map', *WHEELS, *(f'{wheel}_{joint}' for joint in ('steer', 'drive') for wheel in WHEELS)
]
_texts = st.one_of(
    st.sampled_from(WORDS),
    st.text(st.characters(exclude_categories=['Cs'], exclude_characters='\0'), max_size=20),
    st.just('x' * 10_000),
)
_numbers = st.one_of(st.floats(width=32), st.sampled_from([0.0, 1.0, -0.1, 1e9, 1e300, math.nan, math.inf, -math.inf]))
_lengths = st.sampled_from([0, 1, 2, 4, 8, 1000])


def message_class(type_name: str) -> Any:
    """Return the class of ``geometry_msgs/msg/Point``, or of ``geometry_msgs/Point``, as fields have it."""
    package, *_, name = type_name.split('/')
    return getattr(importlib.import_module(f'{package}.msg'), name)


def field(type_name: str, depth: int = 0) -> st.SearchStrategy[Any]:
    """Generate values of a field from the name of its type."""
    if found := re.fullmatch(r'sequence<(.*?)(?:, (\d+))?>', type_name):
        limit = int(found[2] or 2**31)
        return _sequence(found[1], _lengths.filter(lambda length: length <= limit), depth)
    if found := re.fullmatch(r'(.*)\[(\d+)\]', type_name):
        return _sequence(found[1], st.just(int(found[2])), depth)
    if type_name.startswith(('string', 'wstring')):
        return _texts
    if type_name in ('double', 'float'):
        return _numbers if type_name == 'double' else st.floats(width=32)
    if type_name == 'boolean':
        return st.booleans()
    if type_name == 'octet':
        return st.binary(min_size=1, max_size=1)
    if type_name in INTEGERS:
        sign, bits = INTEGERS[type_name]
        return st.integers(0, 2**bits - 1) if sign else st.integers(-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)
    return message(message_class(type_name), depth + 1)


def _sequence(element: str, lengths: st.SearchStrategy[int], depth: int) -> st.SearchStrategy[Any]:
    """Generate arrays, of which the long ones repeat a few elements."""
    most = MOST if depth or '/' in element else 10**6
    few = st.lists(field(element, depth), min_size=1, max_size=3)
    return st.builds(lambda length, values: (values * (min(length, most) // len(values) + 1))[:length], lengths, few)


def message(kind: Any, depth: int = 0) -> st.SearchStrategy[Any]:
    """Generate messages of a class, from what it says of its fields."""
    fields = {name: field(type_name, depth) for name, type_name in kind.get_fields_and_field_types().items()}
    return st.builds(lambda **values: _filled(kind, values), **fields)


def _filled(kind: Any, values: dict[str, Any]) -> Any:
    made = kind()
    for name, value in values.items():
        setattr(made, name, value)
    return made


def wild(strategy: st.SearchStrategy[Any], use: Callable[[Any], None], examples: int) -> None:
    """Call ``use`` with so many examples."""
    choice = settings(
        max_examples=examples, deadline=None, database=None, phases=[Phase.generate],
        suppress_health_check=list(HealthCheck),
    )
    choice(given(strategy)(use))()


def commands(node: Node, rate: str, seconds: str) -> int:
    """Publish sane commands, far too many of them."""
    return pour(sane_commands(node), [], int(rate), float(seconds))


def sane_commands(node: Node) -> list[Said]:
    """Return commands to drive, with their publishers, when somebody listens to each."""
    forward, centre = TwistStamped(), PointStamped()
    forward.header.frame_id = centre.header.frame_id = 'base_link'
    forward.twist.linear.x, centre.point.y = 2.0, 8.0
    pairs = [
        (node.create_publisher(type(said), topic, 10), serialize_message(said))
        for topic, said in (('driver/icr', centre), ('driver/speed', forward), ('cmd_vel', forward))
    ]
    await_matched(publisher for publisher, _ in pairs)
    return pairs


def pour(pairs: list[Said], beside: list[Said], rate: int, seconds: float) -> int:
    """Publish some in turn, so many a second, and others once in that time; return how many that were."""
    begin, sent, thrown = time.monotonic(), 0, 0
    while (now := time.monotonic() - begin) < seconds:
        while sent < now * rate:
            publisher, data = pairs[sent % len(pairs)]
            publisher.publish(data)
            sent += 1
        while thrown < now / seconds * len(beside):
            publisher, data = beside[thrown]
            publisher.publish(data)
            thrown += 1
        time.sleep(0.001)
    return sent + thrown


def siege(node: Node, rate: str, seconds: str) -> int:
    """Publish commands and garbage at once, again and again."""
    again = threading.Event()
    signal.signal(signal.SIGUSR1, lambda number, frame: again.set())
    pairs = sane_commands(node)
    publishers = [(node.create_publisher(message_class(row.type), row.name, 10), row.type) for row in TOPICS]
    while True:
        beside: list[Said] = []
        for publisher, type_name in publishers:
            beside += [(publisher, data) for data in random_bytes(type_name) if len(data) <= LONGEST]
        random.shuffle(beside)
        print('flooded', pour(pairs, beside, int(rate), float(seconds)), flush=True)
        again.wait()
        again.clear()


def garbage(node: Node, seconds: str) -> int:
    """Publish random content of the right types."""
    pairs = [(node.create_publisher(message_class(row.type), row.name, 10), row.type) for row in TOPICS]
    await_matched(publisher for publisher, _ in pairs[:1])
    end, sent = time.monotonic() + float(seconds), 0
    wholes = [(publisher, message(message_class(type_name))) for publisher, type_name in pairs]
    while time.monotonic() < end:
        for publisher, whole in wholes:
            wild(whole, publisher.publish, examples=5)
            sent += 5
    return sent


def random_bytes(type_name: str) -> list[bytes]:
    """Return random messages of a type."""
    found = []

    def keep(value: Any) -> None:
        found.append(serialize_message(value))

    wild(message(message_class(type_name)), keep, examples=5)
    return found


def installed_types() -> list[str]:
    """Return the names of all message types of common_interfaces that are installed."""
    found = []
    for package in PACKAGES:
        folder = Path(get_package_share_directory(package)) / 'msg'
        found += [f'{package}/msg/{file.stem}' for file in sorted(folder.glob('*.msg'))]
    return found


def strangers(node: Node) -> int:
    """Publish every type on some topic that has another; a participant can have one type for a topic."""
    types, sent = installed_types(), 0
    for first in range(0, len(types), len(TOPICS)):
        context = Context()
        rclpy.init(context=context)
        other = Node(f'test_strangers_{first}', context=context)
        for row, type_name in zip(TOPICS, types[first:], strict=False):
            publisher = other.create_publisher(message_class(type_name), row.name, 10)
            wild(message(message_class(type_name)), publisher.publish, examples=3)
            sent += 3
        other.destroy_node()
        context.try_shutdown()
    return sent


def huge(node: Node, count: str) -> int:
    """Publish messages of 10 MB."""
    joints = JointState(name=['front_left'], position=array('d', bytes(8 * LARGEST)))
    names = JointState(name=[f'wheel_{number}' for number in range(500_000)])
    values = [KeyValue(key='k', value='v' * 100)] * 100
    faults = DiagnosticArray(status=[DiagnosticStatus(name='n' * 100, values=values)] * 800)
    made = [
        (node.create_publisher(type(said), topic, 10), serialize_message(said))
        for topic, said in (
            ('environment/friction', joints), ('joint_states', joints), ('front_left/trim', joints),
            ('rear_left/command', names), ('faults', faults), ('/diagnostics', faults),
        )
    ]
    await_matched(publisher for publisher, _ in made[:-1])
    for _ in range(int(count)):
        for publisher, data in made:
            publisher.publish(data)
            time.sleep(0.05)
    return int(count) * len(made)


def drive(node: Node, seconds: str) -> int:
    """Let the emergency stop go, stand, and then drive until the vehicle obeys."""
    icr = node.create_publisher(PointStamped, 'driver/icr', 10)
    speed = node.create_publisher(TwistStamped, 'driver/speed', 10)
    stop = node.create_publisher(Bool, 'emergency_stop', 10)
    seen: list[Odometry] = []
    node.create_subscription(Odometry, 'odom', seen.append, 10)
    centre, forward = PointStamped(), TwistStamped()
    centre.header.frame_id = forward.header.frame_id = 'base_link'
    centre.point.y = 8.0
    await_matched((icr, speed, stop))
    sent, end, stood = 0, time.monotonic() + float(seconds), False
    while time.monotonic() < end:
        until = time.monotonic() + 0.05
        while time.monotonic() < until:
            rclpy.spin_once(node, timeout_sec=0.01)
        icr.publish(centre)
        speed.publish(forward)
        sent += 2
        twist = seen[-1].twist.twist if seen else None
        if not stood:
            stop.publish(Bool(data=False))
            stood = twist is not None and abs(twist.linear.x) < 0.02 and sent > 40
            forward.twist.linear.x = 2.0 if stood else 0.0
        elif twist and twist.linear.x > 1.8 and twist.angular.z > 0.15:
            print('obeys', flush=True)
            break
    last = seen[-1].twist.twist if seen else None
    print(f'moving {last.linear.x:.3f} {last.angular.z:.3f}' if last else 'no odom', flush=True)
    return sent


def await_matched(publishers: Iterable[Publisher]) -> None:
    """Wait until somebody listens to each."""
    for publisher in publishers:
        end = time.monotonic() + 20.0
        while not publisher.get_subscription_count():
            assert time.monotonic() < end, f'nobody listens to {publisher.topic_name}'
            time.sleep(0.02)


if __name__ == '__main__':
    os.environ.setdefault('AMENT_PREFIX_PATH', sys.prefix)  # where the wheels put what they share
    rclpy.init()
    parts = {
        'commands': commands, 'garbage': garbage, 'siege': siege, 'strangers': strangers, 'huge': huge, 'drive': drive,
    }
    begin = time.monotonic()
    sent = parts[sys.argv[1]](Node(f'test_{sys.argv[1]}'), *sys.argv[2:])
    print('sent', sent, round(sent / (time.monotonic() - begin)), flush=True)
