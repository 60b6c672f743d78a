"""Gains are refused where the real loop of controller and actuator diverges, and not before."""

import math

import numpy as np
import pytest
from scipy.linalg import expm

from omni_vehicle_ros.control import gain_margin
from omni_vehicle_ros.control.actuator import SteerActuator
from omni_vehicle_ros.control.loop_check import check_gains
from omni_vehicle_ros.control.side_slip import SideSlipController
from omni_vehicle_ros.control.trim import Sensed
from omni_vehicle_ros.errors import ParameterError
from omni_vehicle_ros.parameters import SideSlipParameters, VehicleParameters, WheelModuleParameters

VEHICLE, MODULE, PERIOD = VehicleParameters(), WheelModuleParameters(), 0.005
IDEAL = WheelModuleParameters(ideal_actuators=True)


def refusal(parameters, module=MODULE, vehicle=VEHICLE):
    try:
        check_gains(parameters, vehicle, module, PERIOD)
    except ParameterError as error:
        return str(error)
    return ''


def front_left(*gains, **values):
    names = ('proportional_gains', 'integral_gains', 'derivative_gains')
    return SideSlipParameters(**{n: (g, 0.0, 0.0, 0.0) for n, g in zip(names, gains, strict=True)}, **values)


def swing(parameters, module, cycles=2000):
    """How much the slip of a wheel of fixed velocity changes from cycle to cycle at the end, over the begin."""
    law, steering, angle, slips = SideSlipController(parameters), SteerActuator(module), 0.0, []
    for k in range(cycles):
        now = round(k * PERIOD * 1e9)
        slips.append(1e-6 + angle)
        trim = law.update(now, Sensed((slips[-1], 0.0, 0.0, 0.0), (9.0,) * 4)).steer_angle[0]
        angle, rate = steering.update(now, trim, PERIOD)
        angle += PERIOD * rate
    change = np.abs(np.diff(slips))
    return change[-200:].max() / change[:200].max()


@pytest.mark.parametrize('tau, cycles', [(0.1, 1), (0.03, 0), (0.2, 0), (0.06, 1)])
def test_proportional_gains_are_refused_from_the_closed_form_on(tau, cycles):
    # x[k+1] = a x[k] - K (1 - a) x[k-q]: at z = -1 for q = 0, at the product 1 of a conjugate pair for q = 1.
    module, decay = WheelModuleParameters(steer_time_constant=tau, steer_delay=cycles * PERIOD), math.exp(-PERIOD / tau)
    limit = (1.0 if cycles else 1.0 + decay) / (1.0 - decay)
    assert not refusal(front_left(0.9999 * limit, 0.0, 0.0), module)
    assert f'is not below {limit:.3g}' in refusal(front_left(1.0001 * limit, 0.0, 0.0), module)


@pytest.mark.parametrize('gains', [(8.0, 30.0, 0.4), (1.0, 0.0, 0.8), (10.0, 40.0, 0.0)])
def test_the_real_loop_settles_below_the_limit_and_not_above(gains):
    module = WheelModuleParameters(steer_rate_limit=100.0)
    limit = gain_margin.slip_loop(gains, 0.05, module, PERIOD).margin()
    for share in (0.95, 1.05):
        parameters = front_left(*(share * limit * gain for gain in gains), trim_limit=3.0)
        assert (swing(parameters, module) > 1.0) == (share > 1.0)
        assert bool(refusal(parameters, module)) == (share > 1.0)


def test_with_ideal_actuators_the_gain_of_a_slip_that_alternates_must_be_below_one():
    # From one cycle to the next the slip is minus the law's answer; the filter of the derivative, exact for a
    # ramp between samples, at z = -1.
    derivative, ramp = 0.03, 0.05 / PERIOD
    decay = math.exp(-1.0 / ramp)
    passed = (1.0 - ramp + decay * ramp - (ramp - decay * (1.0 + ramp))) / (1.0 + decay)
    rest = 1.0 - derivative / 0.05 * (1.0 - passed)
    assert not refusal(front_left(0.999 * rest, 0.0, derivative), IDEAL)
    reason = refusal(front_left(1.001 * rest, 0.0, derivative), IDEAL)
    assert 'ideal_actuators: false' in reason
    assert refusal(front_left(1.0, 0.0, 0.0), IDEAL)


def test_defaults_and_what_the_thesis_uses_are_taken():
    for name in ('wheel_slip', 'yaw_moment', 'rear_steering', 'allocation'):
        assert not refusal(SideSlipParameters(controller=name))
    assert not refusal(SideSlipParameters(proportional_gains=(5.0, 1.0, 0.0, 0.0)))


@pytest.mark.parametrize(
    'controller, name, limit',
    [
        ('wheel_slip', 'proportional_gains', 20.5),
        ('yaw_moment', 'yaw_gain', 780e3),
        ('yaw_moment', 'yaw_integral_gain', 580e3),
        ('yaw_moment', 'yaw_derivative_gain', 71e3),
        ('allocation', 'allocation_gain', 14.0),
        ('allocation', 'allocation_integral_gain', 13.0),
    ],
)
def test_limits_are_those_of_the_texts(controller, name, limit):
    def parameters(value):
        return SideSlipParameters(controller=controller, **{name: (value,) * 4 if 'gains' in name else value})

    assert not refusal(parameters(limit))
    reason = refusal(parameters(1.1 * limit))
    assert name in reason
    assert 'lower' in reason
    number = 'below ' + f'{limit:.3g}' if limit < 1e3 else f'{limit:.0f}'
    text = {e.name: e.metadata['text'] for e in SideSlipParameters.__dataclass_fields__.values()}[name]
    assert number.removeprefix('below ') in text


def test_the_reason_names_the_worst_speed_and_gains_that_are_taken():
    reason = refusal(SideSlipParameters(controller='allocation', allocation_gain=1.0, allocation_integral_gain=60.0))
    values = [float(number) for number in reason.split('is not below ')[1].split(', where')[0].split(', ')]
    gains = dict(zip(('allocation_gain', 'allocation_integral_gain'), values, strict=True))
    assert 'at 30 m/s' in reason
    lower = {name: 0.99 * value for name, value in gains.items()}
    assert not refusal(SideSlipParameters(controller='allocation', **lower))


def test_a_controller_without_gains_is_refused_on_slow_actuators_only():
    slow = WheelModuleParameters(steer_time_constant=0.1, steer_delay=0.3)
    assert 'rear_steering oscillates' in refusal(SideSlipParameters(controller='rear_steering'), slow)


def test_a_vehicle_that_is_unstable_by_itself_is_not_the_fault_of_the_gains():
    # Heavy at the back: beyond its critical speed no small gain settles it.
    tail_heavy = VehicleParameters(cg_to_front_axle=1.6, cg_to_rear_axle=0.9)
    feeble = SideSlipParameters(controller='yaw_moment', yaw_gain=10.0, yaw_integral_gain=0.0)
    assert not refusal(feeble, MODULE, tail_heavy)


@pytest.mark.parametrize('norm', [0.0, 0.01, 1.0, 150.0])
def test_the_exponential_is_scipys(norm):
    random = np.random.default_rng(1)
    matrix = random.normal(size=(7, 7))
    matrix -= np.abs(np.linalg.eigvals(matrix)).max() * np.eye(7)
    matrix *= norm / np.abs(matrix).sum(axis=1).max()
    assert gain_margin._exp(matrix) == pytest.approx(expm(matrix), abs=1e-13)
