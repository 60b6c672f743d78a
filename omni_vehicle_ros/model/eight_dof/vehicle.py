"""The vehicle with 8 degrees of freedom, as those who drive it see it."""

import math

from omni_vehicle_ros.model.dynamics import Environment, Evaluation, Inputs
from omni_vehicle_ros.model.eight_dof.compiled import STATE, kernel, packed_eight_dof
from omni_vehicle_ros.model.eight_dof.constants import EightDofConstants
from omni_vehicle_ros.model.eight_dof.dynamics import evaluation
from omni_vehicle_ros.model.eight_dof.integrate import integrate
from omni_vehicle_ros.model.eight_dof.state import state_vector, state_view
from omni_vehicle_ros.model.packing import found_evaluation, packed_request, vector
from omni_vehicle_ros.model.state import Vector
from omni_vehicle_ros.wheels import PerWheel


def evaluate(
    state: Vector, inputs: Inputs, environment: Environment, constants: EightDofConstants, constant_speed: bool = False
) -> Evaluation:
    """Return slips, forces and loads at one instant; as `body.evaluate`, with a state of shape (20,)."""
    run = kernel('evaluate')
    if run is None:
        return evaluation(state_view(state), inputs, environment, constants, constant_speed)
    request = packed_request(state, inputs, environment, constant_speed)
    run(request, packed_eight_dof(constants))
    return found_evaluation(request)


def advance(
    state: Vector,
    inputs: Inputs,
    steer_rate: PerWheel,
    environment: Environment,
    constants: EightDofConstants,
    duration: float,
    step: float,
    constant_speed: bool = False,
) -> Vector:
    """Return the state after one control cycle, shape (20,).

    Parameters
    ----------
    state
        State at the start; left as it is.
    inputs, steer_rate
        Steer angles [rad], torques over wheel radius [N] and slip gains at the start, and the rates of the
        angles, held over the cycle [rad/s]; fl, fr, rl, rr.
    environment, constants
        What acts on the vehicle, and the vehicle.
    duration
        Length of the cycle [s].
    step
        Integration step [s]; the nearest that divides the cycle without rest is taken, or a shorter one where
        slip or roll could not be followed.
    constant_speed
        Hold vx; torques are left out.
    """
    steps = max(1, round(duration / step), math.ceil(duration / constants.longest_step))
    size = float(duration) / steps
    run = kernel('advance')
    if run is None:
        end = integrate(state_view(state), inputs, steer_rate, environment, constants, steps, size, constant_speed)
        return state_vector(end)
    request = packed_request(state, inputs, environment, constant_speed, steer_rate, steps, size)
    run(request, packed_eight_dof(constants))
    return vector(request)[:STATE]
