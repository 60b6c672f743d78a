"""Less side slip or a truer path: what the gains of the thesis buy, beside controllers that know the path."""

import math
from dataclasses import dataclass

import numpy as np

from omni_vehicle_ros.analysis.signals import Array
from omni_vehicle_ros.model import body, plant
from omni_vehicle_ros.model.constants import constants
from omni_vehicle_ros.model.kinematics import Icr, road_steer_angles
from omni_vehicle_ros.model.state import initial_state
from omni_vehicle_ros.parameters import VehicleParameters
from omni_vehicle_ros.wheels import PerWheel, per_wheel

RADIUS, SPEED = 5.0, 15.0 / 3.6
GAINS = tuple(np.round(np.concatenate((np.arange(0.0, 2.0, 0.25), np.arange(2.0, 10.5, 0.5))), 2).tolist())
_LONG_ENOUGH = 8.0
_STEP = 0.001


@dataclass(frozen=True)
class GainCurve:
    """The thesis's turn, R = 5 m at 15 km/h held, under exact proportional slip control with many gains.

    Attributes
    ----------
    shares
        The gain of each wheel, as a share of the largest.
    """

    shares: PerWheel

    def work(self) -> Array:
        """Return the largest gain, the error of the path radius (fraction) and the worst slip [rad], shape (n, 3)."""
        return np.array([(gain, *self.steady(gain)) for gain in GAINS])

    def steady(self, gain: float) -> tuple[float, float]:
        """Return error of the radius and worst slip [rad] after a time that is long for every gain."""
        vehicle = VehicleParameters()
        model, environment = constants(vehicle), body.Environment()
        angles = road_steer_angles(Icr(0.0, RADIUS), vehicle)
        gains = per_wheel(lambda i: gain * self.shares[i])
        rest = (0.0, 0.0, 0.0, 0.0)
        state = plant.advance(
            initial_state(SPEED), angles, rest, rest, environment, model, _LONG_ENOUGH, _STEP,
            constant_speed=True, slip_gain=gains,
        )
        now = body.evaluate(state, body.Inputs(angles, rest, gains), environment, model, constant_speed=True)
        vx, vy, yaw_rate = state[:3].tolist()
        return math.hypot(vx, vy) / yaw_rate / RADIUS - 1.0, max(map(abs, now.side_slip))
