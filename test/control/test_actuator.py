"""Actuators against the closed form of a delayed first-order lag, and against a fine integration."""

import math
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from omni_vehicle_ros.control.actuator import DriveActuator, SteerActuator, lag_step
from omni_vehicle_ros.parameters import WheelModuleParameters

PERIOD = 0.005
STEP = 5_000_000


def course(actuator, set_points, period=PERIOD):
    """Return the angles at the begin of each cycle."""
    return [actuator.update(round(k * period * 1e9), s, period)[0] for k, s in enumerate(set_points)]


@pytest.mark.parametrize('delay', [0.0, 0.005, 0.0123, 0.05, 0.0001])
@pytest.mark.parametrize('period', [0.001, 0.005, 0.02])
def test_step_response_is_the_closed_form_at_any_period_and_delay(delay, period):
    actuator = SteerActuator(WheelModuleParameters(steer_delay=delay, steer_rate_limit=100.0))
    for k, angle in enumerate(course(actuator, [0.4] * 60, period)):
        assert angle == pytest.approx(0.4 * (1.0 - math.exp(-max(k * period - delay, 0.0) / 0.1)), abs=1e-12)


def test_rate_limit_and_lag_meet_without_a_kink():
    tau, rate = 0.1, 3.0
    actuator = SteerActuator(WheelModuleParameters(steer_delay=0.0, steer_time_constant=tau, steer_rate_limit=rate))
    slewing = (1.2 - rate * tau) / rate
    for k, angle in enumerate(course(actuator, [1.2] * 200)):
        t = k * PERIOD
        expected = rate * t if t < slewing else 1.2 - rate * tau * math.exp(-(t - slewing) / tau)
        assert angle == pytest.approx(expected, abs=1e-12)


def test_lag_step_solves_its_differential_equation():
    def slope(_, value):
        return [min(max((1.0 - value[0]) / 0.08, -2.0), 2.0)]

    solution = solve_ivp(slope, (0.0, 0.5), [-0.7], rtol=1e-10, atol=1e-12, max_step=1e-3)
    assert lag_step(-0.7, 1.0, 0.5, 0.08, 2.0) == pytest.approx(solution.y[0, -1], abs=1e-7)


@settings(deadline=None)
@given(st.floats(-2.0, 2.0), st.floats(-2.0, 2.0), st.floats(0.0, 1.0), st.floats(0.0, 1.0))
def test_two_steps_are_one(value, target, first, second):
    halves = lag_step(lag_step(value, target, first, 0.1, 3.0), target, second, 0.1, 3.0)
    assert halves == pytest.approx(lag_step(value, target, first + second, 0.1, 3.0), abs=1e-12)


@settings(deadline=None, max_examples=50)
@given(st.lists(st.floats(allow_nan=False, allow_infinity=False), min_size=2, max_size=30), st.floats(0.0, 0.03))
def test_angle_stays_in_range_and_rate_under_its_limit(set_points, delay):
    p = WheelModuleParameters(steer_delay=delay, steer_rate_limit=1.5, steer_limit=1.2)
    actuator = SteerActuator(p)
    for k, set_point in enumerate(set_points):
        angle, rate = actuator.update(k * STEP, set_point, PERIOD)
        assert abs(angle) <= 1.2 + 1e-12
        assert abs(rate) <= 1.5 + 1e-9


def test_the_mean_rate_leads_to_the_next_angle():
    actuator = SteerActuator(WheelModuleParameters())
    motions = [actuator.update(k * STEP, math.sin(0.3 * k), PERIOD) for k in range(50)]
    for (angle, rate), (next_angle, _) in pairwise(motions):
        assert next_angle == pytest.approx(angle + PERIOD * rate, abs=1e-12)


def test_a_missed_cycle_changes_nothing_but_its_own():
    every, some = SteerActuator(WheelModuleParameters()), SteerActuator(WheelModuleParameters())
    for k in range(40):
        full = every.update(k * STEP, 0.5, PERIOD)
        if k % 3 == 0:
            assert some.update(k * STEP, 0.5, PERIOD) == pytest.approx(full, abs=1e-12)


def test_clock_that_jumps_back_goes_on_from_the_present_angle():
    actuator = SteerActuator(WheelModuleParameters())
    angle = course(actuator, [0.5] * 60)[-1]
    assert actuator.update(0, 0.5, PERIOD)[0] == angle


def test_ideal_steering_is_there_at_once():
    actuator = SteerActuator(WheelModuleParameters(ideal_actuators=True))
    assert actuator.update(0, 0.7, PERIOD) == (0.7, 0.0)
    assert actuator.update(STEP, -9.0, PERIOD) == (-1.75, 0.0)


def test_drive_lag_carries_the_exact_angular_momentum():
    actuator, tau = DriveActuator(WheelModuleParameters()), 0.05
    momentum = sum(PERIOD * actuator.update(300.0, PERIOD) for _ in range(40))
    assert momentum == pytest.approx(300.0 * (0.2 - tau * (1.0 - math.exp(-0.2 / tau))))


def test_drive_torque_is_limited_both_ways():
    for ideal in (True, False):
        for sign in (1.0, -1.0):
            actuator = DriveActuator(WheelModuleParameters(ideal_actuators=ideal, drive_torque_limit=100.0))
            torques = [sign * actuator.update(sign * 1e300, PERIOD) for _ in range(200)]
            assert max(torques) <= 100.0
            assert torques[-1] == pytest.approx(100.0)
