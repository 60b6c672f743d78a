"""The component of the side-slip controller: what it takes, what it says, and which law it runs."""

import pytest

from omni_vehicle_ros.components.joints import VehicleJoints
from omni_vehicle_ros.components.side_slip_controller import SideSlipController
from omni_vehicle_ros.messages import Diagnostics, Imu, Joints, Odometry, Twist
from omni_vehicle_ros.parameters import SideSlipParameters, VehicleParameters
from omni_vehicle_ros.wheels import WHEELS

VEHICLE = VehicleParameters()
STEP = 5_000_000


def component(name, **values):
    return SideSlipController(SideSlipParameters(controller=name, **values), VEHICLE)


def turning(controller, stamp=0):
    """Give it all inputs of a vehicle that turns too little, and let it act."""
    for topic, value in (
        ('odom', Odometry(stamp, 0.0, 0.0, 0.0, 4.0, -0.1, 0.7)),
        ('imu', Imu(stamp, 0.02, 0.0, 0.7, 0.0, 2.9, 9.81)),
        ('tyres/side_slip', Joints(stamp, WHEELS, (0.05, 0.03, 0.03, 0.02), (4.0,) * 4, (0.5,) * 4)),
        ('commanded_twist', Twist(stamp, 4.0, 0.0, 0.8)),
        ('joint_states', VehicleJoints((0.23, 0.17, -0.33, -0.25), torque=(20.0,) * 4).message(stamp, 'base_link')),
    ):
        controller.receive(topic, value, stamp)
    return controller.step(stamp)


def trims(outputs):
    return {output.topic: output.value for output in outputs if output.topic != '/diagnostics'}


@pytest.mark.parametrize('name', ['wheel_slip', 'yaw_moment', 'rear_steering', 'allocation'])
def test_every_cycle_has_a_trim_for_each_wheel(name):
    controller = component(name)
    assert set(controller.sources) == {'odom', 'imu', 'tyres/side_slip', 'commanded_twist'}
    found = trims(turning(controller))
    assert list(found) == [f'{wheel}/trim' for wheel in WHEELS]
    for wheel, value in zip(WHEELS, found.values(), strict=True):
        assert value.names == (f'{wheel}_steer', f'{wheel}_drive')
        assert (len(value.position), len(value.velocity), len(value.effort)) == (2, 2, 2)
        assert value.velocity == (0.0, 0.0)


def test_each_law_trims_what_it_says():
    def moved(name, **values):
        found = trims(turning(component(name, **values))).values()
        return [value.position[0] != 0.0 for value in found], [value.effort[1] != 0.0 for value in found]

    assert moved('wheel_slip') == ([True, True, False, False], [False] * 4)
    assert moved('yaw_moment') == ([False] * 4, [True] * 4)
    assert moved('rear_steering') == ([False, False, True, True], [False] * 4)
    assert moved('allocation') == ([True] * 4, [True] * 4)
    assert moved('allocation', allocation_traction=False) == ([True] * 4, [False] * 4)


def test_new_gains_hold_at_once():
    controller = component('wheel_slip')
    before = trims(turning(controller))['front_left/trim'].position[0]
    controller.configure(SideSlipParameters(proportional_gains=(1.0, 0.0, 0.0, 0.0)))
    assert trims(turning(controller, STEP))['front_left/trim'].position[0] == pytest.approx(0.2 * before)


def test_missing_wheels_and_joints_are_said():
    controller = component('allocation')
    kept = trims(turning(controller))
    controller.receive('tyres/side_slip', Joints(STEP, WHEELS[:3], (0.0,) * 3, (4.0,) * 3), STEP)
    controller.receive('joint_states', Joints(STEP, ('a',), (0.0,), (0.0,)), STEP)
    outputs = controller.step(STEP)
    assert [value.position for value in trims(outputs).values()] == [value.position for value in kept.values()]
    (said,) = [output.value for output in outputs if isinstance(output.value, Diagnostics)]
    assert said.statuses[0].level == 2
    assert 'joint_states lacks joints' in said.statuses[0].message
    assert 'not finite' in said.statuses[0].message
