import math

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from omni_vehicle_ros.errors import CommandError
from omni_vehicle_ros.model.kinematics import (
    Icr,
    Twist,
    road_steer_angles,
    steer_angles,
    twist_of_icr,
    wheel_velocities,
)
from omni_vehicle_ros.parameters import VehicleParameters

VEHICLE = VehicleParameters()
AHEAD = (0.0, 0.0, 0.0, 0.0)
quiet = settings(deadline=None, max_examples=100, derandomize=True)
lengths = st.floats(-50.0, 50.0)
speeds = st.floats(-20.0, 20.0)


@quiet
@given(lengths, lengths, st.floats(0.1, 20.0))
def test_the_twist_of_an_icr_turns_about_it(x, y, speed):
    assume(math.hypot(x, y) > 0.01)
    twist = twist_of_icr(Icr(x, y), speed)
    assert math.hypot(twist.vx, twist.vy) == pytest.approx(speed)
    assert twist.vx >= 0.0
    assert (-twist.vy / twist.r, twist.vx / twist.r) == pytest.approx((x, y), abs=1e-9)


def test_left_icr_turns_left_and_speed_reverses_the_motion():
    assert twist_of_icr(Icr(0.0, 4.0), 2.0) == pytest.approx((2.0, 0.0, 0.5))
    assert twist_of_icr(Icr(0.0, -4.0), 2.0) == pytest.approx((2.0, 0.0, -0.5))
    assert twist_of_icr(Icr(0.0, 4.0), -2.0) == pytest.approx((-2.0, 0.0, -0.5))


def test_icr_far_away_is_straight_on_or_crab_across_its_bearing():
    assert twist_of_icr(Icr(0.0, 2e5), 3.0, 1e5) == pytest.approx((3.0, 0.0, 0.0))
    assert twist_of_icr(Icr(-2e5, 2e5), 3.0, 1e5) == pytest.approx((math.sqrt(4.5), math.sqrt(4.5), 0.0))


def test_turning_into_a_straight_line_is_smooth():
    angles = [steer_angles(twist_of_icr(Icr(0.0, r), 1.0), AHEAD, 1.75, VEHICLE).angles for r in (1e6, -1e6)]
    assert angles[0] == pytest.approx(angles[1], abs=1e-5)


@pytest.mark.parametrize('icr', [Icr(math.nan, 1.0), Icr(0.0, math.inf), Icr(0.0, 0.0)])
def test_icr_without_a_motion_is_an_error_that_names_it(icr):
    with pytest.raises(CommandError, match='icr: '):
        twist_of_icr(icr, 1.0)


@quiet
@given(lengths, st.floats(0.72, 50.0), st.sampled_from([-1.0, 1.0]))
def test_road_rule_points_every_axle_at_the_icr(x, y, side):
    icr = Icr(x, side * y)
    xs, ys = VEHICLE.wheel_x, VEHICLE.wheel_y
    for i, angle in enumerate(road_steer_angles(icr, VEHICLE)):
        assert abs(angle) <= 0.5 * math.pi
        across = (xs[i] - icr.x) * math.cos(angle) + (ys[i] - icr.y) * math.sin(angle)
        assert across == pytest.approx(0.0, abs=1e-9)


def test_nearest_turn_centre_of_the_road_rule_is_half_the_track():
    # At half the track the inner wheels stand at 90 deg; nearer they would have to pass it.
    assert max(map(abs, road_steer_angles(Icr(0.0, 0.718), VEHICLE))) == pytest.approx(0.5 * math.pi)
    assert max(map(abs, road_steer_angles(Icr(0.0, 0.717), VEHICLE))) > 0.5 * math.pi
    assert all(steer_angles(twist_of_icr(Icr(0.0, 0.718), 1.0), AHEAD, 1.75, VEHICLE, 'road').reachable)
    assert not all(steer_angles(twist_of_icr(Icr(0.0, 0.717), 1.0), AHEAD, 1.75, VEHICLE, 'road').reachable)


@quiet
@given(lengths, st.floats(0.72, 50.0), st.sampled_from([-1.0, 1.0]))
def test_rules_agree_on_the_road(x, y, side):
    icr = Icr(x, side * y)
    road = steer_angles(twist_of_icr(icr, 3.0), AHEAD, 3.1, VEHICLE, 'road')
    assert road.angles == pytest.approx(road_steer_angles(icr, VEHICLE), abs=1e-9)
    assert min(road.speeds) > 0.0


