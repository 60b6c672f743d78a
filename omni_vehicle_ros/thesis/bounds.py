"""How little side slip is possible on a given path: the smallest worst slip, found by optimisation.

In a steady turn the tyres have to give the centripetal force, whatever the controller. What it can choose are
four steer angles and four drive forces. The optimum here knows nothing of any controller: it is what one is
measured against.
"""

import math
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from scipy.optimize import minimize

from omni_vehicle_ros.analysis.signals import Array
from omni_vehicle_ros.model import body
from omni_vehicle_ros.model.constants import Constants, constants
from omni_vehicle_ros.model.kinematics import Icr, road_steer_angles
from omni_vehicle_ros.model.state import initial_state
from omni_vehicle_ros.parameters import VehicleParameters
from omni_vehicle_ros.wheels import PerWheel, per_wheel

_STEER_REACH = 0.3  # rad, to either side of the kinematic angle
_FORCE_UNIT = 1000.0  # N, so that all unknowns are of order 1
_SLIP_UNIT = 0.01  # rad
_LARGEST_FORCE = 5.0  # of its unit

TRACTION = ('alike', 'left and right', 'free')
# What of the drive forces may vary: their mean, left against right, front against rear, diagonally.
_PATTERNS = np.array([[1.0, 1.0, 1.0, 1.0], [-1.0, 1.0, -1.0, 1.0], [1.0, 1.0, -1.0, -1.0], [1.0, -1.0, -1.0, 1.0]])
_FREE = (1, 2, 4)


class Bound(NamedTuple):
    """The least worst slip [rad], the four slips [rad] and drive forces [N] with it, and the largest friction use."""

    worst: float
    side_slip: PerWheel
    drive_force: PerWheel
    friction_use: float


@dataclass(frozen=True)
class SlipBound:
    """The least worst side slip of a steady turn on the commanded path, without body slip.

    Attributes
    ----------
    radius, speed
        Of the turn [m, m/s].
    traction
        One of `TRACTION`: all wheels drive alike, just as hard as the speed needs; left and right wheels may drive
        differently; every wheel may drive or brake for itself.
    vehicle
        What turns, all three degrees of freedom in balance.
    """

    radius: float
    speed: float
    traction: str
    vehicle: VehicleParameters = field(default_factory=VehicleParameters)

    def work(self) -> Bound:
        """Find it by sequential quadratic programming; RuntimeError if that fails."""
        model = constants(self.vehicle)
        state = initial_state(self.speed)
        state[2] = self.speed / self.radius
        kinematic = road_steer_angles(Icr(0.0, self.radius), self.vehicle)
        free = _FREE[TRACTION.index(self.traction)]
        start = np.array([*kinematic, *(0.0,) * free, 0.1 / _SLIP_UNIT])
        limits = [(angle - _STEER_REACH, angle + _STEER_REACH) for angle in kinematic]
        limits += [(-_LARGEST_FORCE, _LARGEST_FORCE)] * free + [(0.0, 100.0)]

        def balance(unknown: Array) -> Array:
            rate = body.derivative(state, _inputs(unknown), body.Environment(), model)
            return rate[:3]

        def room(unknown: Array) -> Array:
            slip = np.array(_evaluated(state, unknown, model).side_slip) / _SLIP_UNIT
            return np.concatenate((unknown[-1] - slip, unknown[-1] + slip))

        found = minimize(
            lambda unknown: unknown[-1], start, method='SLSQP', bounds=limits,
            constraints=({'type': 'eq', 'fun': balance}, {'type': 'ineq', 'fun': room}),
            options={'maxiter': 300, 'ftol': 1e-10},
        )
        if not found.success or np.max(np.abs(balance(found.x))) > 1e-6:
            raise RuntimeError(f'no least slip for radius {self.radius:g} m at {self.speed:g} m/s: {found.message}')
        now = _evaluated(state, found.x, model)
        worst = max(map(abs, now.side_slip))
        return Bound(worst, now.side_slip, _inputs(found.x).drive_force, max(now.friction_use))


def _inputs(unknown: Array) -> body.Inputs:
    angles, shares = unknown[:4], unknown[4:-1]
    forces = _FORCE_UNIT * shares @ _PATTERNS[: len(shares)]
    return body.Inputs(per_wheel(lambda i: float(angles[i])), per_wheel(lambda i: float(forces[i])))


def _evaluated(state: Array, unknown: Array, model: Constants) -> body.Evaluation:
    return body.evaluate(state, _inputs(unknown), body.Environment(), model)


def linear_bounds(vehicle: VehicleParameters, radius: float, speed: float) -> tuple[float, float, float]:
    """Return the mean slip of the front axle, of the rear axle and of all four tyres [rad], by the force balance.

    Linear tyres, small steer angles: an axle carries its share of m v^2 / R (Abe 2009, ch. 3).

    Parameters
    ----------
    vehicle
        What turns.
    radius, speed
        Of the turn [m, m/s].
    """
    force = vehicle.mass * speed * speed / radius
    front = force * vehicle.cg_to_rear_axle / vehicle.wheelbase
    shares = front / 2.0, (force - front) / 2.0, force / 4.0
    return tuple(math.atan(share / vehicle.cornering_stiffness) for share in shares)  # type: ignore[return-value]
