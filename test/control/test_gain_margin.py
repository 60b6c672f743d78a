"""Margins of the loops, against the real controllers and actuators on a linear vehicle."""

import numpy as np
import pytest
from scipy.linalg import expm

from omni_vehicle_ros.control.actuator import DriveActuator, SteerActuator
from omni_vehicle_ros.control.controllers import make_controller
from omni_vehicle_ros.control.gain_margin import motion_loop
from omni_vehicle_ros.control.traction import traction_levers
from omni_vehicle_ros.control.trim import Sensed
from omni_vehicle_ros.model.kinematics import Twist
from omni_vehicle_ros.model.linear import linear_bicycle
from omni_vehicle_ros.parameters import SideSlipParameters, VehicleParameters, WheelModuleParameters

VEHICLE = VehicleParameters(front_roll_steer=0.0, rear_roll_steer=0.0)
MODULE = WheelModuleParameters(steer_rate_limit=100.0)
PERIOD = 0.005
FINE = 20  # pieces of a cycle in which the angles move on a straight line
NAMES = ('yaw_moment', 'rear_steering', 'allocation')
MARGINS = pytest.mark.parametrize('name', NAMES)


def margin(name, speed, module=MODULE, period=PERIOD, **values):
    return motion_loop(SideSlipParameters(controller=name, **values), VEHICLE, module, speed, period).margin()


def run(parameters, speed, module, period, duration, factor=1.0):
    """Yaw rates of the linear bicycle with real controllers and actuators, from a small disturbance on.

    ``factor`` multiplies what the controller trims, beside its gains in ``parameters``.
    """
    bicycle = linear_bicycle(VEHICLE, speed)
    inputs = np.hstack([bicycle.input_matrix, [[0.0], [1.0 / VEHICLE.yaw_inertia]]])
    joined = np.zeros((5, 5))
    joined[:2] = period / FINE * np.hstack([bicycle.state_matrix, inputs])
    step = expm(joined)[:2]
    law = make_controller(parameters, VEHICLE)
    steering = [SteerActuator(module) for _ in range(4)]
    drives = [DriveActuator(module) for _ in range(4)]
    motion, angles, yaw = np.array([0.0, 1e-6]), (0.0,) * 4, []
    for k in range(round(duration / period)):
        now = round(k * period * 1e9)
        twist = Twist(speed, motion[0], motion[1])
        trims = law.update(now, Sensed((0.0,) * 4, (speed,) * 4, angles, twist=twist, commanded=Twist(speed, 0.0, 0.0)))
        moves = [a.update(now, factor * trim, period) for a, trim in zip(steering, trims.steer_angle, strict=True)]
        torques = [drive.update(factor * t, period) for drive, t in zip(drives, trims.torque, strict=True)]
        moment = np.dot(torques, traction_levers((0.0,) * 4, VEHICLE)) / VEHICLE.wheel_radius
        for piece in range(FINE):
            share = period * (piece + 0.5) / FINE
            front, rear = (moves[i][0] + share * moves[i][1] for i in (0, 2))
            motion = step @ np.array([*motion, front, rear, moment])
        angles = tuple(angle + period * rate for angle, rate in moves)
        yaw.append(motion[1])
    return np.array(yaw)


def scaled(name, factor):
    """The gains times a factor, and what is left of the factor for a controller without gains."""
    p = SideSlipParameters(controller=name)
    if name == 'rear_steering':
        return p, factor
    prefix = 'yaw' if name == 'yaw_moment' else 'allocation'
    gains = {f'{prefix}{kind}': factor * getattr(p, f'{prefix}{kind}') for kind in ('_gain', '_integral_gain')}
    limits = {entry: value for entry, value in p.as_dict().items() if entry not in gains}
    return SideSlipParameters(**limits, **gains), 1.0


@MARGINS
@pytest.mark.parametrize('speed, delay', [(4.0, 0.005), (25.0, 0.01), (10.0, 0.0125)])
def test_the_loop_settles_below_the_margin_and_not_above(name, speed, delay):
    module, period = WheelModuleParameters(steer_rate_limit=100.0, steer_delay=delay), 0.01
    limit = margin(name, speed, module, period)
    for share in (0.85, 1.15):
        parameters, factor = scaled(name, share * limit)
        assert growth(run(parameters, speed, module, period, 3.0, factor)) == (share > 1.0)


def growth(yaw):
    """Whether a signal is larger in its last third than in the one before."""
    size, third = np.abs(yaw), len(yaw) // 3
    return size[-third:].max() > size[third : 2 * third].max()


@MARGINS
def test_defaults_are_below_a_third_of_the_limit_at_any_speed(name):
    margins = [margin(name, speed) for speed in np.geomspace(1.0, 30.0, 25)]
    assert min(margins) > 3.0


def test_the_margins_that_are_documented():
    assert margin('yaw_moment', 30.0) == pytest.approx(31.0, rel=0.02)
    assert margin('rear_steering', 1.0) == pytest.approx(5.7, rel=0.02)
    assert margin('rear_steering', 30.0) == pytest.approx(5.7, rel=0.02)
    assert margin('allocation', 30.0) == pytest.approx(9.6, rel=0.02)


@MARGINS
def test_more_delay_and_a_longer_period_leave_less(name):
    if name != 'yaw_moment':
        assert margin(name, 20.0, WheelModuleParameters(steer_delay=0.03)) < margin(name, 20.0)
    assert margin(name, 20.0, period=0.02) < margin(name, 20.0)


def test_the_derivative_part_counts():
    values = {'yaw_gain': 0.0, 'yaw_integral_gain': 0.0, 'yaw_derivative_gain': 1e3, 'derivative_time_constant': 0.02}
    limit = margin('yaw_moment', 10.0, **values)
    for share in (0.8, 1.2):
        gain = share * limit * values['yaw_derivative_gain']
        parameters = SideSlipParameters(controller='yaw_moment', **{**values, 'yaw_derivative_gain': gain})
        assert growth(run(parameters, 10.0, MODULE, PERIOD, 3.0)) == (share > 1.0)
