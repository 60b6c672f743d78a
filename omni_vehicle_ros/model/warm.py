"""Compile the physics ahead, so that no run waits for it: ``python -m omni_vehicle_ros.model.warm``."""

from omni_vehicle_ros.model.body import Environment, Inputs, derivative
from omni_vehicle_ros.model.body_model import body_model
from omni_vehicle_ros.model.constants import constants
from omni_vehicle_ros.parameters import VehicleParameters

STRAIGHT_ON = (0.0, 0.0, 0.0, 0.0)
DEFAULT = VehicleParameters()


def warm(vehicle: VehicleParameters = DEFAULT) -> None:
    """Call everything that is compiled for a vehicle once; numba keeps the result on disk.

    Parameters
    ----------
    vehicle
        Its body is compiled, and no other.
    """
    body, inputs, road = body_model(vehicle), Inputs(STRAIGHT_ON), Environment()
    start = body.initial_state(0.0)
    body.evaluate(start, inputs, road)
    body.advance(start, inputs, STRAIGHT_ON, road, 0.01, 0.01)
    if vehicle.body_model == DEFAULT.body_model:
        derivative(start, inputs, road, constants(vehicle))


if __name__ == '__main__':
    warm()
