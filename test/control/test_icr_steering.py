"""ICR steering: one rigid motion in every cycle, whatever is commanded."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omni_vehicle_ros.control.health import ERROR, OK, WARN, health
from omni_vehicle_ros.control.icr_steering import IcrSteering
from omni_vehicle_ros.messages import Point, Twist, Wrench
from omni_vehicle_ros.model.kinematics import Icr, road_steer_angles
from omni_vehicle_ros.parameters import SteeringParameters, VehicleParameters

VEHICLE = VehicleParameters()
PERIOD, STEP = 0.005, 5_000_000
ZERO = (0.0,) * 4
X, Y = np.array(VEHICLE.wheel_x), np.array(VEHICLE.wheel_y)

any_float = st.floats(allow_nan=True, allow_infinity=True)
some_float = st.one_of(st.floats(-40.0, 40.0), any_float)
frames = st.sampled_from(['', 'base_link', 'odom'])


def commands(numbers):
    stamps = st.sampled_from([0, 1, 10**18])
    return st.one_of(
        st.builds(Point, stamps, numbers, numbers, frame=frames),
        st.builds(Twist, stamps, numbers, numbers, numbers, frame=frames),
        st.builds(Wrench, stamps, numbers, tz=numbers, frame=frames),
        st.none(),
    )


class Bench:
    """ICR steering with wheels that follow at once: measured are the last set-points."""

    def __init__(self, steering=None, angles=ZERO, speeds=ZERO, **limits):
        self.law = IcrSteering(VEHICLE, steering or SteeringParameters(**limits), PERIOD)
        self.now, self.angles, self.speeds = 0, angles, speeds

    def say(self, command, as_twist=False):
        if isinstance(command, Point):
            self.law.icr(command, self.now)
        elif isinstance(command, Wrench):
            self.law.traction(command, self.now)
        elif isinstance(command, Twist):
            (self.law.cmd_vel if as_twist else self.law.speed)(command, self.now)

    def cycle(self, count=1):
        for _ in range(count):
            self.set = self.law.update(self.now, self.angles, self.speeds)
            self.angles, self.speeds = self.set.steer_angle, self.set.wheel_speed
            self.now += STEP
        return self.set

    def drive(self, seconds, speed, icr=None):
        for _ in range(round(seconds / PERIOD)):
            if icr is not None:
                self.say(Point(0, *icr))
            self.say(Twist(0, speed))
            self.cycle()
        return self.set

    def twist(self, seconds, *twist):
        for _ in range(round(seconds / PERIOD)):
            self.say(Twist(0, *twist), as_twist=True)
            self.cycle()
        return self.set


def twist_of(setpoints):
    """Return the twist that fits the wheels' velocities, and how far they are from being those of a rigid body."""
    angle, speed = np.array(setpoints.steer_angle), 0.35 * np.array(setpoints.wheel_speed)
    rows = np.concatenate([
        np.column_stack([np.ones(4), np.zeros(4), -Y]), np.column_stack([np.zeros(4), np.ones(4), X])
    ])
    velocities = np.concatenate([speed * np.cos(angle), speed * np.sin(angle)])
    twist = np.linalg.lstsq(rows, velocities, rcond=None)[0]
    return twist, np.max(abs(rows @ twist - velocities))


def axles_miss(angles):
    """Return how far the four axle lines are from meeting in one point (at infinity too): 0 if they do."""
    angles = np.array(angles)
    across = np.column_stack([-np.sin(angles), np.cos(angles), Y * np.sin(angles) + X * np.cos(angles)])
    return np.linalg.svd(across, compute_uv=False)[2]


@settings(deadline=None, max_examples=30)
@given(
    st.lists(st.tuples(commands(st.floats(-40.0, 40.0)), st.booleans(), st.integers(1, 40)), min_size=1, max_size=12)
)
def test_all_wheels_share_one_icr_in_every_cycle(script):
    bench = Bench()
    for command, as_twist, cycles in script:
        bench.say(command, as_twist)
        for _ in range(cycles):
            found = bench.cycle()
            assert axles_miss(found.steer_angle) < 1e-6
            assert twist_of(found)[1] < 1e-6


