"""Nodes of one process talk over DDS when anybody else listens, and only then; their messages are the same."""

import json
import subprocess

import pytest

from omni_vehicle_ros.graph import node_parameters
from omni_vehicle_ros.interface import NODES
from omni_vehicle_ros.parameters import PacingParameters
from omni_vehicle_ros.scenarios import Scenario, load_scenario
from omni_vehicle_ros.simulation import simulate

from .conftest import SHORT, Lab, finish
from .test_modes import contents

pytestmark = pytest.mark.graph

SWITCH = """
import time

import rclpy

from omni_vehicle_ros.interface import topic
from omni_vehicle_ros.messages import Odometry, decode
from omni_vehicle_ros.nodes.exchange import Exchange, Inlet
from omni_vehicle_ros.nodes.ports import publish_on, subscribe_to

rclpy.init()
node, exchange, row = rclpy.create_node('one'), Exchange(), topic('odom')
values, data, wakes = [], [], []
exchange.wake = lambda: wakes.append(1)


def inlet(take_data, *take_value):
    exchange.add_inlet(Inlet(subscribe_to(node, row, '', take_data), take_data, *take_value))


inlet(lambda found: values.append(decode(row.type, found)), values.append)
inlet(data.append)
outlet = exchange.outlet(publish_on(node, row, ''), row)


def listeners(count):
    end = time.monotonic() + 60.0
    while outlet.publisher.get_subscription_count() != count:
        assert time.monotonic() < end, f'{outlet.publisher.get_subscription_count()} listen'
        time.sleep(0.01)


def say(number):
    outlet.say(Odometry(number, 0.0, 0.0, 0.5, 1.0, 0.0, 0.0))


def deliver():
    exchange.deliver(time.monotonic() + 10.0)


stranger = subscribe_to(node, row, '', print)
listeners(3)
exchange.look()
for number in range(10):
    say(number)  # over DDS, which nobody serves
assert not exchange.waits
node.destroy_subscription(stranger)
listeners(2)
exchange.look()
assert len(values) == len(data) == 10 and not wakes
for number in range(10, 20):
    say(number)
assert len(values) == 10 and len(wakes) == 1
deliver()
for number in range(20, 30):
    say(number)
stranger = subscribe_to(node, row, '', print)
listeners(3)
exchange.look()
assert len(values) == len(data) == 30 and not exchange.waits
say(30)
assert not exchange.waits
node.destroy_subscription(stranger)
listeners(2)
exchange.look()
assert [value.stamp for value in values] == [decode(row.type, one).stamp for one in data] == list(range(31))
node.destroy_node()
rclpy.shutdown()
"""


def test_no_message_overtakes_another_where_the_way_changes(lab: Lab) -> None:
    """Messages on the way over DDS are taken before those that are handed over next, and the other way round."""
    finish(lab.start('-c', SWITCH))


COUNTING = """
import json
import sys
from collections import Counter

from omni_vehicle_ros.nodes import managed, vehicle

published = Counter()


class Handle:
    def __init__(self, publisher, topic):
        self.publisher, self.topic = publisher, topic

    def publish_raw(self, data):
        published[self.topic] += 1
        self.publisher.handle.publish_raw(data)


class Counted:
    def __init__(self, publisher):
        self.publisher, self.handle = publisher, Handle(publisher, publisher.topic_name)

    def __getattr__(self, name):
        return getattr(self.publisher, name)


def publish_on(*arguments, make=managed.publish_on):
    return Counted(make(*arguments))


managed.publish_on = publish_on
try:
    vehicle.main()
finally:
    print(json.dumps(published))
"""


def test_nothing_is_published_where_nobody_listens(lab: Lab) -> None:
    """Of a recorded run in one process, only what DDS keeps for those who come later goes over it."""
    vehicle, expected = recorded_vehicle(lab, load_scenario(str(lab.scenario())), COUNTING)
    out, _ = finish(vehicle)
    published = json.loads(out.splitlines()[-1])
    latched = {topic: len(expected[topic]) for topic in expected if 'environment' in topic or 'emergency' in topic}
    assert published == {'/ready': 9, **latched}
    assert contents(lab.path) == expected


