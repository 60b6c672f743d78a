"""One wheel module: it follows, and it looks after its wheel when nobody does."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omni_vehicle_ros.control.health import ERROR, OK, WARN
from omni_vehicle_ros.control.wheel_module import Setpoint, Trim, WheelModule
from omni_vehicle_ros.parameters import WheelModuleParameters

PERIOD, STEP, TRIM_LIMIT = 0.005, 5_000_000, 0.5
any_float = st.floats(allow_nan=True, allow_infinity=True)


def module(**values):
    return WheelModule(WheelModuleParameters(**values), PERIOD, TRIM_LIMIT)


def follow(wheel, cycles, angle=0.3, torque=50.0, trim=None, speed=10.0, begin=0, added_torque=0.0):
    for k in range(begin, begin + cycles):
        wheel.command(Setpoint(k * STEP, angle, speed, torque))
        if trim is not None:
            wheel.trim(Trim(k * STEP, trim, added_torque))
        state = wheel.update(k * STEP, speed)
    return state


def test_set_points_are_followed():
    state = follow(module(), 400, trim=0.05, added_torque=-80.0)
    assert state == pytest.approx((0.35, 0.0, -30.0), abs=1e-6)


def test_passive_before_the_first_command():
    wheel = module()
    wheel.trim(Trim(0, 0.2, 100.0))
    assert [wheel.update(k * STEP, 10.0) for k in range(100)] == [(0.0, 0.0, 0.0)] * 100
    assert wheel.status.level == OK
    assert 'passive' in wheel.status.message


def test_stale_set_point_holds_the_angle_it_has_and_brakes():
    wheel = module()
    follow(wheel, 10, angle=1.0)
    states = [wheel.update(k * STEP, 10.0) for k in range(10, 200)]
    assert wheel.status.level == ERROR
    assert 'module_timeout, 0.1 s' in wheel.status.message
    assert 0.1 < states[-1].steer_angle < 0.9
    # The angle stands where it was when the set-point became stale, but for what was under way in the delay.
    assert states[-1].steer_angle == pytest.approx(states[21].steer_angle, abs=0.02)
    assert states[-1].drive_torque == pytest.approx(-1050.0)


def test_braked_wheel_comes_to_rest_from_one_side():
    # A quarter of the vehicle on this wheel, with the lag of the drive.
    for sign in (1.0, -1.0):
        wheel, speed = module(), sign * 10.0
        follow(wheel, 1, torque=0.0)
        for k in range(1, 1000):
            torque = wheel.update(k * STEP, speed).drive_torque
            speed += PERIOD * torque / (0.25 * 1298.9 * 0.35**2)
            assert speed * sign > -1e-6
        assert speed == pytest.approx(0.0, abs=1e-6)


def test_fresh_set_points_resume_at_once():
    wheel = module(ideal_actuators=True)
    follow(wheel, 5)
    for k in range(5, 100):
        wheel.update(k * STEP, 10.0)
    assert follow(wheel, 1, angle=0.5, begin=100) == (0.5, 0.0, 50.0)
    assert wheel.status.level == OK


def test_zero_timeout_is_off():
    wheel = module(module_timeout=0.0, ideal_actuators=True)
    follow(wheel, 1, trim=0.1)
    assert wheel.update(3600 * 10**9, 10.0) == pytest.approx((0.4, 0.0, 50.0))


def test_zero_stamp_means_now():
    wheel = module(ideal_actuators=True)
    wheel.command(Setpoint(0, 0.3, 0.0, 1.0))
    assert wheel.update(99 * 10**9, 0.0).drive_torque == 1.0
    assert wheel.update(99 * 10**9 + 50_000_000, 0.0).drive_torque == 1.0
    wheel.update(99 * 10**9 + 150_000_000, 0.0)
    assert wheel.status.level == ERROR


def test_old_trim_is_dropped_and_said():
    wheel = module(ideal_actuators=True)
    assert follow(wheel, 1, trim=0.1, added_torque=20.0) == pytest.approx((0.4, 0.0, 70.0))
    assert follow(wheel, 30, begin=1) == pytest.approx((0.3, 0.0, 50.0))
    assert wheel.status.level == WARN
    assert 'no trim from side_slip_controller' in wheel.status.message
    assert follow(wheel, 1, trim=0.1, begin=31).steer_angle == pytest.approx(0.4)
    assert wheel.status.level == OK


def test_no_trim_at_all_is_nothing_to_complain_about():
    wheel = module()
    follow(wheel, 100)
    assert wheel.status.level == OK


def test_angle_and_trim_stay_within_the_limit_and_it_is_said():
    wheel = module(ideal_actuators=True)
    assert follow(wheel, 1, angle=1.6, trim=0.3).steer_angle == 1.75
    assert wheel.status.level == WARN
    assert 'steer_limit, 1.75 rad' in wheel.status.message


def test_torque_beyond_the_limit_is_clipped_and_said():
    wheel = module(ideal_actuators=True)
    assert follow(wheel, 1, torque=-5000.0).drive_torque == -1050.0
    assert 'drive_torque_limit, 1050 N m' in wheel.status.message
    # What the command and the trim ask for together is what counts.
    assert follow(wheel, 1, torque=-2000.0, trim=0.0, added_torque=1500.0, begin=1).drive_torque == -500.0
    assert wheel.status.level == OK
    assert follow(wheel, 1, torque=600.0, trim=0.0, added_torque=1500.0, begin=2).drive_torque == 1050.0
    assert wheel.status.level == WARN


@pytest.mark.parametrize('bad', [math.nan, math.inf, -math.inf])
def test_what_is_not_finite_is_refused_and_the_last_good_one_kept(bad):
    wheel = module(ideal_actuators=True)
    good = follow(wheel, 1, trim=0.05)
    commands = Setpoint(STEP, bad, 0.0, 0.0), Setpoint(STEP, 0.0, bad, 0.0), Setpoint(STEP, 0.0, 0.0, bad)
    for command, trim in zip(commands, [(bad, 0.0), (0.0, bad), (bad, bad)], strict=True):
        wheel.command(command)
        wheel.trim(Trim(STEP, *trim))
        assert wheel.update(STEP, 10.0) == good
        assert wheel.status.level == ERROR
        assert str(bad) in wheel.status.message
    follow(wheel, 1, trim=0.05, begin=2)
    assert wheel.status.level == OK


def test_clock_that_jumps_back_is_a_new_start():
    wheel = module()
    angle = follow(wheel, 200, angle=0.3, begin=1000).steer_angle
    state = wheel.update(0, 10.0)
    assert state.steer_angle == pytest.approx(angle, abs=1e-3)
    assert 'passive' in wheel.status.message


@settings(deadline=None, max_examples=60)
@given(st.lists(
    st.tuples(st.integers(0, 3), st.integers(-(10**12), 10**18), *[any_float] * 6), min_size=1, max_size=20
))
def test_actuators_stay_finite_and_within_their_limits_whatever_comes(inputs):
    wheel, now = module(), 0
    for steps, stamp, angle, spin, torque, trim, added_torque, measured in inputs:
        wheel.command(Setpoint(stamp, angle, spin, torque))
        wheel.trim(Trim(stamp, trim, added_torque))
        now += steps * STEP
        state = wheel.update(now, measured)
        assert all(map(math.isfinite, state))
        assert abs(state.steer_angle) <= 1.75
        assert abs(state.steer_rate) <= 3.0 + 1e-9
        assert abs(state.drive_torque) <= 1050.0 + 1e-9
