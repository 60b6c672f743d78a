"""The side slips of a turn while the wheels pull or brake, at one speed: what traction does, speed apart."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import root

from omni_vehicle_ros.analysis.signals import Array
from omni_vehicle_ros.model.body import Environment, Inputs, derivative, evaluate
from omni_vehicle_ros.model.constants import constants
from omni_vehicle_ros.model.state import Vector, initial_state
from omni_vehicle_ros.model.steady_turn import steady_turns
from omni_vehicle_ros.thesis.tasks import Run

_VY_AND_R = [1, 2]


@dataclass(frozen=True)
class PulledTurn:
    """A turn in which lateral speed and yaw rate rest, whatever the forward speed does meanwhile.

    Attributes
    ----------
    study
        Whose vehicle and road count.
    radius, speed
        Commanded [m] and forward [m/s], the latter above walking pace.
    forces
        Traction (+) or brake (-) of every wheel [N].
    """

    study: Run
    radius: float
    speed: float
    forces: tuple[float, ...]

    def work(self) -> Array:
        """Return the slips for every force [rad], shape (len(forces), 4); NaN where there is no such turn."""
        return np.array([self.slips(force) for force in self.forces])

    def slips(self, force: float) -> Vector:
        """Return the slips for one force [rad], shape (4,)."""
        scenario = self.study.load()
        plant, model = scenario.plant, constants(scenario.vehicle)
        road = Environment(plant.bank, plant.wind, plant.friction)
        branch = steady_turns(scenario.vehicle, self.radius, road, self.speed)
        turn = branch.turn(self.speed)
        if turn is None:
            return np.full(4, np.nan)
        inputs = Inputs(branch.turning.inputs.steer_angle, (force, force, force, force))

        def state(place: Vector) -> Vector:
            vector = initial_state(self.speed)
            vector[_VY_AND_R] = place
            return vector

        found = root(
            lambda place: derivative(state(place), inputs, road, model)[_VY_AND_R],
            (turn.twist.vy, turn.twist.r),
            tol=1e-12,
        )
        slips = evaluate(state(found.x), inputs, road, model).side_slip
        return np.array(slips) if found.success else np.full(4, np.nan)