def recorded_vehicle(
    lab: Lab, scenario: Scenario, program: str
) -> tuple['subprocess.Popen[str]', dict[str, list[tuple[int, bytes]]]]:
    """Start all nodes of a scenario by a program, in lock step; return what their bag should hold, too."""
    simulate(scenario, lab.path / 'offline' / 'bag')
    parameters, pacing = lab.path / 'parameters.yaml', PacingParameters(pacing='lockstep', participants=NODES)
    (lab.path / 'scenario.yaml').write_text(scenario.as_yaml())
    parameters.write_text(node_parameters(scenario, lab.path, pacing))
    process = lab.start('-c', program, '--nodes', *NODES, '--ros-args', '--params-file', str(parameters))
    return process, contents(lab.path / 'offline')


VISITOR = """
import itertools
import sys
import time

import rclpy
from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState

rclpy.init()
node = rclpy.create_node('visitor')
kinds = {'odom': Odometry, 'joint_states': JointState, 'rear_left/state': JointState, '/clock': Clock}
print('here', flush=True)
for visit in itertools.count(1):
    heard = {topic: [] for topic in kinds}
    ears = [node.create_subscription(kind, name, heard[name].append, 1000) for name, kind in kinds.items()]
    while min(map(len, heard.values())) < 20:
        rclpy.spin_once(node, timeout_sec=0.1)
    for found in heard.values():
        stamps = [getattr(message, 'header', message) for message in found]
        times = [at.clock if isinstance(at, Clock) else at.stamp for at in stamps]
        times = [time.sec * 10**9 + time.nanosec for time in times]
        assert all(after > before for before, after in zip(times, times[1:])), times
    for ear in ears:
        node.destroy_subscription(ear)
    print(visit, flush=True)
"""


def test_lock_step_goes_on_while_listeners_come_and_go(lab: Lab) -> None:
    """They hear nothing twice; no cycle is skipped, and the bag is that of a run without ROS."""
    visitor = lab.start('-c', VISITOR)
    assert visitor.stdout is not None
    assert visitor.stdout.readline() == 'here\n'
    scenario = load_scenario(str(lab.scenario(SHORT.replace('duration: 2.0', 'duration: 6.0'))))
    vehicle, expected = recorded_vehicle(lab, scenario, 'from omni_vehicle_ros.nodes.vehicle import main; main()')
    _, warnings = finish(vehicle)
    visitor.kill()
    visits, errors = visitor.communicate()
    assert not errors
    assert len(visits.splitlines()) >= 2
    assert contents(lab.path) == expected
    assert not warnings


NEIGHBOUR = """
import sys
import time

import rclpy
from geometry_msgs.msg import PointStamped, TwistStamped
from nav_msgs.msg import Odometry

rclpy.init()
node = rclpy.create_node('neighbour')
icr = node.create_publisher(PointStamped, 'driver/icr', 10)
speed = node.create_publisher(TwistStamped, 'driver/speed', 10)
centre, forward = PointStamped(), TwistStamped()
centre.point.y, forward.twist.linear.x = 8.0, 2.0


def drive():
    icr.publish(centre)
    speed.publish(forward)


node.create_timer(0.05, drive)
for lap in range(3):
    heard = []
    ear = node.create_subscription(Odometry, 'odom', heard.append, 1000)
    end = time.monotonic() + 60.0
    while len(heard) < 100 or heard[-1].twist.twist.angular.z < 0.15:
        assert time.monotonic() < end, heard[-1:]
        rclpy.spin_once(node, timeout_sec=0.1)
    node.destroy_subscription(ear)
    stamps = [message.header.stamp.sec * 10**9 + message.header.stamp.nanosec for message in heard]
    steps = {after - before for before, after in zip(stamps, stamps[1:])}
    assert steps == {5_000_000}, steps
node.destroy_node()
rclpy.shutdown()
"""


def test_anyone_can_drive_and_hears_every_message(lab: Lab) -> None:
    """In real time, from the first message on that an outsider hears; each time that it comes back, too."""
    vehicle = lab.node('vehicle')
    finish(lab.start('-c', NEIGHBOUR))
    vehicle.terminate()
    finish(vehicle)
