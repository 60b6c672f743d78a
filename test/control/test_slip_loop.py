"""The gain limit of the slip loop, against eigenvalues and against the loop itself."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omni_vehicle_ros.control.actuator import SteerActuator
from omni_vehicle_ros.control.gain_margin import slip_loop
from omni_vehicle_ros.control.side_slip import SideSlipController, exact_side_slip
from omni_vehicle_ros.control.trim import Sensed
from omni_vehicle_ros.parameters import SideSlipParameters, WheelModuleParameters


def gain_limit(tau, delay, period):
    """Proportional gain at which the sampled slip loop begins to oscillate without end."""
    module = WheelModuleParameters(steer_time_constant=tau, steer_delay=delay)
    return slip_loop((1.0, 0.0, 0.0), 0.05, module, period).margin()


def spectral_radius(gain, tau, delay, period):
    """Largest eigenvalue of the loop x[k+1] = a x[k] + b1 u[k-q] + b0 u[k-q-1], u = -K x."""
    cycles = math.floor(delay / period + 1e-9)
    rest = max(delay / period - cycles, 0.0)
    decay, new = math.exp(-period / tau), 1.0 - math.exp(-(1.0 - rest) * period / tau)
    polynomial = np.zeros(cycles + 3)
    polynomial[:2] = 1.0, -decay
    polynomial[cycles + 1] += gain * new
    polynomial[cycles + 2] += gain * (1.0 - decay - new)
    return max(abs(np.roots(polynomial)))


def last_slips(gain, tau, delay, period, cycles=4000):
    """Side slips of a wheel of fixed velocity, at the end of a run from 0.01 rad."""
    gains = (gain, 0.0, 0.0, 0.0)
    controller = SideSlipController(SideSlipParameters(proportional_gains=gains, trim_limit=3.0))
    module = WheelModuleParameters(
        steer_time_constant=tau, steer_delay=delay, steer_rate_limit=100.0, steer_limit=3.1
    )
    steering, angle, slips = SteerActuator(module), 0.0, []
    for k in range(cycles):
        now = round(k * period * 1e9)
        slips.append(0.01 + angle)
        trim = controller.update(now, Sensed((slips[-1], 0.0, 0.0, 0.0), (9.0,) * 4)).steer_angle[0]
        angle, rate = steering.update(now, trim, period)
        angle += period * rate
    return slips[-200:]


@settings(deadline=None, max_examples=60)
@given(st.floats(0.005, 0.3), st.floats(0.0, 0.04), st.floats(0.001, 0.02))
def test_limit_is_where_an_eigenvalue_leaves_the_unit_circle(tau, delay, period):
    limit = gain_limit(tau, delay, period)
    assert spectral_radius(0.999 * limit, tau, delay, period) < 1.0
    assert spectral_radius(1.001 * limit, tau, delay, period) > 1.0


def test_closed_forms():
    decay = math.exp(-0.05)
    assert gain_limit(0.1, 0.0, 0.005) == pytest.approx((1.0 + decay) / (1.0 - decay))
    assert gain_limit(0.1, 0.005, 0.005) == pytest.approx(1.0 / (1.0 - decay))
    assert gain_limit(0.001, 0.0, 0.02) == pytest.approx(1.0)


@pytest.mark.parametrize('tau, delay, period', [(0.1, 0.005, 0.005), (0.05, 0.0, 0.005), (0.04, 0.012, 0.005)])
def test_the_loop_settles_below_the_limit_and_not_above(tau, delay, period):
    limit = gain_limit(tau, delay, period)
    below = last_slips(0.9 * limit, tau, delay, period)
    assert max(below) - min(below) < 1e-6
    above = last_slips(1.1 * limit, tau, delay, period)
    assert max(above) - min(above) > 1e-2


def test_defaults_hold_the_gains_of_the_thesis_with_a_margin_of_four():
    p = WheelModuleParameters()
    assert gain_limit(p.steer_time_constant, p.steer_delay, 0.005) > 4.0 * 5.0


@pytest.mark.parametrize('gain', [1.0, 5.0])
def test_settled_loop_is_the_algebraic_solution(gain):
    p = WheelModuleParameters()
    slips = last_slips(gain, p.steer_time_constant, p.steer_delay, 0.005)
    assert slips[-1] == pytest.approx(exact_side_slip(0.01, gain), rel=1e-9)


def test_a_faster_loop_comes_closer_to_the_algebraic_solution_in_time():
    # Time to come within 1 % of alpha / (1 + K) falls with tau and the period, in proportion.
    def settling(scale):
        slips = np.array(last_slips(5.0, 0.1 * scale, 0.0, 0.005 * scale, 200))
        far = np.flatnonzero(abs(slips - exact_side_slip(0.01, 5.0)) > 1e-4)
        return far[-1] * 0.005 * scale

    assert settling(1.0) == pytest.approx(2.0 * settling(0.5)) == pytest.approx(10.0 * settling(0.1))


def test_ideal_actuator_and_a_sample_of_delay_diverge_above_gain_one():
    # Known trap: slip measured before the correction of the same cycle acts.
    assert spectral_radius(1.01, 1e-6, 0.0, 0.005) > 1.0
    assert spectral_radius(0.99, 1e-6, 0.0, 0.005) < 1.0
