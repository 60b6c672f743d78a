"""The emergency stop over DDS, from latched and from volatile publishers, and what the policy lets the nodes do."""

import json
import signal
from pathlib import Path

import pytest

from omni_vehicle_ros.bags import open_bag
from omni_vehicle_ros.scenarios.sros2 import rights

from .conftest import Lab, finish, until
from .test_live import diagnostics

pytestmark = pytest.mark.graph

DRIVER = """
import sys, time, rclpy
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import TwistStamped
from nav_msgs.msg import Odometry
from std_msgs.msg import Bool

rclpy.init()
node = rclpy.create_node('hand')
twist = node.create_publisher(TwistStamped, 'teleop/cmd_vel', 10)
stop = node.create_publisher(Bool, 'emergency_stop', 10)
autonomy = node.create_publisher(TwistStamped, 'cmd_vel', 10)
seen, said = [], []
node.create_subscription(Odometry, 'odom', seen.append, 10)
node.create_subscription(
    DiagnosticArray, '/diagnostics', lambda m: said.extend(f'{s.name}: {s.message}' for s in m.status), 50
)


def drive(speed, condition, what, stopped=None):
    # Command until the condition holds: all that happens is brought about by commands, and seen in the answers.
    end, begin = time.monotonic() + 60.0, len(seen)
    del said[:]
    while not (len(seen) > begin + 20 and condition()):
        assert time.monotonic() < end, f'{what}: in vain; at {seen[-1].twist.twist.linear.x:.2f} m/s; {set(said)}'
        message = TwistStamped()
        message.twist.linear.x = speed
        twist.publish(message)
        message.twist.linear.x = -1.0
        autonomy.publish(message)
        if stopped is not None:
            stop.publish(Bool(data=stopped))
        rclpy.spin_once(node, timeout_sec=0.02)


def speed():
    return seen[-1].twist.twist.linear.x


def heard(word):
    return any(word in text for text in said)


def released():
    return any(text.startswith('/icr_steering:') and 'emergency stop' not in text for text in said)


drive(2.0, lambda: speed() > 1.8, 'driving')
drive(2.0, lambda: heard('cmd_vel is ignored: teleop/cmd_vel holds'), 'saying who is ignored')
drive(2.0, lambda: abs(speed()) < 0.02 and heard('wheel braked'), 'stopping', stopped=True)
drive(2.0, lambda: heard('emergency stop: command speed 0'), 'asking for speed 0', stopped=False)
assert abs(speed()) < 0.02, speed()
drive(0.0, released, 'being released')
drive(2.0, lambda: speed() > 1.8, 'driving again')
print('obeyed', flush=True)
node.destroy_node()
rclpy.shutdown()
"""

LATE = """
import time, rclpy
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool

rclpy.init()
node = rclpy.create_node('button')
latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
node.create_publisher(Bool, 'emergency_stop', latched).publish(Bool(data=True))
print('pressed', flush=True)
beat = node.create_publisher(JointState, 'joint_states', 10)
torques, said = [], []
node.create_subscription(JointState, 'front_left/state', lambda m: torques.append(m.effort[1]), 10)
node.create_subscription(DiagnosticArray, '/diagnostics', lambda m: said.extend(s.message for s in m.status), 50)
wheels = ('front_left', 'front_right', 'rear_left', 'rear_right')
message = JointState(name=[f'{wheel}_{joint}' for joint in ('steer', 'drive') for wheel in wheels])
message.position = message.effort = [0.0] * 8
message.velocity = [0.0] * 4 + [10.0] * 4
end, count = time.monotonic() + 60.0, 0
while not (torques and torques[-1] < -100.0 and any('emergency stop: wheel braked' in text for text in said)):
    assert time.monotonic() < end, (torques[-1:], set(said))
    count += 1
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(count * 5_000_000, 10**9)
    beat.publish(message)
    rclpy.spin_once(node, timeout_sec=0.01)
print('braked', flush=True)
node.destroy_node()
rclpy.shutdown()
"""

GRAPH = """
import sys, time, json, rclpy
from omni_vehicle_ros.interface import NODES, resolve

rclpy.init()
node = rclpy.create_node('looking')
vehicle = [name for name in NODES if name != 'driver']
end = time.monotonic() + 60.0


def look(name):
    namespace, _, own = resolve(name, '').rpartition('/')
    def names(call):
        return sorted(entry for entry, _ in call(own, namespace or '/'))
    return {
        'publish': names(node.get_publisher_names_and_types_by_node),
        'subscribe': names(node.get_subscriber_names_and_types_by_node),
        'reply': names(node.get_service_names_and_types_by_node),
    }


while True:
    try:
        found = {name: look(name) for name in vehicle}
        if all(len(each['reply']) >= 6 and '/ready' in each['publish'] for each in found.values()):
            break
    except Exception as error:
        assert time.monotonic() < end, error
    assert time.monotonic() < end, found
    rclpy.spin_once(node, timeout_sec=0.1)
print(json.dumps(found), flush=True)
node.destroy_node()
rclpy.shutdown()
"""


def test_a_volatile_publisher_stops_the_vehicle_and_false_alone_does_not_release_it(lab: Lab) -> None:
    vehicle = lab.command('start', '--out', 'run')
    until(lambda: (lab.path / 'run' / 'bag' / 'bag_0.mcap').exists(), 'the vehicle to be up')
    out, _ = finish(lab.start('-c', DRIVER))
    assert 'obeyed' in out
    vehicle.send_signal(signal.SIGINT)
    finish(vehicle)
    said = diagnostics(lab.path / 'run' / 'bag')
    braked = {name for _, name, text in said if 'emergency stop: wheel braked' in text}
    assert len(braked) == 4
    assert open_bag(lab.path / 'run' / 'bag')['odom'].vx.min() > -0.05


def test_a_wheel_that_starts_late_and_alone_hears_the_latched_stop(lab: Lab) -> None:
    """There is no ICR steering at all; the button was pressed before the wheel module came."""
    button = lab.start('-c', LATE)
    assert button.stdout is not None
    assert button.stdout.readline() == 'pressed\n'
    module = lab.node('wheel_module', namespace='front_left')
    out, _ = finish(button)
    assert 'braked' in out
    module.terminate()
    finish(module)


def test_nodes_are_confined_to_this_machine_and_the_policy_covers_what_they_do(lab: Lab) -> None:
    del lab.environment['ROS_AUTOMATIC_DISCOVERY_RANGE']
    vehicle = lab.command('start', '--out', 'run')
    until(lambda: (lab.path / 'run' / 'bag' / 'bag_0.mcap').exists(), 'the vehicle to be up')
    children = [pid for pid in lab.left() if pid != vehicle.pid]
    assert len(children) >= 8
    for pid in children:
        assert b'ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST' in Path(f'/proc/{pid}/environ').read_bytes().split(b'\0')
    out, _ = finish(lab.start('-c', GRAPH, environment={'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST'}))
    found = json.loads(out.splitlines()[-1])
    allowed = {each.name: each for each in rights()}
    for name, does in found.items():
        may, own = allowed[name], f'/{name}'
        free = {'/rosout', '/parameter_events', '/clock'}
        publishes = {f'/{topic.strip("/")}'.replace('/~', own) for topic in may.publishes}
        assert {*does['publish']} <= publishes | free, name
        assert {*does['subscribe']} <= {f'/{topic.strip("/")}' for topic in may.reads} | free, name
        assert {*does['reply']} <= {service.replace('~', own) for service in may.replies}, name
    vehicle.send_signal(signal.SIGINT)
    finish(vehicle)