@quiet
@given(speeds, speeds, st.floats(-5.0, 5.0), st.tuples(*[st.floats(-1.75, 1.75)] * 4))
def test_wheels_roll_with_the_body_whatever_the_motion(vx, vy, r, reference):
    steering = steer_angles(Twist(vx, vy, r), reference, 1.75, VEHICLE)
    assert all(steering.reachable)
    velocities = wheel_velocities(Twist(vx, vy, r), VEHICLE)
    fastest = max(math.hypot(*velocity) for velocity in velocities)
    for (u, w), angle, speed in zip(velocities, steering.angles, steering.speeds, strict=True):
        assert abs(angle) <= 1.75
        assert (speed * math.cos(angle), speed * math.sin(angle)) == pytest.approx((u, w), abs=2e-6 * fastest)


@quiet
@given(lengths, lengths, st.floats(0.1, 20.0))
def test_wheel_speed_is_distance_from_the_icr_times_yaw_rate(x, y, speed):
    assume(math.hypot(x, y) > 0.01)
    twist = twist_of_icr(Icr(x, y), speed)
    steering = steer_angles(twist, AHEAD, 1.75, VEHICLE)
    for i, wheel_speed in enumerate(steering.speeds):
        distance = math.hypot(VEHICLE.wheel_x[i] - x, VEHICLE.wheel_y[i] - y)
        assert abs(wheel_speed) == pytest.approx(distance * abs(twist.r), rel=1e-6, abs=1e-5 * speed)


def test_spin_in_place_turns_wheels_backward_rather_than_past_90_degrees():
    steering = steer_angles(Twist(0.0, 0.0, 1.0), AHEAD, 0.5 * math.pi, VEHICLE)
    assert all(steering.reachable)
    assert [speed > 0.0 for speed in steering.speeds] == [False, True, False, True]


def test_noise_across_90_degrees_does_not_flip_a_wheel():
    angles = AHEAD
    flips = 0
    for n in range(50):
        before = angles
        steering = steer_angles(Twist(0.01 * (-1.0) ** n, 1.0, 0.0), angles, 1.75, VEHICLE)
        angles = steering.angles
        flips += n > 0 and max(abs(a - b) for a, b in zip(angles, before, strict=True)) > 1.0
    assert flips == 0


def test_a_wheel_flips_at_its_limit():
    beyond = Twist(math.cos(1.8), math.sin(1.8), 0.0)
    steering = steer_angles(beyond, (1.74,) * 4, 1.75, VEHICLE)
    assert steering.angles == pytest.approx((1.8 - math.pi,) * 4)
    assert steering.speeds == pytest.approx((-1.0,) * 4)


def test_a_wheel_on_the_icr_keeps_its_angle_and_stands():
    icr = Icr(VEHICLE.wheel_x[0], VEHICLE.wheel_y[0])
    steering = steer_angles(twist_of_icr(icr, 1.0), (0.3, 0.0, 0.0, 0.0), 1.75, VEHICLE)
    assert (steering.angles[0], steering.speeds[0], steering.reachable[0]) == (0.3, 0.0, True)


def test_standing_still_swings_no_wheel():
    reference = (0.3, -0.2, 0.1, 1.5)
    assert steer_angles(Twist(0.0, 0.0, 0.0), reference, 1.75, VEHICLE).angles == reference


def test_crab_beyond_a_narrow_limit_is_flagged_and_held():
    steering = steer_angles(Twist(0.0, 1.0, 0.0), (0.1,) * 4, 0.6, VEHICLE)
    assert steering.reachable == (False,) * 4
    assert steering.angles == (0.1,) * 4
    assert steering.speeds == (0.0,) * 4


def test_road_rule_reverses_all_wheels_together():
    steering = steer_angles(twist_of_icr(Icr(0.0, 5.0), -2.0), AHEAD, 1.75, VEHICLE, 'road')
    assert max(steering.speeds) < 0.0
    assert steering.angles == pytest.approx(road_steer_angles(Icr(0.0, 5.0), VEHICLE))