@settings(deadline=None, max_examples=60)
@given(
    st.lists(st.tuples(commands(some_float), st.booleans(), st.tuples(*[any_float] * 8)), min_size=1, max_size=12),
    st.sampled_from(['road', 'omni']), st.floats(0.3, 3.1),
)
def test_nothing_but_finite_set_points_within_their_limits_whatever_comes(script, rule, limit):
    steering = SteeringParameters(steering_rule=rule, steer_limit=limit)
    law = IcrSteering(VEHICLE, steering, PERIOD)
    bench = Bench()
    bench.law = law
    for k, (command, as_twist, measured) in enumerate(script):
        bench.say(command, as_twist)
        bench.now += STEP
        found = law.update(k * STEP, measured[:4], measured[4:])
        assert all(math.isfinite(value) for values in found for value in values)
        assert max(map(abs, found.steer_angle)) <= limit
        assert max(map(abs, found.torque)) <= 3000.0 * 0.35 * (1 + 1e-12)
        assert max(map(abs, found.wheel_speed)) <= 40.0 / 0.35 * (1 + 1e-9)
        assert law.status.level in (OK, WARN, ERROR)


@settings(deadline=None, max_examples=12)
@given(
    st.lists(
        st.tuples(st.floats(0.8, 30.0), st.floats(-10.0, 10.0), st.sampled_from([1.0, -1.0])), min_size=1, max_size=4
    ),
    st.floats(-8.0, 8.0),
)
def test_left_and_right_are_mirror_images(icrs, speed):
    left, right = Bench(), Bench()
    for y, x, side in icrs:
        a, b = left.drive(0.3, speed, (x, side * y)), right.drive(0.3, speed, (x, -side * y))
        for plain, mirrored, sign in zip(a[:3], b[:3], (-1.0, 1.0, 1.0), strict=True):
            fl, fr, rl, rr = mirrored
            assert (sign * fr, sign * fl, sign * rr, sign * rl) == pytest.approx(plain, abs=1e-6)
        assert (a.twist.vx, -a.twist.vy, -a.twist.r) == pytest.approx(b.twist, abs=1e-6)


@settings(deadline=None, max_examples=20)
@given(st.floats(-5.0, 5.0), st.floats(-5.0, 5.0), st.floats(-1.5, 1.5), st.integers(1, 400))
def test_the_twist_is_the_motion_of_the_wheels_in_every_cycle(vx, vy, yaw_rate, cycles):
    bench = Bench()
    for _ in range(cycles):
        bench.law.cmd_vel(Twist(bench.now, vx, vy, yaw_rate), bench.now)
        found = bench.cycle()
    for i in range(4):
        speed, angle, twist = 0.35 * found.wheel_speed[i], found.steer_angle[i], found.twist
        rolling = speed * math.cos(angle), speed * math.sin(angle)
        assert (twist.vx - Y[i] * twist.r, twist.vy + X[i] * twist.r) == pytest.approx(rolling, abs=1e-5)


@settings(deadline=None, max_examples=20)
@given(st.floats(-8.0, 8.0), st.floats(0.8, 30.0), st.sampled_from([1.0, -1.0]))
def test_settled_set_points_are_those_of_the_thesis(x, y, side):
    bench = Bench(steering_rule='road', motion_rate_limit=0.0)
    found = bench.drive(2.0, 2.0, (x, side * y))
    assert found.steer_angle == pytest.approx(road_steer_angles(Icr(x, side * y), VEHICLE), abs=1e-9)
    distances = np.hypot(X - x, Y - side * y) / math.hypot(x, side * y)
    assert found.wheel_speed == pytest.approx(2.0 * distances / 0.35)


