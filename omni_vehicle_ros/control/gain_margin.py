"""How far the controllers are from instability: eigenvalues of their sampled linear loops.

The loop is the linear bicycle at one speed (Abe 2009, ch. 3) with the actuators of the wheel modules, held
set-points between the cycles, and the controller as it is computed. Its margin is the factor by which all
feedback gains may grow before an eigenvalue leaves the unit circle. With the default vehicle, actuators and
gains, a period of 5 ms and 1 .. 30 m/s it is least

    yaw_moment 31 (at 30 m/s),   rear_steering 5.7 (at 1 and 30 m/s),   allocation 9.6 (at 30 m/s)

so that every default is below a third of its limit. The loop of wheel_slip is that of one wheel on a vehicle
that takes its time to answer: side slip depends at once on the steer angle that corrects it, so the loop is no
faster than its actuator. Without integral and derivative its limit, by Nyquist, is 20.5 with the default
actuator (a margin of 4.1), ``(1 + a) / (1 - a)`` with ``a = exp(-period / tau)`` for one without delay, and 1
for an ideal one. Keep (1 + K) period / tau well below 1.
"""

import math
from typing import NamedTuple

import numpy as np

from omni_vehicle_ros.model.linear import linear_bicycle
from omni_vehicle_ros.model.state import Vector
from omni_vehicle_ros.parameters import SideSlipParameters, VehicleParameters, WheelModuleParameters

SEARCH = 1e-3, 1e6
_HALVINGS = 34  # leave 2e-9 of the factor
_TERMS = 18  # of the series of exp for a matrix of norm 1/2: the next one is below 1e-22
_IDEAL = 0.01  # of a cycle: time constant of an actuator that has none
_STABLE = 1.0 + 1e-9  # an integral whose gain is 0 stays where it is


class Linear(NamedTuple):
    """A sampled linear system ``x[k+1] = a x[k] + b u[k]``, ``y[k] = c x[k] + d u[k]``."""

    a: Vector
    b: Vector
    c: Vector
    d: Vector


class Loop(NamedTuple):
    """Feedback ``u = law(-y)`` of a plant."""

    plant: Linear
    law: Linear

    def stable(self, factor: float = 1.0) -> bool:
        """Whether the loop settles with all its gains times a factor."""
        plant, law = self
        loop = np.block(
            [
                [plant.a - factor * plant.b @ law.d @ plant.c, factor * plant.b @ law.c],
                [-law.b @ plant.c, law.a],
            ]
        )
        return float(np.abs(np.linalg.eigvals(loop)).max()) < _STABLE

    def margin(self) -> float:
        """Return the factor on the gains at which the loop begins to oscillate or drift without end.

        It is within 0.001 and a million, the ends of the search; 0.001 if the gains are not the reason.
        """
        low, high = SEARCH
        for _ in range(_HALVINGS):
            middle = math.sqrt(low * high)
            low, high = (middle, high) if self.stable(middle) else (low, middle)
        return low


def motion_loop(
    parameters: SideSlipParameters,
    vehicle: VehicleParameters,
    module: WheelModuleParameters,
    speed: float,
    period: float,
) -> Loop:
    """Return the loop of a controller of motion at a speed.

    Parameters
    ----------
    parameters
        Which controller, yaw_moment, rear_steering or allocation, and its gains.
    vehicle, module
        What is controlled; its actuators, with their lags.
    speed
        Forward speed [m/s], above 0.
    period
        Control period [s].
    """
    bicycle = linear_bicycle(vehicle, speed)
    if parameters.controller == 'yaw_moment':
        moment = np.array([[0.0], [1.0 / vehicle.yaw_inertia]])
        lag = _IDEAL * period if module.ideal_actuators else module.drive_time_constant
        plant = _plant(bicycle.state_matrix, moment, lag, 0.0, period)
        p = parameters
        gains = p.yaw_gain, p.yaw_integral_gain, p.yaw_derivative_gain
        law = _pid_law(gains, p.derivative_time_constant, np.array([[0.0, 1.0]]), period)
    else:
        plant = _plant(bicycle.state_matrix, bicycle.input_matrix, *_steering(module, period), period)
        allocation = parameters.controller == 'allocation'
        law = _allocation_law(parameters, vehicle, speed, period) if allocation else _rear_law(vehicle, speed)
    return Loop(plant._replace(c=plant.c[:2]), law)


def slip_loop(
    gains: tuple[float, float, float], derivative_time_constant: float, module: WheelModuleParameters, period: float
) -> Loop:
    """Return the loop of wheel_slip at one wheel whose own velocity doesn't change.

    Parameters
    ----------
    gains
        Proportional, integral and derivative gain.
    derivative_time_constant, period
        Filter of the derivative, and control period [s].
    module
        The actuator.
    """
    plant = _plant(np.zeros((0, 0)), np.zeros((0, 1)), *_steering(module, period), period)
    return Loop(plant, _pid_law(gains, derivative_time_constant, np.eye(1), period))


