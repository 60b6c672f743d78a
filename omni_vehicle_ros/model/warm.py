"""Compile the physics ahead, so that no run waits for it: ``python -m omni_vehicle_ros.model.warm``."""

from omni_vehicle_ros.model.body import Environment, Inputs, evaluate
from omni_vehicle_ros.model.constants import constants
from omni_vehicle_ros.model.plant import advance
from omni_vehicle_ros.model.state import initial_state
from omni_vehicle_ros.parameters import VehicleParameters

STRAIGHT_ON = (0.0, 0.0, 0.0, 0.0)


def warm() -> None:
    """Call everything that is compiled once; numba keeps the result on disk."""
    model, road, start = constants(VehicleParameters()), Environment(), initial_state()
    evaluate(start, Inputs(STRAIGHT_ON), road, model)
    advance(start, STRAIGHT_ON, STRAIGHT_ON, STRAIGHT_ON, road, model, 0.01, 0.01)


if __name__ == '__main__':
    warm()
