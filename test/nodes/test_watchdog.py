"""A wheel module in real time that hears nothing any more looks after its wheel by its own clock."""

import pytest

from .conftest import Lab, finish

pytestmark = pytest.mark.graph

PLANT = r"""
import time, rclpy
from diagnostic_msgs.msg import DiagnosticArray
from sensor_msgs.msg import JointState

rclpy.init()
node = rclpy.create_node('vehicle')
beat = node.create_publisher(JointState, 'joint_states', 10)
command = node.create_publisher(JointState, 'front_left/command', 10)
states, said = [], []
node.create_subscription(JointState, 'front_left/state', states.append, 10)
node.create_subscription(DiagnosticArray, '/diagnostics', lambda m: said.extend(m.status), 50)
wheels = ('front_left', 'front_right', 'rear_left', 'rear_right')
joints = JointState(name=[f'{wheel}_{joint}' for joint in ('steer', 'drive') for wheel in wheels])
joints.position = joints.velocity = joints.effort = [0.0] * 8
asked = JointState(name=['front_left_steer', 'front_left_drive'])
asked.position, asked.velocity, asked.effort = [0.2, 0.0], [0.0, 0.0], [0.0, 300.0]


def until(condition, what, speaks):
    global cycle
    due = time.monotonic()
    end = due + 60.0
    while not condition():
        assert time.monotonic() < end, (what, states[-1:], said[-1:])
        if speaks and time.monotonic() >= due:
            cycle, due = cycle + 1, due + 0.005
            for message, publisher in ((asked, command), (joints, beat)):
                message.header.stamp.sec, message.header.stamp.nanosec = divmod(cycle * 5_000_000, 10**9)
                publisher.publish(message)
        rclpy.spin_once(node, timeout_sec=0.005)


def pulls():
    return states and states[-1].effort[1] > 250.0


def follows():
    return said and said[-1].message == 'following its set-points'


cycle = 0
for angle in (0.0, 0.3):
    begin, joints.position[0] = len(states), angle  # where the module finds its wheel
    until(lambda: pulls() and follows(), 'the module to follow', True)
    assert not begin or states[begin].position[0] == angle
    until(lambda: states[-1].effort[1] == 0.0 and said[-1].level == b'\x02', 'the module to fall back', False)
    assert 'no joint_states from plant for module_timeout, 0.1 s' in said[-1].message
    assert states[-1].position[0] == angle
    assert states[-1].velocity[0] == 0.0
print('fell back twice', flush=True)
node.destroy_node()
rclpy.shutdown()
"""


def test_a_module_that_hears_nothing_lets_go_of_its_wheel_and_comes_back(lab: Lab) -> None:
    plant = lab.start('-c', PLANT)
    module = lab.node('wheel_module', '-p', 'participants:=[plant, icr_steering]', namespace='front_left')
    out, _ = finish(plant)
    assert out == 'fell back twice\n'
    module.terminate()
    finish(module)
