"""From force and moment to the slips of the axles, against sums over the tyres and closed forms."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omni_vehicle_ros.control.axles import (
    NO_SLIP,
    AxleSlips,
    Demand,
    Tyres,
    axle_slips,
    largest_force,
    level_slips,
    within,
)
from omni_vehicle_ros.control.course import Course, wheel_motion
from omni_vehicle_ros.control.grip import Grip
from omni_vehicle_ros.parameters import VehicleParameters

VEHICLE = VehicleParameters()
GRIP = Grip(VEHICLE, 0.9)
MASS, FRONT, REAR = VEHICLE.mass, VEHICLE.cg_to_front_axle, VEHICLE.cg_to_rear_axle
LIMIT = GRIP.slip_limit(5.0)
bearings = st.sampled_from([0.0, 0.5, math.pi / 2, math.pi, -2.0])
curvatures = st.floats(-0.25, 0.25)


def tyres_on(bearing=0.0, curvature=0.0, ay=0.0, speed=5.0, angles=None, vehicle=VEHICLE):
    course = Course(bearing, curvature, speed, 0.0, curvature * speed)
    directions, _ = wheel_motion(bearing, curvature, vehicle)
    return Tyres(course, angles or directions, Grip(vehicle, 0.9).capacities(ay), Grip(vehicle, 0.9), vehicle)


@settings(deadline=None, max_examples=60)
@given(bearings, curvatures, st.floats(-6.0, 6.0), st.floats(-0.8, 0.8), st.floats(-0.8, 0.8))
def test_slips_are_found_again_from_what_they_make(bearing, curvature, ay, lead, trail):
    tyres = tyres_on(bearing, curvature, ay)
    slips = AxleSlips(lead * LIMIT, trail * LIMIT)
    found = axle_slips(tyres.made(slips), tyres, LIMIT)
    assert found == pytest.approx(slips, abs=1e-7)
    assert axle_slips(tyres.made(slips), tyres, LIMIT, AxleSlips(-lead * LIMIT, 0.1)) == pytest.approx(found, abs=1e-7)


def test_the_axles_of_every_course():
    ahead = tyres_on()
    assert ahead.base == pytest.approx(FRONT + REAR)
    assert ahead.slips(AxleSlips(0.1, 0.2)) == pytest.approx((0.1, 0.1, 0.2, 0.2))
    assert ahead.means((0.1, 0.3, 0.5, 0.7)) == pytest.approx((0.2, 0.6))
    assert tyres_on(math.pi).slips(AxleSlips(0.1, 0.2)) == pytest.approx((0.2, 0.2, 0.1, 0.1))
    left = tyres_on(math.pi / 2)
    assert left.slips(AxleSlips(0.1, 0.2)) == pytest.approx((0.1, 0.2, 0.1, 0.2))
    assert left.base == pytest.approx(VEHICLE.front_track)


def test_small_slips_straight_on_are_those_of_the_bicycle():
    # m ay lr / l on the front axle, each tyre of stiffness C: slip m ay lr / (2 C l) (Abe 2009, ch. 3).
    force = MASS * 0.5
    slips = axle_slips(Demand(force, 0.0), tyres_on(), LIMIT)
    for slip, share in zip(slips, (REAR, FRONT), strict=True):
        assert slip == pytest.approx(force * share / (FRONT + REAR) / (2.0 * VEHICLE.cornering_stiffness), rel=1e-3)


@pytest.mark.parametrize('turned_round', [False, True])
def test_a_wheel_that_rolls_backward_makes_its_force_to_the_same_side(turned_round):
    directions, _ = wheel_motion(0.0, 0.2, VEHICLE)
    angles = tuple(angle - math.pi * turned_round for angle in directions)
    slips = AxleSlips(0.05, 0.03)
    assert tyres_on(0.0, 0.2, angles=angles).made(slips) == pytest.approx(tyres_on(0.0, 0.2).made(slips))


@settings(deadline=None, max_examples=40)
@given(curvatures, st.floats(-6.0, 6.0), st.floats(-3.0, 3.0), st.floats(-3.0, 3.0))
def test_left_and_right_are_mirror_images(curvature, ay, force, moment):
    demand = Demand(1e3 * force, 1e3 * moment)
    left = axle_slips(demand, tyres_on(0.0, curvature, ay), LIMIT)
    right = axle_slips(Demand(-demand.force, -demand.moment), tyres_on(0.0, -curvature, -ay), LIMIT)
    assert right == pytest.approx((-left.leading, -left.trailing), abs=1e-8)


@settings(deadline=None, max_examples=40)
@given(curvatures, st.floats(1.15e4, 1e5), st.floats(-1500.0, 1500.0), st.sampled_from([1.0, -1.0]))
def test_past_the_grip_limit_one_axle_is_at_its_limit_and_the_moment_is_kept(curvature, force, moment, side):
    tyres = tyres_on(0.0, curvature, side * 6.0)
    slips = axle_slips(Demand(side * force, moment), tyres, LIMIT)
    made = tyres.made(slips)
    assert max(map(abs, slips)) == pytest.approx(LIMIT)
    assert made.moment == pytest.approx(moment, abs=0.1)
    assert made.force == pytest.approx(largest_force(side, moment, tyres, LIMIT), rel=1e-6)
    assert abs(made.force) < force


def test_a_moment_beyond_all_grip_turns_both_axles_against_each_other():
    slips = axle_slips(Demand(0.0, 1e6), tyres_on(), LIMIT)
    assert slips == pytest.approx((LIMIT, -LIMIT))


def test_more_grip_less_slip_and_a_larger_largest_force():
    # A lateral acceleration takes load from the inner tyres, which give less than the outer ones gain.
    flat, leaning = tyres_on(ay=0.0), tyres_on(ay=6.0)
    assert largest_force(1.0, 0.0, flat, LIMIT) > largest_force(1.0, 0.0, leaning, LIMIT)
    demand = Demand(6000.0, 0.0)
    assert axle_slips(demand, flat, LIMIT).leading < axle_slips(demand, leaning, LIMIT).leading


@pytest.mark.parametrize('ay', [1.0, 2.0])
def test_level_slips_need_the_moment_of_the_closed_form(ay):
    # Linear tyres, wheels straight: all slips are the same if traction makes Mz = (lr - lf) / 2 m ay.
    tyres = tyres_on()
    slips = level_slips(MASS * ay, tyres, LIMIT)
    assert slips.leading == slips.trailing == pytest.approx(MASS * ay / (4.0 * VEHICLE.cornering_stiffness), rel=2e-3)
    assert tyres.made(slips).moment == pytest.approx(-0.5 * (REAR - FRONT) * MASS * ay, rel=2e-3)


small = st.floats(-0.4, 0.4)
SLIDING = 1.25 * LIMIT


def fits(slips, beside):
    return all(abs(s) <= LIMIT + 1e-12 and abs(s + b) <= SLIDING + 1e-12 for s, b in zip(slips, beside, strict=True))


@settings(deadline=None)
@given(small, small, small, small)
def test_slips_keep_to_their_limits_on_both_sides_alike(lead, trail, more, other):
    wanted, beside = AxleSlips(lead, trail), AxleSlips(more, other)
    got = within(wanted, beside, LIMIT, SLIDING)
    # No wheel slides farther than it may; only to turn back one that does, it may leave its limit on the path.
    assert all(abs(s + b) <= SLIDING + 1e-12 for s, b in zip(got, beside, strict=True))
    assert fits(got, beside) or max(map(abs, beside)) > LIMIT + SLIDING
    assert got == wanted or not fits(wanted, beside)
    mirrored = within(AxleSlips(-lead, -trail), AxleSlips(-more, -other), LIMIT, SLIDING)
    assert mirrored == pytest.approx((-got.leading, -got.trailing))


def test_the_sum_of_the_slips_gives_way_before_their_difference():
    assert within(AxleSlips(1.5 * LIMIT, LIMIT), NO_SLIP, LIMIT, SLIDING) == pytest.approx((LIMIT, 0.5 * LIMIT))
    assert within(AxleSlips(0.0, -1.2 * LIMIT), NO_SLIP, LIMIT, SLIDING) == pytest.approx((0.2 * LIMIT, -LIMIT))
    assert within(AxleSlips(3.0 * LIMIT, -LIMIT), NO_SLIP, LIMIT, SLIDING) == pytest.approx((LIMIT, -LIMIT))


def test_tyres_without_any_grip_do_not_trouble():
    course = Course(0.0, 0.2, 5.0, 0.0, 1.0)
    tyres = Tyres(course, (0.0,) * 4, (0.0,) * 4, GRIP, VEHICLE)
    assert axle_slips(Demand(1e3, 1e2), tyres, LIMIT) == (0.0, 0.0)
    assert level_slips(1e3, tyres, LIMIT) == (0.0, 0.0)
    assert largest_force(1.0, 0.0, tyres, LIMIT) == 0.0
