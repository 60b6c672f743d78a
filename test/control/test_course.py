"""The course of a commanded motion: straight on, turns, crab and reverse are all the same."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omni_vehicle_ros.control.course import course_of, wheel_motion
from omni_vehicle_ros.model.kinematics import Twist, wheel_velocities
from omni_vehicle_ros.parameters import VehicleParameters

VEHICLE = VehicleParameters()
speeds = st.floats(-20.0, 20.0)
moving = st.builds(Twist, speeds, speeds, st.floats(-3.0, 3.0)).filter(lambda twist: math.hypot(*twist[:2]) > 0.1)


def test_of_a_left_turn():
    course = course_of(Twist(4.0, 0.0, 0.8), Twist(3.0, -0.2, 0.5))
    assert course == pytest.approx((0.0, 0.2, 3.0, -0.2, 0.5))


def test_of_a_crab_and_of_reverse():
    crab = course_of(Twist(0.0, 2.0, 0.0), Twist(0.3, 1.0, 0.1))
    assert crab == pytest.approx((math.pi / 2, 0.0, 1.0, -0.3, 0.1))
    reverse = course_of(Twist(-2.0, 0.0, 0.4), Twist(-1.0, 0.1, 0.2))
    assert reverse == pytest.approx((math.pi, 0.2, 1.0, -0.1, 0.2))


@pytest.mark.parametrize('commanded', [Twist(0.0, 0.0, 0.0), Twist(0.0, 0.0, 1.0)])
def test_standstill_and_spin_in_place_are_none(commanded):
    assert course_of(commanded, Twist(1.0, 1.0, 1.0)) is None


@settings(deadline=None)
@given(moving)
def test_on_its_course_a_vehicle_has_the_commanded_speed_and_no_drift(twist):
    course = course_of(twist, twist)
    assert course.speed == pytest.approx(math.hypot(twist.vx, twist.vy))
    assert course.drift == pytest.approx(0.0, abs=1e-9)
    assert course.curvature * course.speed == pytest.approx(twist.r)


@settings(deadline=None)
@given(moving)
def test_wheels_move_as_on_a_rigid_body(twist):
    course = course_of(twist, twist)
    directions, ratios = wheel_motion(course.bearing, course.curvature, VEHICLE)
    for i, velocity in enumerate(wheel_velocities(twist, VEHICLE)):
        speed = ratios[i] * course.speed
        found = speed * math.cos(directions[i]), speed * math.sin(directions[i])
        assert found == pytest.approx(velocity, abs=1e-9)