@pytest.mark.parametrize('twist', [
    (2.0, 0.0, 0.0), (-2.0, 0.0, 0.0), (0.0, 1.5, 0.0), (0.0, -1.5, 0.0), (1.0, 1.0, 0.0), (-1.0, 1.0, 0.5),
    (0.0, 0.0, 1.0), (0.0, 0.0, -1.0), (1.0, 0.0, 2.0), (0.0, 1.0, -1.0),
])
def test_any_twist_is_made_crab_and_spin_included(twist):
    assert twist_of(Bench().twist(8.0, *twist))[0] == pytest.approx(twist, abs=1e-9)


def test_the_direction_turns_no_faster_than_its_limit():
    bench, directions = Bench(motion_rate_limit=0.5), []
    bench.drive(3.0, 3.0)
    for _ in range(600):
        bench.drive(PERIOD, 3.0, (0.0, 1.0))
        vx, vy, r = twist_of(bench.set)[0]
        directions.append(np.array([vx, vy, 1.227 * r]) / math.sqrt(vx * vx + vy * vy + (1.227 * r) ** 2))
    turns = [math.acos(min(1.0, float(a @ b))) for a, b in pairwise(directions)]
    assert max(turns) == pytest.approx(0.5 * PERIOD, rel=1e-3)


def test_speed_changes_no_faster_than_its_limit_and_reverses_through_rest():
    bench, before = Bench(acceleration_limit=2.0), 0.0
    for target in (3.0, -3.0, 0.0):
        passed_rest = False
        for _ in range(800):
            bench.drive(PERIOD, target)
            now = twist_of(bench.set)[0][0]
            assert abs(now - before) <= 2.0 * PERIOD + 1e-9
            passed_rest |= now == 0.0
            before = now
        assert before == pytest.approx(target)
        assert passed_rest == (target <= 0.0)


def test_a_turn_at_the_wheel_speed_limit_does_not_pass_it():
    bench = Bench(maximum_wheel_speed=3.0, motion_rate_limit=5.0, acceleration_limit=0.1)
    bench.drive(40.0, 3.0)
    for _ in range(200):
        assert max(map(abs, bench.drive(PERIOD, 3.0, (0.0, 1.0)).wheel_speed)) <= 3.0 / 0.35 * (1 + 1e-12)


def test_no_acceleration_limit_means_at_once():
    found = Bench(acceleration_limit=0.0).drive(PERIOD, 3.0)
    assert found.wheel_speed == pytest.approx((3.0 / 0.35,) * 4)


def test_left_to_right_passes_through_straight_on_and_not_through_a_spin():
    bench = Bench()
    bench.drive(6.0, 1.0, (0.0, 1.0))
    speeds = []
    for _ in range(1200):
        speeds.append(twist_of(bench.drive(PERIOD, 1.0, (0.0, -1.0)))[0][0])
    assert min(speeds) > 0.9
    assert twist_of(bench.set)[0] == pytest.approx((1.0, 0.0, -1.0), abs=1e-6)


def test_taking_over_a_rolling_vehicle_begins_at_its_speed():
    bench = Bench(speeds=(10.0 / 0.35,) * 4)
    assert twist_of(bench.drive(PERIOD, 10.0))[0][0] == pytest.approx(10.0)


def test_icr_with_speed_zero_steers_for_parking():
    bench = Bench()
    found = bench.drive(4.0, 0.0, (0.0, 3.0))
    assert found.steer_angle == pytest.approx(road_steer_angles(Icr(0.0, 3.0), VEHICLE), abs=1e-9)
    assert found.wheel_speed == ZERO


def test_icr_alone_steers_as_well():
    bench = Bench()
    bench.say(Point(0, 0.0, 3.0))
    found = bench.cycle(800)
    assert found.steer_angle == pytest.approx(road_steer_angles(Icr(0.0, 3.0), VEHICLE), abs=1e-9)


def test_speed_without_an_icr_is_straight_on():
    assert Bench().drive(3.0, 2.0).steer_angle == ZERO


