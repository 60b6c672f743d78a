"""Commands at the door: what is refused names value, limit and remedy."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omni_vehicle_ros.control.commands import check_cmd_vel, check_icr, check_speed, check_traction, steer
from omni_vehicle_ros.errors import CommandError
from omni_vehicle_ros.messages import Point, Twist, Wrench
from omni_vehicle_ros.parameters import SteeringParameters, VehicleParameters

VEHICLE = VehicleParameters()
OMNI, ROAD = SteeringParameters(), SteeringParameters(steering_rule='road')
NARROW = SteeringParameters(steer_limit=0.6)
NO_NUMBERS = [math.nan, math.inf, -math.inf]


@pytest.mark.parametrize('bad', NO_NUMBERS)
def test_what_is_not_finite_is_refused(bad):
    for call in (
        lambda: check_icr(Point(0, bad, 5.0), VEHICLE, OMNI),
        lambda: check_icr(Point(0, 0.0, bad), VEHICLE, OMNI),
        lambda: check_speed(Twist(0, bad), OMNI),
        lambda: check_traction(Wrench(0, bad), VEHICLE, OMNI),
        lambda: check_traction(Wrench(0, 1.0, tz=bad), VEHICLE, OMNI),
        lambda: check_cmd_vel(Twist(0, 1.0, bad), VEHICLE, OMNI),
        lambda: check_cmd_vel(Twist(0, 1.0, 0.0, bad), VEHICLE, OMNI),
    ):
        with pytest.raises(CommandError, match=rf'{bad} must be a finite number'):
            call()


@pytest.mark.parametrize('frame', ['odom', 'map', '/base_link', 'front_left'])
def test_another_frame_is_refused(frame):
    for call in (
        lambda: check_icr(Point(0, 0.0, 5.0, frame=frame), VEHICLE, OMNI),
        lambda: check_speed(Twist(0, 1.0, frame=frame), OMNI),
        lambda: check_traction(Wrench(0, 1.0, frame=frame), VEHICLE, OMNI),
        lambda: check_cmd_vel(Twist(0, 1.0, frame=frame), VEHICLE, OMNI),
    ):
        with pytest.raises(CommandError, match=f"frame '{frame}' is not base_link"):
            call()


def test_empty_frame_is_base_link():
    assert check_speed(Twist(0, 2.0, frame=''), OMNI) == (2.0, '')


def test_what_is_not_used_may_be_anything():
    assert check_speed(Twist(0, 2.0, math.nan, math.inf), OMNI) == (2.0, '')
    assert check_icr(Point(0, 0.0, 5.0, math.nan), VEHICLE, OMNI)
    assert check_traction(Wrench(0, 10.0, math.nan), VEHICLE, OMNI).force == 10.0


@pytest.mark.parametrize('speed', [31.0, -31.0, 1e300])
def test_too_fast_is_clamped_and_said(speed):
    clamped, warning = check_speed(Twist(0, speed), OMNI)
    assert clamped == math.copysign(30.0, speed)
    assert f'{speed:g} m/s' in warning
    assert 'maximum_speed, 30 m/s' in warning


@settings(deadline=None)
@given(st.floats(-200.0, 200.0), st.floats(-200.0, 200.0), st.floats(-20.0, 20.0))
def test_too_fast_a_twist_keeps_its_icr(vx, vy, yaw_rate):
    motion, magnitude, warning = check_cmd_vel(Twist(0, vx, vy, yaw_rate), VEHICLE, OMNI)
    if motion is None:
        return
    speed = abs(magnitude) * math.hypot(motion.ux, motion.uy)
    assert speed == pytest.approx(min(math.hypot(vx, vy), 30.0), abs=1e-9)
    assert bool(warning) == (math.hypot(vx, vy) > 30.0)
    # The ICR, (-vy, vx) / r, written without the division.
    assert motion.ux * vy == pytest.approx(motion.uy * vx, abs=1e-9)
    assert motion.ux * yaw_rate * 1.227 == pytest.approx(motion.ur * vx, abs=1e-9)


def test_traction_beyond_the_wheels_is_clamped_and_said():
    force, moment, warning = check_traction(Wrench(0, -1e6, tz=1e6), VEHICLE, OMNI)
    assert force == -12000.0
    assert moment == pytest.approx(3000.0 * 2.872)
    assert '12000 N' in warning
    assert 'N m' in warning


@settings(deadline=None)
@given(st.floats(-20.0, 20.0), st.floats(-0.717, 0.717))
def test_road_rule_refuses_an_icr_within_the_track_and_names_the_limit(x, y):
    # Nearest turn centre of the thesis: (0, +-T / 2), sec. 2.4.
    if math.hypot(x, y) < 0.01:
        return
    with pytest.raises(CommandError, match=r'0\.718 m'):
        check_icr(Point(0, x, y), VEHICLE, ROAD)


@settings(deadline=None)
@given(st.floats(-20.0, 20.0), st.floats(0.719, 50.0), st.sampled_from([1.0, -1.0]))
def test_road_rule_allows_every_other(x, y, side):
    motion = check_icr(Point(0, x, side * y), VEHICLE, ROAD)
    found = steer(motion, (0.0,) * 4, VEHICLE, ROAD)
    assert all(abs(angle) <= math.pi / 2 for angle in found.angles)
    assert all(speed > 0.0 for speed in found.speeds)


def test_road_rule_sends_a_spin_in_place_away():
    with pytest.raises(CommandError, match='omni'):
        check_cmd_vel(Twist(0, 0.0, 0.0, 1.0), VEHICLE, ROAD)


@settings(deadline=None)
@given(st.floats(-1e7, 1e7), st.floats(-1e7, 1e7))
def test_omni_rule_reaches_any_icr(x, y):
    if math.hypot(x, y) >= 0.01:
        assert check_icr(Point(0, x, y), VEHICLE, OMNI)


def test_icr_out_of_reach_of_a_limited_wheel_is_refused_naming_wheel_and_limit():
    with pytest.raises(CommandError, match=r'front_left .* 0\.\d+ rad, beyond steer_limit, 0\.6 rad'):
        check_icr(Point(0, 0.0, 1.8), VEHICLE, NARROW)
    # Of all wheels the rear left one turns most, by atan(lr / (R - T / 2)).
    nearest = 1.454 / math.tan(0.6) + 0.718
    assert check_icr(Point(0, 0.0, nearest + 1e-6), VEHICLE, NARROW)
    with pytest.raises(CommandError, match='rear_left'):
        check_icr(Point(0, 0.0, nearest - 1e-3), VEHICLE, NARROW)


def test_crab_steeper_than_the_limit_is_refused():
    assert check_cmd_vel(Twist(0, 1.0, math.tan(0.59)), VEHICLE, NARROW).motion
    with pytest.raises(CommandError, match='steer_limit'):
        check_cmd_vel(Twist(0, 1.0, math.tan(0.61)), VEHICLE, NARROW)


def test_hardly_any_twist_is_none():
    assert check_cmd_vel(Twist(0, 1e-9, 0.0, 1e-6), VEHICLE, OMNI).motion is None


@settings(deadline=None)
@given(*[st.floats(allow_nan=False, allow_infinity=False)] * 3)
def test_any_finite_twist_is_followed_or_refused(vx, vy, yaw_rate):
    motion, magnitude, _ = check_cmd_vel(Twist(0, vx, vy, yaw_rate), VEHICLE, OMNI)
    assert not math.isnan(magnitude)
    assert motion is None or all(map(math.isfinite, motion))
