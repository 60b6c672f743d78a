"""The URDF: a tree of links whose joints and measures are those of the vehicle."""

import dataclasses
import math
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from numpy.testing import assert_allclose

from omni_vehicle_ros import parameters
from omni_vehicle_ros.components.joints import JOINT_NAMES
from omni_vehicle_ros.scenarios.urdf import default_urdf, urdf
from omni_vehicle_ros.wheels import WHEELS

SHIPPED = Path(__file__).parents[2] / 'urdf' / 'omni_vehicle.urdf'
LONG = parameters.VehicleParameters(
    cg_to_front_axle=2.5, cg_to_rear_axle=1.1, front_track=1.9, rear_track=1.3, wheel_radius=0.42
)


def numbers(text):
    return np.array([float(word) for word in text.split()])


def robot_of(vehicle):
    text = urdf(vehicle, parameters.WheelModuleParameters(), parameters.SteeringParameters())
    return ElementTree.fromstring(text)


def joints_of(robot):
    return {joint.get('name'): joint for joint in robot.findall('joint')}


def axis_angle(axis, angle):
    """Rotation by the formula of Rodrigues."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross


def pose(robot, link, angles):
    """Return place and rotation of a link in base_link, as robot_state_publisher works them out."""
    joint = next((j for j in robot.findall('joint') if j.find('child').get('link') == link), None)
    if joint is None:
        return np.zeros(3), np.eye(3)
    place, rotation = pose(robot, joint.find('parent').get('link'), angles)
    place = place + rotation @ numbers(joint.find('origin').get('xyz'))
    assert not numbers(joint.find('origin').get('rpy')).any()
    return place, rotation @ axis_angle(numbers(joint.find('axis').get('xyz')), angles.get(joint.get('name'), 0.0))


def test_the_shipped_file_is_that_of_the_defaults():
    assert SHIPPED.read_text(encoding='utf-8') == default_urdf(), (
        'python -m omni_vehicle_ros.scenarios.urdf > urdf/omni_vehicle.urdf'
    )


def test_the_joints_are_those_of_joint_states():
    joints = joints_of(robot_of(LONG))
    assert set(joints) == set(JOINT_NAMES)
    assert {name: joint.get('type') for name, joint in joints.items()} == {
        name: 'revolute' if name.endswith('_steer') else 'continuous' for name in JOINT_NAMES
    }


def test_the_links_are_a_tree_on_base_link():
    robot = robot_of(LONG)
    links = [link.get('name') for link in robot.findall('link')]
    parents = {joint.find('child').get('link'): joint.find('parent').get('link') for joint in robot.findall('joint')}
    assert len(set(links)) == len(links) == len(parents) + 1
    assert set(links) - set(parents) == {'base_link'}
    assert {f'{wheel}_wheel' for wheel in WHEELS} < set(links)
    for link in parents:
        steps = 0
        while link != 'base_link':
            link, steps = parents[link], steps + 1
            assert steps <= len(links)


@pytest.mark.parametrize('vehicle', [parameters.VehicleParameters(), LONG], ids=['thesis', 'long'])
def test_wheels_are_where_the_vehicle_has_them_however_they_turn(vehicle):
    robot = robot_of(vehicle)
    angles = {name: 0.3 + 0.1 * place for place, name in enumerate(JOINT_NAMES)}
    for number, wheel in enumerate(WHEELS):
        place, rotation = pose(robot, f'{wheel}_wheel', angles)
        assert_allclose(place, (vehicle.wheel_x[number], vehicle.wheel_y[number], vehicle.wheel_radius), atol=1e-9)
        steer = angles[f'{wheel}_steer']
        assert_allclose(rotation @ (0, 1, 0), (-math.sin(steer), math.cos(steer), 0), atol=1e-12)
        sized = robot.find(f"link[@name='{wheel}_wheel']/visual/geometry/cylinder")
        assert float(sized.get('radius')) == pytest.approx(vehicle.wheel_radius)


def test_a_wheel_that_turns_forward_rolls_forward():
    """Its lowest point then moves backward in the frame of the vehicle, as the road under it does."""
    robot, step = robot_of(LONG), 1e-6
    for wheel in WHEELS:
        before, _ = pose(robot, f'{wheel}_wheel', {})
        _, rotation = pose(robot, f'{wheel}_wheel', {f'{wheel}_drive': step})
        lowest = before + rotation @ (0, 0, -LONG.wheel_radius)
        assert_allclose((lowest[0] - before[0]) / step, -LONG.wheel_radius, rtol=1e-6)


def test_limits_are_those_of_the_modules():
    module = dataclasses.replace(parameters.WheelModuleParameters(), steer_limit=1.1, drive_torque_limit=77.0)
    robot = ElementTree.fromstring(urdf(LONG, module, parameters.SteeringParameters(maximum_wheel_speed=21.0)))
    joints = joints_of(robot)
    steer, drive = (joints[f'front_left_{kind}'].find('limit').attrib for kind in ('steer', 'drive'))
    assert (float(steer['lower']), float(steer['upper'])) == (-1.1, 1.1)
    assert float(steer['velocity']) == module.steer_rate_limit
    assert (float(drive['effort']), float(drive['velocity'])) == (77.0, pytest.approx(21.0 / LONG.wheel_radius))
