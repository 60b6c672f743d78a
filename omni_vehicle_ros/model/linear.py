"""The linear bicycle: the limit of small slip with load transfer and roll steer off (Abe, ch. 3)."""

from typing import NamedTuple

import numpy as np

from omni_vehicle_ros.errors import ParameterError
from omni_vehicle_ros.model.state import Vector
from omni_vehicle_ros.parameters import VehicleParameters


class LinearBicycle(NamedTuple):
    """d/dt (vy, r) = state_matrix (vy, r) + input_matrix (front, rear steer angle) at one speed.

    ``state_matrix`` and ``input_matrix`` have shape (2, 2); ``yaw_gain`` is the steady yaw rate per front steer
    angle [1/s], ``side_slip_gain`` the steady vy / vx per front steer angle, ``understeer_gradient`` the steer
    angle per lateral acceleration beyond that of a slow turn [rad s2/m].
    """

    state_matrix: Vector
    input_matrix: Vector
    yaw_gain: float
    side_slip_gain: float
    understeer_gradient: float


def linear_bicycle(parameters: VehicleParameters, speed: float) -> LinearBicycle:
    """Linearise the vehicle about driving straight on.

    Parameters
    ----------
    parameters
        The vehicle; both wheels of an axle make one.
    speed
        Forward speed [m/s].

    Raises
    ------
    ParameterError
        The speed is not above 0.
    """
    if not speed > 0.0:
        raise ParameterError(f'speed: {speed!r} m/s must be above 0 to linearise')
    p, lf, lr = parameters, parameters.cg_to_front_axle, parameters.cg_to_rear_axle
    axle = 2.0 * p.cornering_stiffness
    couple = axle * (lf - lr)
    state_matrix = np.array(
        [
            [-2.0 * axle / (p.mass * speed), -couple / (p.mass * speed) - speed],
            [-couple / (p.yaw_inertia * speed), -axle * (lf * lf + lr * lr) / (p.yaw_inertia * speed)],
        ]
    )
    input_matrix = axle * np.array([[1.0, 1.0], [lf, -lr]]) / np.array([[p.mass], [p.yaw_inertia]])
    gradient = p.mass / p.wheelbase * (lr - lf) / axle
    side_speed, yaw_gain = np.linalg.solve(state_matrix, -input_matrix[:, 0]).tolist()
    return LinearBicycle(state_matrix, input_matrix, yaw_gain, side_speed / speed, gradient)
