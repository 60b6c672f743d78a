"""Forces and motion of the vehicle at one instant."""

import numpy as np

from omni_vehicle_ros.model.compiled import kernel
from omni_vehicle_ros.model.constants import Constants
from omni_vehicle_ros.model.dynamics import Environment, Evaluation, Inputs, evaluation, state_rate
from omni_vehicle_ros.model.packing import STATE, found_evaluation, packed_constants, packed_request, vector
from omni_vehicle_ros.model.state import Vector, state_view

__all__ = ['Environment', 'Evaluation', 'Inputs', 'derivative', 'evaluate']


def evaluate(
    state: Vector, inputs: Inputs, environment: Environment, constants: Constants, constant_speed: bool = False
) -> Evaluation:
    """Return slips, forces and loads at one instant.

    Parameters
    ----------
    state
        State vector, shape (10,); see `State`.
    inputs, environment, constants
        What the wheels do, what acts on the vehicle, and the vehicle.
    constant_speed
        The 2-degree-of-freedom model: drive forces are left out.
    """
    run = kernel('evaluate')
    if run is None:
        return evaluation(state_view(state), inputs, environment, constants, constant_speed)
    request = packed_request(state, inputs, environment, constant_speed)
    run(request, packed_constants(constants))
    return found_evaluation(request)


def derivative(
    state: Vector, inputs: Inputs, environment: Environment, constants: Constants, constant_speed: bool = False
) -> Vector:
    """Return the time derivative of the state, shape (10,) (thesis B.9, B.10).

    Parameters
    ----------
    state, inputs, environment, constants
        As in `evaluate`.
    constant_speed
        Hold vx and leave out the drive forces (thesis sec. 3.1) instead of integrating vx.
    """
    run = kernel('derivative')
    if run is None:
        return np.array(state_rate(state_view(state), inputs, environment, constants, constant_speed))
    request = packed_request(state, inputs, environment, constant_speed)
    run(request, packed_constants(constants))
    return vector(request)[:STATE]