def _steering(module: WheelModuleParameters, period: float) -> tuple[float, float]:
    """Return time constant and delay of the steering [s]."""
    return (_IDEAL * period, 0.0) if module.ideal_actuators else (module.steer_time_constant, module.steer_delay)


def _plant(motion: Vector, inputs: Vector, time_constant: float, delay: float, period: float) -> Linear:
    """Return a motion behind actuators with a lag and a delay, from one cycle to the next; it gives both.

    A set-point counts for a period, from its delay on: with delay = (q + f) period the first part f of a
    cycle belongs to the set-point of q + 1 cycles ago.
    """
    states, count = inputs.shape
    size = states + count
    a = np.block([[motion, inputs], [np.zeros((count, states)), -np.eye(count) / time_constant]])
    b = np.vstack([np.zeros((states, count)), np.eye(count) / time_constant])
    cycles = math.floor(delay / period + 1e-9)
    rest = max(delay - cycles * period, 0.0)
    whole, late = _held(a, b, period), _held(a, b, period - rest)
    new, old = late[:, size:], whole[:, size:] - late[:, size:]
    effects = [np.zeros((size, count))] * cycles + [new, old]  # of the set-points of 0, 1, .. cycles ago
    past = count * (cycles + 1)
    state, told = np.zeros((size + past, size + past)), np.zeros((size + past, count))
    state[:size, :size], state[:size, size:] = whole[:, :size], np.hstack(effects[1:])
    state[size:, size:] = np.eye(past, k=-count)
    told[:size], told[size : size + count] = effects[0], np.eye(count)
    return Linear(state, told, np.eye(size, size + past), np.zeros((size, count)))


def _held(a: Vector, b: Vector, duration: float) -> Vector:
    """Return the transition of a system in a time and the effect of an input held so long, side by side."""
    size, count = b.shape
    joined = np.zeros((size + count, size + count))
    joined[:size] = duration * np.hstack([a, b])
    return _exp(joined)[:size]


def _exp(matrix: Vector) -> Vector:
    """Return the exponential of a matrix: by its series for a fraction of it, and squared as often as it takes.

    scipy's would take a node a quarter of a second to import.
    """
    halvings = max(math.frexp(float(np.abs(matrix).sum(axis=1).max()))[1] + 1, 0)
    part = matrix / 2.0**halvings
    power = total = np.eye(len(matrix))
    for n in range(1, _TERMS):
        power = power @ part / n
        total = total + power
    for _ in range(halvings):
        total = total @ total
    return total


def _pid_law(gains: tuple[float, float, float], time_constant: float, pick: Vector, period: float) -> Linear:
    """Return `Pid` on one measurement, which ``pick`` picks; its state: integral, filtered error, last error."""
    gain, integral_gain, derivative_gain = gains
    ramp = time_constant / period
    decay, half = math.exp(-1.0 / ramp), 0.5 * integral_gain * period
    rate = derivative_gain / time_constant
    integral, filtered = np.array([1.0, 0.0, half]), np.array([0.0, decay, ramp - decay * (1.0 + ramp)])
    lead = 1.0 - ramp + decay * ramp
    return Linear(
        np.array([integral, filtered, np.zeros(3)]),
        np.array([[half], [lead], [1.0]]) @ pick,
        np.array([integral - rate * filtered]),
        (gain + half + rate * (1.0 - lead)) * pick,
    )


def _allocation_law(
    parameters: SideSlipParameters, vehicle: VehicleParameters, speed: float, period: float
) -> Linear:
    """Return the PI laws on drift, to both axles, and on yaw rate, to their difference; state: integrals."""
    p = parameters
    errors = np.diag([1.0, vehicle.wheelbase]) / speed
    step = p.allocation_integral_gain * period
    axles = np.array([[1.0, 0.5], [1.0, -0.5]])
    return Linear(np.eye(2), step * errors, axles, axles @ ((p.allocation_gain + step) * errors))


def _rear_law(vehicle: VehicleParameters, speed: float) -> Linear:
    """Return Abe's feedback of the yaw rate to the rear angle; it has no state."""
    couple = (vehicle.cg_to_front_axle - vehicle.cg_to_rear_axle) / speed
    gain = vehicle.mass * speed / (2.0 * vehicle.cornering_stiffness) + couple
    return Linear(np.zeros((0, 0)), np.zeros((0, 2)), np.zeros((2, 0)), np.array([[0.0, 0.0], [0.0, -gain]]))