def test_autonomy_takes_over_from_a_hand_that_fell_silent_and_the_icr_is_kept():
    bench = Bench(motion_rate_limit=0.0)
    bench.drive(2.0, 2.0, (0.0, 5.0))
    turning = bench.set.steer_angle
    bench.twist(0.4, 1.0)
    assert bench.set.steer_angle == pytest.approx(turning, abs=1e-9)
    assert bench.law.status.message == 'cmd_vel is ignored: driver/speed holds, and teleop goes before autonomy'
    bench.twist(0.6, 1.0)
    assert bench.set.steer_angle == pytest.approx(ZERO, abs=1e-9)
    assert bench.law.status.message == 'following cmd_vel'
    bench.drive(1.0, 2.0)
    assert bench.set.steer_angle == pytest.approx(turning, abs=1e-9)
    assert bench.law.status.message == 'following driver/speed'


def test_open_loop_traction_gives_its_torque_at_the_icr():
    bench = Bench(motion_rate_limit=0.0)
    bench.say(Point(0, 0.0, 5.0))
    bench.say(Wrench(0, 2000.0))
    found = bench.cycle(5)
    assert found.torque == pytest.approx((500.0 * 0.35,) * 4)
    assert found.steer_angle == pytest.approx(road_steer_angles(Icr(0.0, 5.0), VEHICLE))


def test_traction_in_a_backward_motion_drives_it_forward_again():
    # A crab to the right, driven as a crab to the left backwards, then traction straight ahead.
    bench = Bench()
    bench.twist(5.0, 0.0, -1.0)
    bench.say(Point(0, 0.0, 1e6))
    for _ in range(1200):
        bench.say(Wrench(0, 400.0))
        bench.cycle()
    angles, torques = bench.set.steer_angle, bench.set.torque
    assert sum(t * math.cos(a) for t, a in zip(torques, angles, strict=True)) == pytest.approx(400.0 * 0.35)


def test_refusals_and_clamps_are_said_and_taken_back():
    bench = Bench()
    bench.drive(PERIOD, 2.0, (0.0, 5.0))
    bench.say(Point(0, math.nan, 5.0))
    bench.say(Twist(0, 99.0))
    bench.cycle()
    assert bench.law.status.level == ERROR
    assert 'nan' in bench.law.status.message
    assert 'maximum_speed, 30 m/s' in bench.law.status.message
    bench.drive(PERIOD, 2.0, (0.0, 5.0))
    assert bench.law.status == health([], 'following driver/speed', (('source', 'driver/speed'), ('state', 'fresh')))


def test_a_refused_command_is_no_sign_of_life():
    bench = Bench()
    bench.drive(1.0, 2.0)
    for _ in range(300):
        bench.say(Twist(0, math.nan))
        bench.cycle()
    assert bench.set.wheel_speed[0] * 0.35 < 1e-9 + 2.0
    assert 'command_timeout' in bench.law.status.message


def test_a_measurement_that_is_no_number_is_said():
    bench = Bench()
    bench.law.update(0, (0.1,) * 4, ZERO)
    found = bench.law.update(STEP, (math.nan,) * 4, ZERO)
    assert found.steer_angle == (0.1,) * 4
    assert bench.law.status.level == ERROR


def test_same_stamp_same_answer():
    bench = Bench()
    first = bench.drive(0.1, 2.0)
    assert bench.law.update(bench.now - STEP, (0.3,) * 4, (5.0,) * 4) is first


def test_the_way_through_angles_out_of_reach_is_taken_standing():
    # A spin needs 1.112 rad of the rear wheels; on the way to it from straight on they would pass 90 deg.
    bench, standing = Bench(steer_limit=1.2), False
    bench.twist(4.0, 1.0)
    for _ in range(2000):
        bench.twist(PERIOD, 0.0, 0.0, 1.0)
        assert max(map(abs, bench.set.steer_angle)) <= 1.2
        if 'on the way' in bench.law.status.message:
            standing |= bench.set.wheel_speed == ZERO
    assert standing
    assert twist_of(bench.set)[0] == pytest.approx((0.0, 0.0, 1.0), abs=1e-9)


