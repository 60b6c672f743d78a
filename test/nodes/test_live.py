"""The vehicle in real time: anyone can drive it, silence stops it, and bad input does no harm."""

import math
import os
import signal
from pathlib import Path

import numpy as np
import pytest

from omni_vehicle_ros.bags import open_bag, read_messages
from omni_vehicle_ros.messages import decode
from omni_vehicle_ros.wheels import WHEELS

from .conftest import Lab, finish, until

pytestmark = pytest.mark.graph


def diagnostics(directory: Path) -> list[tuple[int, str, str]]:
    """Return level, node and message of everything above OK that a bag has on /diagnostics."""
    said = []
    for message in read_messages(directory):
        if message.topic == '/diagnostics':
            said += [(s.level, s.name, s.message) for s in decode(message.type_name, message.data).statuses if s.level]
    return said


def test_anyone_can_drive(lab: Lab) -> None:
    """A process that knows nothing of us drives; when it falls silent, angles hold and the vehicle stops."""
    vehicle = lab.command('start', '--out', 'run')
    until(lambda: (lab.path / 'run' / 'bag' / 'bag_0.mcap').exists(), 'the vehicle to be up')
    outsider = lab.start(str(Path(__file__).with_name('outsider.py')), '60')
    out, _ = finish(outsider)
    words = dict(line.split(maxsplit=1) for line in out.splitlines())
    speed, yaw_rate = map(float, words['moving'].split())
    assert speed > 1.8
    assert yaw_rate > 0.15
    assert abs(float(words['stopped'])) < 0.02
    vehicle.send_signal(signal.SIGINT)
    finish(vehicle)
    bag = open_bag(lab.path / 'run' / 'bag')
    steer = bag['joint_states'].position[:, :4]
    moving = np.argmax(bag['odom'].vx)
    # Left turn about (0, 8): the angles stay where they were when the driver fell silent.
    assert np.allclose(steer[-1], steer[moving], atol=0.12)
    assert steer[-1][0] > 0.08
    assert any(
        'command_timeout' in text for _, name, text in diagnostics(lab.path / 'run' / 'bag') if name == '/icr_steering'
    )


def test_a_vehicle_that_loses_a_node_says_which(lab: Lab) -> None:
    """Kill the side-slip controller of a started vehicle: it drives on, and in the end names it, with exit code 2."""
    vehicle = lab.command('start', '--out', 'run')
    until(lambda: (lab.path / 'run' / 'bag' / 'bag_0.mcap').exists(), 'the vehicle to be up')
    (controller,) = [pid for pid in lab.left() if b'side_slip_controller' in Path(f'/proc/{pid}/cmdline').read_bytes()]
    os.kill(controller, signal.SIGKILL)
    until(lambda: controller not in lab.left(), 'the end of the controller')
    bag = lab.path / 'run' / 'bag'
    until(lambda: sum('no trim' in said for *_, said in diagnostics(bag)) >= 4, 'those who miss it')
    vehicle.send_signal(signal.SIGINT)
    _, errors = finish(vehicle, 2)
    assert 'side_slip_controller' in errors
    text = 'no trim from side_slip_controller'
    assert {name for _, name, said in diagnostics(lab.path / 'run' / 'bag') if text in said} == {
        f'/{wheel}/wheel_module' for wheel in WHEELS
    }
    assert (lab.path / 'run' / 'report.html').is_file()


