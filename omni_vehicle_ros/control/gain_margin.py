"""How far the controllers of motion are from instability: eigenvalues of their sampled linear loops.

The loop is the linear bicycle at one speed (Abe 2009, ch. 3) with the actuators of the wheel modules, held
set-points between the cycles, and the controller as it is computed. `gain_margin` is the factor by which all
its feedback gains may grow before an eigenvalue leaves the unit circle. With the default vehicle, actuators
and gains, a period of 5 ms and 1 .. 30 m/s it is least

    yaw_moment 31 (at 30 m/s),   rear_steering 5.7 (at 1 and 30 m/s),   allocation 9.6 (at 30 m/s)

so that every default is below a third of its limit. For wheel_slip see `omni_vehicle_ros.control.stability`.
"""

import math
from typing import NamedTuple

import numpy as np
from scipy.linalg import expm

from omni_vehicle_ros.model.linear import linear_bicycle
from omni_vehicle_ros.model.state import Vector
from omni_vehicle_ros.parameters import SideSlipParameters, VehicleParameters, WheelModuleParameters

SEARCH = 1e-3, 1e6
_HALVINGS = 60
_STABLE = 1.0 + 1e-9  # an integral whose gain is 0 stays where it is


class Linear(NamedTuple):
    """A sampled linear system ``x[k+1] = a x[k] + b u[k]``, ``y[k] = c x[k] + d u[k]``."""

    a: Vector
    b: Vector
    c: Vector
    d: Vector


def gain_margin(
    parameters: SideSlipParameters,
    vehicle: VehicleParameters,
    module: WheelModuleParameters,
    speed: float,
    period: float,
) -> float:
    """Return the factor on the feedback gains at which the loop begins to oscillate or drift without end.

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

    Returns
    -------
    float
        Within 0.001 and a million, the ends of the search.
    """
    bicycle = linear_bicycle(vehicle, speed)
    if parameters.controller == 'yaw_moment':
        moment = np.array([[0.0], [1.0 / vehicle.yaw_inertia]])
        plant = _plant(bicycle.state_matrix, moment, module.drive_time_constant, 0.0, period)
        law = _yaw_law(parameters, period)
    else:
        steering = module.steer_time_constant, module.steer_delay
        plant = _plant(bicycle.state_matrix, bicycle.input_matrix, *steering, period)
        allocation = parameters.controller == 'allocation'
        law = _allocation_law(parameters, vehicle, speed, period) if allocation else _rear_law(vehicle, speed)
    low, high = SEARCH
    for _ in range(_HALVINGS):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if _radius(plant, law, middle) < _STABLE else (low, middle)
    return low


def _plant(motion: Vector, inputs: Vector, time_constant: float, delay: float, period: float) -> Linear:
    """Return the motion (vy, r) behind actuators with a lag and a delay, from one cycle to the next.

    A set-point counts for a period, from its delay on: with delay = (q + f) period the first part f of a
    cycle belongs to the set-point of q + 1 cycles ago.
    """
    count = inputs.shape[1]
    size = 2 + count
    a = np.block([[motion, inputs], [np.zeros((count, 2)), -np.eye(count) / time_constant]])
    b = np.vstack([np.zeros((2, count)), np.eye(count) / time_constant])
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
    return Linear(state, told, np.eye(2, size + past), np.zeros((2, count)))


def _held(a: Vector, b: Vector, duration: float) -> Vector:
    """Return the transition of a system in a time and the effect of an input held so long, side by side."""
    size, count = b.shape
    joined = np.zeros((size + count, size + count))
    joined[:size] = duration * np.hstack([a, b])
    transition: Vector = expm(joined)[:size]
    return transition


def _yaw_law(parameters: SideSlipParameters, period: float) -> Linear:
    """Return `Pid` on the error of the yaw rate; its state: integral, filtered error, last error."""
    p = parameters
    ramp = p.derivative_time_constant / period
    decay, half = math.exp(-1.0 / ramp), 0.5 * p.yaw_integral_gain * period
    rate = p.yaw_derivative_gain / p.derivative_time_constant
    pick = np.array([[0.0, 1.0]])  # the yaw rate of (vy, r)
    integral, filtered = np.array([1.0, 0.0, half]), np.array([0.0, decay, ramp - decay * (1.0 + ramp)])
    lead = 1.0 - ramp + decay * ramp
    return Linear(
        np.array([integral, filtered, np.zeros(3)]),
        np.array([[half], [lead], [1.0]]) @ pick,
        np.array([integral - rate * filtered]),
        (p.yaw_gain + half + rate * (1.0 - lead)) * pick,
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


def _radius(plant: Linear, law: Linear, factor: float) -> float:
    """Return the size of the largest eigenvalue of the loop ``u = factor law(-y)``."""
    loop = np.block(
        [
            [plant.a - factor * plant.b @ law.d @ plant.c, factor * plant.b @ law.c],
            [-law.b @ plant.c, law.a],
        ]
    )
    return float(np.abs(np.linalg.eigvals(loop)).max())
