"""The nearest ICR on the axle line of a wheel that does not steer: closed forms, geometry of the wheels, symmetry."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from omni_vehicle_ros.control.commands import steer
from omni_vehicle_ros.control.fault_tolerance.axle_line import FARTHEST, HeldWheel, nearest_motion
from omni_vehicle_ros.control.motion import (
    STRAIGHT,
    Motion,
    angle_between,
    length_scale,
    motion_of_icr,
    twist_of_motion,
    unit_motion,
)
from omni_vehicle_ros.model.kinematics import wheel_velocities
from omni_vehicle_ros.parameters import SteeringParameters, VehicleParameters

VEHICLE = VehicleParameters()
LENGTH = length_scale(VEHICLE)
X, Y = VEHICLE.wheel_x, VEHICLE.wheel_y

wheels = st.integers(0, 3)
angles = st.floats(-1.5, 1.5)
shares = st.floats(-1.0, 1.0)


def everything(motion):
    return True


def held(wheel, angle):
    return HeldWheel(X[wheel], Y[wheel], angle)


def icr_of(motion):
    return np.array([-motion.uy, motion.ux]) * LENGTH / motion.ur


def foot(icr, wheel):
    """Return the foot of the perpendicular from a point to an axle line, by vectors."""
    place, along = np.array([wheel.x, wheel.y]), np.array([-math.sin(wheel.angle), math.cos(wheel.angle)])
    return place + along * ((np.array(icr) - place) @ along)


@settings(deadline=None)
@given(wheels, angles, st.floats(-30.0, 30.0), st.floats(2.0, 60.0), st.sampled_from([-1.0, 1.0]))
def test_the_icr_is_the_foot_of_the_perpendicular(number, angle, x, y, side):
    wheel, target = held(number, angle), motion_of_icr(x, side * y, LENGTH, 1e5)
    motion = nearest_motion(target, [wheel], everything, VEHICLE)
    expected = foot((x, side * y), wheel)
    if motion is None:
        there = unit_motion(expected[1] * side, -expected[0] * side, side * LENGTH)
        assert angle_between(there, target) > FARTHEST - 1e-9
    else:
        assert icr_of(motion) == pytest.approx(expected, rel=1e-9, abs=1e-9)


@settings(deadline=None)
@given(wheels, st.floats(-1.0, 1.0))
def test_straight_on_becomes_a_crab_along_the_wheel(number, angle):
    motion = nearest_motion(STRAIGHT, [held(number, angle)], everything, VEHICLE)
    assert motion == pytest.approx((math.cos(angle), math.sin(angle), 0.0), abs=1e-12)


@pytest.mark.parametrize('number', range(4))
def test_a_wheel_stuck_across_lets_nobody_drive_straight_on(number):
    assert nearest_motion(STRAIGHT, [held(number, 0.5 * math.pi)], everything, VEHICLE) is None


def test_a_spin_in_place_turns_about_the_nearest_point_of_the_line():
    motion = nearest_motion(Motion(0.0, 0.0, 1.0), [held(0, 0.0)], everything, VEHICLE)
    assert icr_of(motion) == pytest.approx((VEHICLE.cg_to_front_axle, 0.0))


@settings(deadline=None)
@given(wheels, angles, st.tuples(shares, shares, shares))
def test_all_wheels_stand_across_their_rays_to_the_icr(number, angle, vector):
    assume(math.hypot(*vector) > 0.1)
    wheel = held(number, angle)
    motion = nearest_motion(unit_motion(*vector), [wheel], everything, VEHICLE)
    assume(motion is not None)
    able = steer(motion, (0.0,) * 4, VEHICLE, SteeringParameters(steer_limit=1.75))
    velocities = wheel_velocities(twist_of_motion(motion, 1.0, LENGTH), VEHICLE)
    for i, (ahead, left) in enumerate(velocities):
        at = angle if i == number else able.angles[i]
        if i == number or able.speeds[i]:
            assert abs(left * math.cos(at) - ahead * math.sin(at)) < 1e-9


@settings(deadline=None)
@given(wheels, angles, st.tuples(shares, shares, shares))
def test_no_other_motion_of_the_line_keeps_the_yaw_rate_and_changes_the_velocity_less(number, angle, vector):
    assume(math.hypot(*vector) > 0.1)
    target, wheel = unit_motion(*vector), held(number, angle)
    motion = nearest_motion(target, [wheel], everything, VEHICLE)
    assume(motion is not None)
    scale = target.ur / motion.ur if abs(target.ur) > 1e-3 else None
    assume(scale is not None)
    change = np.array([scale * motion.ux - target.ux, scale * motion.uy - target.uy])
    along = np.array([math.cos(angle), math.sin(angle)])  # motions of the line with this yaw rate differ by this
    assert abs(change @ along) < 1e-9 * max(1.0, abs(scale))


@settings(deadline=None)
@given(st.floats(-1.2, 1.2), st.floats(-20.0, 20.0), st.floats(2.0, 40.0))
def test_left_and_right_are_mirror_images(angle, x, y):
    left = nearest_motion(motion_of_icr(x, y, LENGTH, 1e5), [held(0, angle)], everything, VEHICLE)
    right = nearest_motion(motion_of_icr(x, -y, LENGTH, 1e5), [held(1, -angle)], everything, VEHICLE)
    if left is None:
        assert right is None
    else:
        assert right == pytest.approx((left.ux, -left.uy, -left.ur), abs=1e-12)


def two_that_meet_at(icr):
    return [held(i, math.atan2(X[i] - icr[0], icr[1] - Y[i])) for i in (0, 3)]


def test_two_stuck_wheels_leave_the_point_where_their_lines_meet():
    target = motion_of_icr(0.0, 8.0, LENGTH, 1e5)
    icr = np.array([0.2, 7.8])
    two = two_that_meet_at(icr)
    motion = nearest_motion(target, two, everything, VEHICLE)
    assert icr_of(motion) == pytest.approx(icr, abs=1e-9)
    behind = Motion(-target.ux, -target.uy, -target.ur)
    assert icr_of(nearest_motion(behind, two, everything, VEHICLE)) == pytest.approx(icr, abs=1e-9)


@pytest.mark.parametrize('way', [-1.0, 1.0])
@pytest.mark.parametrize('radius', [4.0, 15.0, 22.0, 30.0, 60.0, 200.0])
def test_a_motion_that_cannot_be_steered_is_made_only_if_it_leads_where_the_driver_wants(radius, way):
    """Straight on is wanted. An arc is off by s^2 / 2 R after the 4 m of a stop from 4 m/s at 2 m/s2."""
    forced = nearest_motion(Motion(way, 0.0, 0.0), two_that_meet_at((0.0, radius)), everything, VEHICLE)
    if forced is not None:
        assert 4.0**2 / (2.0 * radius) < 1.0 / 3.0
    else:
        assert 4.0**2 / (2.0 * radius) > 0.2


def test_two_wheels_whose_lines_are_one_leave_the_whole_line():
    target = motion_of_icr(0.0, 8.0, LENGTH, 1e5)
    motion = nearest_motion(target, [held(2, 0.0), held(3, 0.0)], everything, VEHICLE)
    assert icr_of(motion) == pytest.approx((-VEHICLE.cg_to_rear_axle, 8.0))


def test_two_wheels_whose_lines_meet_far_from_the_command_leave_nothing():
    assert nearest_motion(STRAIGHT, [held(0, 0.6), held(1, -0.6)], everything, VEHICLE) is None


def test_three_stuck_wheels_leave_nothing():
    three = [held(0, 0.1), held(1, -0.3), held(2, 0.2)]
    assert nearest_motion(STRAIGHT, three, everything, VEHICLE) is None


@pytest.mark.parametrize('limit', [0.3, 0.5])
@pytest.mark.parametrize('side', [-1.0, 1.0])
def test_within_the_steer_limits_of_the_other_wheels(limit, side):
    """A rear wheel stuck inward: the foot of the perpendicular asks too much of the others."""
    steering = SteeringParameters(steer_limit=limit, steering_rule='road')
    target, number = motion_of_icr(0.0, side * 4.3, LENGTH, 1e5), 2 if side > 0.0 else 3

    def reachable(motion):
        able = steer(motion, (0.0,) * 4, VEHICLE, steering).reachable
        return all(can or i == number for i, can in enumerate(able))

    wheel = held(number, side * 0.12)
    free = nearest_motion(target, [wheel], everything, VEHICLE)
    motion = nearest_motion(target, [wheel], reachable, VEHICLE)
    assert reachable(motion)
    if reachable(free):
        assert motion == free
    else:
        able = steer(motion, (0.0,) * 4, VEHICLE, steering)
        assert max(abs(able.angles[i]) for i in range(4) if i != number) == pytest.approx(limit, abs=1e-6)