BAD = """
import sys, time, math, rclpy
from geometry_msgs.msg import PointStamped, TwistStamped, WrenchStamped, Vector3Stamped
from sensor_msgs.msg import JointState
from diagnostic_msgs.msg import DiagnosticArray
rclpy.init()
node = rclpy.create_node('vandal')
seen = set()
node.create_subscription(DiagnosticArray, '/diagnostics', lambda m: seen.update(s.message for s in m.status), 50)
def point(x, y, frame='base_link'):
    m = PointStamped(); m.header.frame_id = frame; m.point.x = x; m.point.y = y; return m
def twist(v, frame='base_link'):
    m = TwistStamped(); m.header.frame_id = frame; m.twist.linear.x = v; return m
def joints(names, effort):
    m = JointState(); m.name = names; m.effort = effort; return m
def bank(x):
    m = Vector3Stamped(); m.vector.x = x; return m
cases = [
    ('driver/icr', point(math.nan, 5.0), 'finite'), ('driver/icr', point(0.0, math.inf), 'finite'),
    ('driver/icr', point(0.0, 5.0, 'map'), 'map'), ('driver/speed', twist(math.nan), 'finite'),
    ('driver/speed', twist(1.0, 'odom'), 'odom'), ('driver/speed', twist(400.0), '400'),
    ('cmd_vel', twist(-math.inf), 'finite'),
    ('environment/friction', joints(['front_left'], [math.nan]), 'nan'),
    ('environment/friction', joints(['fifth'], [0.5]), 'fifth'),
    ('environment/bank', bank(9.0), '9'), ('front_left/trim', JointState(), 'front_left/trim needs'),
    ('front_left/trim', JointState(), 'publishers (/side_slip_controller, /vandal): end all but one of'),
    ('rear_left/command', joints(['a'], [1.0]), 'rear_left/command needs'),
]
publishers = {}
for topic, message, word in cases:
    publisher = publishers.setdefault(topic, node.create_publisher(type(message), topic, 10))
    until = time.monotonic() + 20.0
    while not any(word in text for text in seen):
        publisher.publish(message)
        end = time.monotonic() + 0.05
        while time.monotonic() < end:
            rclpy.spin_once(node, timeout_sec=0.01)
        if time.monotonic() > until:
            sys.exit(f'no diagnostic with {word!r} for {topic}; said: {sorted(seen)}')
    seen.clear()
print('all named')
node.destroy_node()
rclpy.shutdown()
"""


def test_bad_input_is_named_and_does_no_harm(lab: Lab) -> None:
    """Every bad message gets a diagnostic that names it, and no topic of ours carries anything that is not finite."""
    vehicle = lab.command('start', '--out', 'run')
    until(lambda: (lab.path / 'run' / 'bag' / 'bag_0.mcap').exists(), 'the vehicle to be up')
    out, _ = finish(lab.start('-c', BAD))
    assert 'all named' in out
    vehicle.send_signal(signal.SIGINT)
    finish(vehicle)
    bag = open_bag(lab.path / 'run' / 'bag')
    for topic in ('joint_states', 'odom', 'tyres/side_slip', 'front_left/state', 'rear_right/state'):
        columns = bag[topic]
        for name in columns.names if topic == 'odom' else ('position', 'velocity', 'effort'):
            values = getattr(columns, name)
            assert values.dtype.kind != 'f' or np.isfinite(values).all(), f'{topic}.{name}'
    assert math.isfinite(bag['odom'].x[-1])


def test_lock_step_goes_on_without_a_frozen_module(lab: Lab) -> None:
    """A module that no longer answers is named, its wheel goes passive, and the graph does not hang."""
    scenario = lab.scenario(
        'duration: 4.0\nplant: {initial_speed: 2.0}\ncommands: [{at: 0.0, icr: straight, speed: 2.0}]\n'
    )
    command = lab.command('run', str(scenario), '--out', 'run')
    until(lambda: (lab.path / 'run' / 'bag' / 'bag_0.mcap').exists(), 'the recorder')
    file = lab.path / 'run' / 'bag' / 'bag_0.mcap'
    until(lambda: file.stat().st_size > 20_000, 'the first cycles')
    module = next(pid for pid in lab.left() if b'__ns:=/rear_left' in Path(f'/proc/{pid}/cmdline').read_bytes())
    os.kill(module, signal.SIGSTOP)
    finish(command)
    said = diagnostics(lab.path / 'run' / 'bag')
    assert any('rear_left/wheel_module' in text for _, name, text in said if name == '/plant')
    assert open_bag(lab.path / 'run' / 'bag')['odom'].stamp[-1] == 4.0