def test_turning_into_a_turn_does_not_make_the_vehicle_faster():
    bench = Bench()
    bench.drive(5.0, 3.5)
    for _ in range(400):
        bench.drive(PERIOD, 3.5, (0.0, 2.0))
        twist, _ = twist_of(bench.set)
        assert math.hypot(twist[0], twist[1]) == pytest.approx(3.5, abs=1e-6)


def spinning(law, now, yaw_rate, vx=0.0):
    """Feed straight wheels of a vehicle that turns under them."""
    law.speed(Twist(0, 5.0), now)
    return law.update(now, ZERO, tuple((vx - y * yaw_rate) / 0.35 for y in Y))


def test_in_a_spin_the_drives_do_not_feed_it_but_brake_every_wheel():
    law = IcrSteering(VEHICLE, SteeringParameters(), PERIOD)
    for cycle in range(2000):
        got = spinning(law, cycle * STEP, 2.5, vx=1.0)
    assert law.status.level == WARN
    assert 'slides sideways' in law.status.message
    speeds = [1.0 - y * 2.5 for y in Y]
    assert all(torque * speed < 0.0 for torque, speed in zip(got.torque, speeds, strict=True))
    assert max(map(abs, got.torque)) <= 0.25 * VEHICLE.mass * 2.0 * 0.35 + 1e-9
    # Rolling again, it drives on from the speed that is left: nothing has wound up.
    after = spinning(law, 2000 * STEP, 0.0, vx=1.0)
    assert 'slides' not in law.status.message
    assert 0.0 < max(after.torque) < 0.25 * VEHICLE.mass * 2.5 * 0.35
    assert after.twist.vx == pytest.approx(1.0 + 2.0 * PERIOD)


def test_what_made_it_slide_is_not_driven_again_until_something_else_is_commanded():
    bench = Bench(speeds=(5.0 / 0.35,) * 4)
    bench.drive(1.0, 5.0)
    bench.speeds = tuple((1.0 - y * 2.5) / 0.35 for y in Y)
    bench.drive(PERIOD, 5.0)
    assert 'slides sideways' in bench.law.status.message
    got = bench.drive(5.0, 5.0)
    assert got.twist.vx == pytest.approx(0.8 * 5.0)
    assert 'after a slide' in bench.law.status.message
    bench.drive(1.0, 3.9)
    assert bench.drive(5.0, 5.0).twist.vx == pytest.approx(5.0)
    assert bench.law.status.level == OK


def test_a_turn_with_a_lot_of_slip_is_no_spin():
    law, radius = IcrSteering(VEHICLE, SteeringParameters(), PERIOD), 5.0
    angles = tuple(np.arctan2(X / radius, 1.0 - Y / radius))
    for cycle in range(100):
        law.icr(Point(0, 0.0, radius), cycle * STEP)
        law.speed(Twist(0, 6.0), cycle * STEP)
        vx, vy, r = 6.0, -1.5, 1.0  # 14 deg beside its nose, and running wide
        speeds = (np.cos(angles) * (vx - Y * r) + np.sin(angles) * (vy + X * r)) / 0.35
        law.update(cycle * STEP, angles, tuple(speeds))
    assert 'slides' not in law.status.message


def test_after_a_long_gap_the_speed_begins_with_what_is_measured():
    bench = Bench(speeds=(10.0 / 0.35,) * 4)
    bench.drive(1.0, 10.0)
    bench.now += 5 * 10**9
    bench.speeds = (4.0 / 0.35,) * 4
    got = bench.drive(PERIOD, 10.0)
    assert got.twist.vx < 4.0 + 2.0 * 21 * PERIOD
    assert max(got.torque) < 0.25 * VEHICLE.mass * (2.0 + 2.0 * 0.3) * 0.35
