"""Drives that fail are made up for: the push stays, and no yaw moment comes up that nobody wants."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omni_vehicle_ros.control.commands import steer
from omni_vehicle_ros.control.fault_tolerance.forces import Failed, Wheels, made_up
from omni_vehicle_ros.control.motion import length_scale, motion_of_icr
from omni_vehicle_ros.control.traction import traction_levers
from omni_vehicle_ros.parameters import SteeringParameters, VehicleParameters

VEHICLE = VehicleParameters()
LIMIT = 3000.0
NONE = (0.0,) * 4

numbers = st.integers(0, 3)
forces = st.floats(-700.0, 700.0)
icrs = st.tuples(st.floats(-5.0, 5.0), st.floats(4.0, 50.0), st.sampled_from([-1.0, 1.0]))


def only(number):
    return tuple(i == number for i in range(4))


def wheels_of(x, y, side):
    motion = motion_of_icr(x, side * y, length_scale(VEHICLE), 1e5)
    able = steer(motion, NONE, VEHICLE, SteeringParameters())
    return Wheels(able.speeds, able.angles)


def resultant(forces, wheels):
    levers = traction_levers(wheels.steer_angles, VEHICLE)
    push = sum(f * s for f, s in zip(forces, wheels.unit_speeds, strict=True))
    return push, sum(f * lever for f, lever in zip(forces, levers, strict=True))


@settings(deadline=None)
@given(numbers, st.tuples(forces, forces, forces, forces), icrs, forces)
def test_push_and_yaw_moment_are_as_wanted(number, wanted, icr, stuck):
    wheels = wheels_of(*icr)
    given_forces = made_up(wanted, Failed(only(number), (stuck,) * 4), wheels, 1e6, VEHICLE)
    assert given_forces[number] == wanted[number]
    made = tuple(stuck if i == number else given_forces[i] for i in range(4))
    assert resultant(made, wheels) == pytest.approx(resultant(wanted, wheels), abs=1e-6)


def test_straight_on_the_dead_front_left_share_goes_to_the_left_and_back():
    """By hand: the left side makes as much as the right one, so that the rear left wheel makes the whole of it."""
    wheels = Wheels((1.0,) * 4, NONE)
    made = made_up((100.0,) * 4, Failed(only(0), NONE), wheels, LIMIT, VEHICLE)
    assert made[2] == pytest.approx(200.0)
    assert made[1] + made[3] == pytest.approx(200.0)
    assert made[1] == pytest.approx(100.0) and made[3] == pytest.approx(100.0)


@settings(deadline=None)
@given(numbers, icrs, st.floats(500.0, 3000.0), st.sampled_from([-1.0, 1.0]))
def test_at_the_limit_there_is_less_push_but_no_yaw_moment(number, icr, size, way):
    """Equal forces of a straight vehicle make no moment; with one dead they can't all be made up for."""
    wheels = Wheels((1.0,) * 4, NONE)
    made = made_up((way * size,) * 4, Failed(only(number), NONE), wheels, 2000.0, VEHICLE)
    made = tuple(0.0 if i == number else made[i] for i in range(4))
    push, moment = resultant(made, wheels)
    assert moment == pytest.approx(0.0, abs=1e-6)
    assert abs(push) == pytest.approx(min(4.0 * size, 4000.0))
    assert max(map(abs, made)) <= 2000.0


@settings(deadline=None)
@given(st.tuples(forces, forces, forces, forces), icrs, forces)
def test_left_and_right_are_mirror_images(wanted, icr, stuck):
    swap = (1, 0, 3, 2)
    left = made_up(wanted, Failed(only(0), (stuck,) * 4), wheels_of(*icr), LIMIT, VEHICLE)
    mirrored = tuple(wanted[i] for i in swap)
    right = made_up(mirrored, Failed(only(1), (stuck,) * 4), wheels_of(icr[0], icr[1], -icr[2]), LIMIT, VEHICLE)
    assert right == pytest.approx(tuple(left[i] for i in swap), abs=1e-6)


def test_spinning_in_place_its_push_is_its_moment():
    angles = tuple(math.atan2(x, -y) for x, y in zip(VEHICLE.wheel_x, VEHICLE.wheel_y, strict=True))
    arms = tuple(math.hypot(x, y) for x, y in zip(VEHICLE.wheel_x, VEHICLE.wheel_y, strict=True))
    wheels = Wheels(arms, angles)
    made = made_up((300.0,) * 4, Failed(only(3), NONE), wheels, LIMIT, VEHICLE)
    sound = tuple(0.0 if i == 3 else made[i] for i in range(4))
    assert resultant(sound, wheels)[1] == pytest.approx(300.0 * sum(arms))


def test_without_any_drive_nothing_is_made_up():
    assert made_up((100.0,) * 4, Failed((True,) * 4, NONE), Wheels((1.0,) * 4, NONE), LIMIT, VEHICLE) == (100.0,) * 4


