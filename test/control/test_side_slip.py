"""The side-slip controller: PID against scipy's lsim, signs, limits and bad input."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import signal

from omni_vehicle_ros.control.health import ERROR, OK, WARN
from omni_vehicle_ros.control.pid import Pid
from omni_vehicle_ros.control.side_slip import SideSlipController, exact_side_slip
from omni_vehicle_ros.control.trim import Sensed
from omni_vehicle_ros.parameters import SideSlipParameters, SteeringParameters

STEP = 5_000_000
FAST = (10.0,) * 4
any_float = st.floats(allow_nan=True, allow_infinity=True)


def steer(controller, stamp, side_slip, speeds=FAST):
    trims = controller.update(stamp, Sensed(side_slip, speeds))
    assert trims.torque == (0.0,) * 4
    return trims.steer_angle


def test_pid_is_the_transfer_function():
    gain, integral, derivative, tau, dt = 2.0, 3.0, 0.4, 0.05, 0.005
    time = dt * np.arange(200)
    error = 0.1 * np.cos(7.0 * time) - 0.1 + 0.05 * time
    # gain + integral / s + derivative s / (tau s + 1) over one denominator.
    numerator = [gain * tau + derivative, gain + integral * tau, integral]
    _, expected, _ = signal.lsim((numerator, [tau, 1.0, 0.0]), error, time, interp=True)
    pid = Pid(gain, integral, derivative, tau, 100.0)
    outputs = [pid.update(e, dt if k else 0.0) for k, e in enumerate(error)]
    assert outputs == pytest.approx(list(expected), abs=1e-10)


def test_integral_does_not_wind_up():
    pid = Pid(1.0, 10.0, 0.0, 0.05, 0.5)
    pid.update(1.0, 0.0)
    for _ in range(1000):
        assert pid.update(1.0, 0.01) == 0.5
    assert pid.saturated
    # Back inside the limit as soon as the error has turned, not 10 s later.
    outputs = [pid.update(-0.1, 0.01) for _ in range(5)]
    assert max(outputs) < 0.5
    assert not pid.saturated


@settings(deadline=None, max_examples=50)
@given(st.lists(st.floats(-2.0, 2.0), min_size=1, max_size=40))
def test_pid_output_is_within_its_limit(errors):
    pid = Pid(3.0, 20.0, 1.0, 0.02, 0.3)
    assert all(abs(pid.update(error, 0.01)) <= 0.3 for error in errors)


def test_trim_opposes_the_slip_of_its_own_wheel():
    controller = SideSlipController(SideSlipParameters(proportional_gains=(5.0, 1.0, 0.0, 2.0)))
    trims = steer(controller, 0, (0.01, -0.02, 0.03, -0.04))
    assert trims == pytest.approx((-0.05, 0.02, 0.0, 0.08))


def test_same_stamp_same_answer():
    controller = SideSlipController(SideSlipParameters(integral_gains=(1.0,) * 4))
    first = steer(controller, 0, (0.01,) * 4)
    assert steer(controller, 0, (0.4,) * 4) == first


@pytest.mark.parametrize('jump', [-STEP, 3_000_000_000])
def test_clock_that_jumps_starts_the_integral_anew(jump):
    gains = (1.0,) * 4
    controller = SideSlipController(SideSlipParameters(proportional_gains=gains, integral_gains=gains))
    for k in range(100):
        steer(controller, k * STEP, (0.01,) * 4)
    assert steer(controller, 99 * STEP + jump, (0.02,) * 4) == pytest.approx((-0.02,) * 4)


@pytest.mark.parametrize('speed, share', [(0.0, 0.0), (0.5, 0.0), (0.75, 0.5), (-0.75, 0.5), (1.0, 1.0), (-9.0, 1.0)])
def test_trim_fades_out_at_low_speed(speed, share):
    controller = SideSlipController(SideSlipParameters())
    # Rolling backward, the wheel must turn the other way to slip less.
    assert steer(controller, 0, (0.02,) * 4, (speed,) * 4)[0] == pytest.approx(math.copysign(0.1 * share, -speed))


def test_saturation_is_said_with_its_limit():
    controller = SideSlipController(SideSlipParameters())
    assert steer(controller, 0, (0.3, 0.0, 0.0, 0.0))[0] == -0.5
    assert controller.status.level == WARN
    assert 'front_left' in controller.status.message
    assert '0.5 rad' in controller.status.message


@pytest.mark.parametrize('bad', [math.nan, math.inf, -math.inf])
def test_no_number_keeps_the_last_trim_and_says_so(bad):
    controller = SideSlipController(SideSlipParameters())
    before = steer(controller, 0, (0.02,) * 4)
    after = steer(controller, STEP, (bad, 0.03, 0.0, 0.0), (*FAST[:3], bad))
    assert after[0] == before[0]
    assert after[1] == pytest.approx(-0.15)
    assert controller.status.level == ERROR
    assert 'front_left' in controller.status.message
    assert 'rear_right' in controller.status.message
    steer(controller, 2 * STEP, (0.0,) * 4)
    assert controller.status.level == OK


@settings(deadline=None, max_examples=50)
@given(st.lists(st.tuples(st.integers(-(2**40), 2**60), *[any_float] * 8), min_size=1, max_size=10))
def test_trims_are_finite_and_limited_whatever_comes(inputs):
    gains = (5.0,) * 4
    p = SideSlipParameters(proportional_gains=gains, integral_gains=gains, derivative_gains=gains)
    controller = SideSlipController(p)
    for stamp, *values in inputs:
        assert all(abs(trim) <= 0.5 for trim in steer(controller, stamp, tuple(values[:4]), tuple(values[4:])))


def test_exact_side_slip_solves_its_equation():
    slip = exact_side_slip(0.03, 5.0)
    assert slip == pytest.approx(0.03 - 5.0 * slip)


def test_slip_of_the_driven_vehicle_is_the_algebraic_one(closed_loop):
    # R = 5 m at 15 km/h, gains (5, 5, 0, 0): thesis, chapter 5.
    speed = 15.0 / 3.6
    loop = closed_loop(
        steering=SteeringParameters(motion_rate_limit=0.0), slip=SideSlipParameters(), speed=speed, constant_speed=True
    )
    for _ in loop.run(2.0, lambda: loop.drive(speed, (0.0, 5.0))):
        pass
    for i in range(2):
        steer_free = loop.seen.side_slip[i] - loop.trims.steer_angle[i]
        assert loop.seen.side_slip[i] == pytest.approx(exact_side_slip(steer_free, 5.0), rel=1e-3)
        assert loop.angles[i] == pytest.approx(loop.setpoints.steer_angle[i] + loop.trims.steer_angle[i], rel=1e-3)
    assert loop.seen.side_slip[0] < 0.05
