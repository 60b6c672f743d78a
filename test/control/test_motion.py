"""Directions of motion: closed forms of ICR and twist, and turning on the sphere."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omni_vehicle_ros.control import motion as m
from omni_vehicle_ros.errors import CommandError

LENGTH = 1.227
FAR = 1e5
coordinates = st.floats(-50.0, 50.0)
angles = st.floats(-math.pi, math.pi)


def directions():
    def direction(azimuth, height):
        flat = math.sqrt(1.0 - height * height)
        return m.Motion(flat * math.cos(azimuth), flat * math.sin(azimuth), height)

    return st.builds(direction, angles, st.floats(-1.0, 1.0))


def angle_between(a, b):
    cross = (a.uy * b.ur - a.ur * b.uy, a.ur * b.ux - a.ux * b.ur, a.ux * b.uy - a.uy * b.ux)
    return math.atan2(math.hypot(*cross), sum(x * y for x, y in zip(a, b, strict=True)))


@settings(deadline=None)
@given(coordinates, coordinates, st.floats(-20.0, 20.0))
def test_the_icr_of_the_twist_is_the_commanded_one(x, y, speed):
    if math.hypot(x, y) < 0.02:
        return
    motion = m.motion_of_icr(x, y, LENGTH, FAR)
    twist = m.twist_of_motion(motion, m.magnitude_of_speed(motion, speed), LENGTH)
    assert math.hypot(twist.vx, twist.vy) == pytest.approx(abs(speed))
    assert twist.vx * speed >= 0.0
    # The velocity at the ICR is zero: v + r x (x, y) = 0.
    assert twist.vx - twist.r * y == pytest.approx(0.0, abs=1e-9)
    assert twist.vy + twist.r * x == pytest.approx(0.0, abs=1e-9)


def test_far_icr_across_is_straight_on_to_either_side():
    for y in (1e6, -1e6):
        assert m.motion_of_icr(0.0, y, LENGTH, FAR) == pytest.approx(m.STRAIGHT)


def test_far_icr_elsewhere_is_crab_across_its_bearing():
    # An ICR far behind and to the left: the vehicle moves at right angles to it, ahead and to the left.
    assert m.motion_of_icr(-1e6, 1e6, LENGTH, FAR) == pytest.approx((math.sqrt(0.5), math.sqrt(0.5), 0.0))
    assert m.motion_of_icr(-1e6, -1e6, LENGTH, FAR) == pytest.approx((math.sqrt(0.5), -math.sqrt(0.5), 0.0))


def test_just_inside_and_outside_the_straight_radius_agree():
    near, far = (m.motion_of_icr(0.3 * r, 0.95 * r, LENGTH, 1e5) for r in (1.0e5, 1.1e5))
    assert angle_between(near, far) < 2e-5


def test_icr_at_the_centre_of_gravity_sends_to_cmd_vel():
    with pytest.raises(CommandError, match='cmd_vel'):
        m.motion_of_icr(0.0, 0.0, LENGTH, FAR)


@pytest.mark.parametrize('twist, motion, magnitude', [
    ((3.0, 0.0, 0.0), (1.0, 0.0, 0.0), 3.0),
    ((-3.0, 0.0, 0.0), (1.0, 0.0, 0.0), -3.0),
    ((0.0, 2.0, 0.0), (0.0, 1.0, 0.0), 2.0),
    ((0.0, -2.0, 0.0), (0.0, 1.0, 0.0), -2.0),
    ((0.0, 0.0, 1.0), (0.0, 0.0, 1.0), LENGTH),
    ((0.0, 0.0, -1.0), (0.0, 0.0, 1.0), -LENGTH),
])
def test_reversing_changes_the_sign_and_not_the_direction(twist, motion, magnitude):
    found = m.motion_of_twist(*twist, LENGTH)
    assert found is not None
    assert found[0] == pytest.approx(motion)
    assert found[1] == pytest.approx(magnitude)


@settings(deadline=None)
@given(*[st.floats(allow_nan=False, allow_infinity=False)] * 3)
def test_any_finite_twist_has_a_unit_direction(vx, vy, yaw_rate):
    found = m.motion_of_twist(vx, vy, yaw_rate, LENGTH)
    if found is None:
        assert vx == vy == yaw_rate * LENGTH == 0.0
    else:
        assert math.sqrt(sum(u * u for u in found[0])) == pytest.approx(1.0)
        assert not math.isnan(found[1])
        if max(map(abs, (vx, vy, yaw_rate))) < 1e150:
            twist = m.twist_of_motion(*found, LENGTH)
            assert twist == pytest.approx((vx, vy, yaw_rate), rel=1e-9, abs=1e-9 * abs(found[1]))


@settings(deadline=None)
@given(directions(), directions(), st.floats(1e-3, 3.2))
def test_turning_goes_along_the_great_circle_at_the_limit(start, target, step):
    before, after = angle_between(start, target), m.turn_towards(start, target, step)
    assert math.sqrt(sum(u * u for u in after)) == pytest.approx(1.0)
    # Close to opposite the plane of the great circle is lost in rounding; the step is right all the same.
    assert angle_between(start, after) == pytest.approx(min(step, before), abs=1e-6)
    if before < 3.1:
        assert angle_between(after, target) == pytest.approx(before - min(step, before), abs=1e-6)


@settings(deadline=None)
@given(directions(), st.floats(0.01, 1.0))
def test_even_the_opposite_direction_is_reached(start, step):
    target, now = m.opposite(start), start
    for _ in range(math.ceil(math.pi / step) + 1):
        now = m.turn_towards(now, target, step)
    assert now == pytest.approx(target, abs=1e-6)


@settings(deadline=None)
@given(directions(), directions())
def test_the_choice_to_drive_backwards_is_kept_on_the_way(start, target):
    sense, now = m.nearest(target, start), start
    aim = target if sense > 0.0 else m.opposite(target)
    for _ in range(400):
        now = m.turn_towards(now, aim, 0.01)
        assert m.nearest(target, now) == sense
    assert now == aim


@settings(deadline=None)
@given(directions(), directions(), st.floats(0.01, 10.0))
def test_on_the_way_to_a_turn_the_centre_of_gravity_has_its_speed(motion, target, magnitude):
    on_the_way = m.magnitude_on_the_way(magnitude, motion, target)
    there, here = math.hypot(target.ux, target.uy), math.hypot(motion.ux, motion.uy)
    assert 0.0 < on_the_way <= 1.25 * magnitude + 1e-9
    assert on_the_way * here <= magnitude * max(there, 0.3) + 1e-9
    if here >= 0.8 * there >= 0.3:
        assert on_the_way * here == pytest.approx(magnitude * there)
    assert m.magnitude_on_the_way(magnitude, target, target) == pytest.approx(magnitude)
