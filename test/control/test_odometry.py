"""Odometry of the wheels: motions are found again from what rolling and sliding wheels measure of them."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omni_vehicle_ros.control.motion import STRAIGHT, Motion, length_scale, motion_of_icr, twist_of_motion
from omni_vehicle_ros.control.odometry import magnitude_along, measured_twist, rolling_twist, sideways_speed
from omni_vehicle_ros.model.kinematics import Twist, wheel_velocities
from omni_vehicle_ros.parameters import VehicleParameters
from omni_vehicle_ros.wheels import per_wheel

VEHICLE = VehicleParameters()
LENGTH = length_scale(VEHICLE)
SPIN, CRAB = Motion(0.0, 0.0, 1.0), Motion(0.0, 1.0, 0.0)
places = st.floats(-20.0, 20.0)


def rolling(twist, angles):
    """Return what each wheel measures: the part of its velocity along its heading."""
    velocities = wheel_velocities(twist, VEHICLE)
    return per_wheel(lambda i: velocities[i][0] * math.cos(angles[i]) + velocities[i][1] * math.sin(angles[i]))


def headings(twist):
    return per_wheel(lambda i: math.atan2(*reversed(wheel_velocities(twist, VEHICLE)[i])))


@settings(deadline=None)
@given(places, places, st.floats(-20.0, 20.0))
def test_rolling_wheels_tell_the_commanded_motion(x, y, magnitude):
    if math.hypot(x, y) < 0.02:
        return
    motion = motion_of_icr(x, y, LENGTH, 1e5)
    twist = twist_of_motion(motion, magnitude, LENGTH)
    angles = headings(twist_of_motion(motion, 1.0, LENGTH))
    measured = measured_twist(rolling(twist, angles), angles, motion, VEHICLE)
    assert measured == pytest.approx(twist, abs=1e-4 * (1.0 + abs(magnitude)))
    assert magnitude_along(measured, motion, VEHICLE) == pytest.approx(magnitude, abs=1e-4 * (1.0 + abs(magnitude)))
    across, along = sideways_speed(measured, angles, VEHICLE)
    assert across < 1e-4 * (1.0 + along)


@pytest.mark.parametrize('motion', [STRAIGHT, SPIN, CRAB])
def test_straight_spin_and_crab(motion):
    twist = twist_of_motion(motion, 3.0, LENGTH)
    angles = headings(twist)
    measured = measured_twist(rolling(twist, angles), angles, motion, VEHICLE)
    assert measured == pytest.approx(twist, abs=1e-4)
    assert magnitude_along(measured, motion, VEHICLE) == pytest.approx(3.0, abs=1e-4)


@pytest.mark.parametrize('drift', [0.03, -0.1, 0.25])
@pytest.mark.parametrize('radius', [2.0, -3.0, 5.0])
def test_a_speed_is_measured_through_side_slip(radius, drift):
    # The mean of the wheels along their headings reads low by the cosine of the slip; this one does not.
    motion, speed = motion_of_icr(0.0, radius, LENGTH, 1e5), 4.0
    angles = headings(twist_of_motion(motion, 1.0, LENGTH))
    twist = Twist(speed * math.cos(drift), speed * math.sin(drift), 0.9 * speed / radius)
    measured = measured_twist(rolling(twist, angles), angles, motion, VEHICLE)
    assert measured.vx == pytest.approx(twist.vx, rel=0.015)
    assert measured.r == pytest.approx(twist.r, rel=0.03)
    # What the command says beforehand weighs more, the less the wheels are turned.
    assert 0.6 < measured.vy / twist.vy < 1.1


def test_parallel_wheels_see_a_spin_but_not_what_lies_across_them():
    twist = Twist(2.0, 1.0, 1.5)
    measured = measured_twist(rolling(twist, (0.0,) * 4), (0.0,) * 4, STRAIGHT, VEHICLE)
    # Four arms of half a track measure the yaw rate, against the weight of the command, which has none.
    seen = 4.0 * (0.718 / LENGTH) ** 2
    rate = 1.5 * seen / (seen + 0.05)
    assert measured == pytest.approx((2.0, 0.0, rate), rel=1e-5, abs=1e-9)
    across, along = sideways_speed(measured, (0.0,) * 4, VEHICLE)
    assert across == pytest.approx(rate * LENGTH)
    assert along == pytest.approx(2.0)


@settings(deadline=None)
@given(
    st.tuples(*[st.floats(-50.0, 50.0)] * 4), st.tuples(*[st.floats(-1.7, 1.7)] * 4), st.floats(-20.0, 20.0), places
)
def test_no_angles_are_singular(speeds, angles, x, y):
    motion = motion_of_icr(x, math.copysign(abs(y) + 0.02, y), LENGTH, 1e5)
    twist = measured_twist(speeds, angles, motion, VEHICLE)
    assert all(map(math.isfinite, twist))
    mirrored = measured_twist(
        (speeds[1], speeds[0], speeds[3], speeds[2]),
        (-angles[1], -angles[0], -angles[3], -angles[2]),
        Motion(motion.ux, -motion.uy, -motion.ur),
        VEHICLE,
    )
    size = 1e-6 * (1.0 + max(map(abs, twist)))
    assert mirrored == pytest.approx((twist.vx, -twist.vy, -twist.r), abs=size)


weights = st.sampled_from([(1.0, 1.0, 1.0, 1.0), (0.0, 1.0, 1.0, 1.0), (1.0, 0.0, 1.0, 0.0), (0.0, 1.0, 0.0, 1.0)])
steers = st.tuples(*[st.floats(-0.5, 0.5)] * 4)


@settings(deadline=None)
@given(st.floats(-8.0, 8.0), st.floats(-8.0, 8.0), st.floats(-2.0, 2.0), weights)
def test_wheels_that_roll_where_they_point_tell_the_motion_without_knowing_what_was_commanded(vx, vy, r, weights):
    twist = Twist(vx, vy, r)
    angles = headings(twist)
    assert rolling_twist(rolling(twist, angles), angles, VEHICLE, weights) == pytest.approx(twist, abs=1e-9)


@settings(deadline=None)
@given(steers, st.tuples(*[st.floats(-8.0, 8.0)] * 4), weights)
def test_wheels_that_slip_tell_the_motion_of_least_squares_along_and_across(angles, speeds, weights):
    rows, told = [], []
    for x, y, angle, speed, weight in zip(VEHICLE.wheel_x, VEHICLE.wheel_y, angles, speeds, weights, strict=True):
        cos, sin = math.cos(angle), math.sin(angle)
        rows += [(weight * cos, weight * sin, weight * (x * sin - y * cos))]
        rows += [(-weight * sin, weight * cos, weight * (x * cos + y * sin))]
        told += [weight * speed, 0.0]
    expected = np.linalg.lstsq(np.array(rows), np.array(told), rcond=None)[0]
    assert rolling_twist(speeds, angles, VEHICLE, weights) == pytest.approx(expected, abs=1e-9)
