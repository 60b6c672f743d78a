"""The emergency stop of the vehicle: a latch, and brake forces that leave the tyres what they need in a turn."""

import math

from omni_vehicle_ros.control.traction import clipped, stopping_forces
from omni_vehicle_ros.model.constants import constants
from omni_vehicle_ros.model.kinematics import Twist
from omni_vehicle_ros.model.loads import vertical_loads
from omni_vehicle_ros.parameters import SteeringParameters, VehicleParameters
from omni_vehicle_ros.wheels import PerWheel, per_wheel

# Share of emergency_deceleration that is braked with at least, whatever the turn needs.
_LEAST = 0.25

# Below this there is no direction of motion to speak of [m/s].
_STILL = 0.05


class EmergencyStop:
    """Latches a stop until three things hold at once.

    It is released when the last word on the topic is false, the vehicle stands, and whoever drives commands to
    stand, freshly: so a vehicle never starts by a release alone.
    """

    def __init__(self) -> None:
        self.engaged = False
        self._asked = False

    def say(self, stop: bool) -> None:
        """Take a message: true stops, false allows a release."""
        self._asked = stop
        self.engaged = self.engaged or stop

    def update(self, *, standing: bool, rest_commanded: bool) -> bool:
        """Return whether the vehicle has to stop.

        Parameters
        ----------
        standing
            Whether the vehicle is at rest.
        rest_commanded
            Whether a fresh command asks for rest.
        """
        if self.engaged and not self._asked and standing and rest_commanded:
            self.engaged = False
        return self.engaged

    @property
    def remedy(self) -> str:
        """What has to be done for a release."""
        return 'say false, then command speed 0' if self._asked else 'command speed 0 at rest to drive on'


class EmergencyBrake:
    """Shares the brake forces of an emergency stop.

    Parameters
    ----------
    vehicle, steering
        Loads and heights; deceleration and the largest force of a wheel.

    Notes
    -----
    Braking and turning together ask emergency_deceleration of the tyres, a = sqrt(A^2 - (v r)^2): the friction
    ellipse of the whole vehicle. Each wheel takes its share of the load, so that all use the same part of their
    grip and none gives way first; the loads are those in the turn, shifted towards the end that leads.
    """

    def __init__(self, vehicle: VehicleParameters, steering: SteeringParameters) -> None:
        self._vehicle, self._steering = vehicle, steering
        self._model = constants(vehicle)
        height = vehicle.roll_arm + 0.5 * (vehicle.front_roll_centre_height + vehicle.rear_roll_centre_height)
        self._transfer = 0.5 * vehicle.mass * height / vehicle.wheelbase

    def forces(self, twist: Twist, speeds: PerWheel) -> PerWheel:
        """Return the brake forces along the wheels' headings [N].

        Parameters
        ----------
        twist
            Measured motion.
        speeds
            Measured wheel speeds [m/s].
        """
        speed = math.hypot(twist.vx, twist.vy)
        most = self._steering.emergency_deceleration
        turning = speed * twist.r
        brake = max(math.sqrt(max(most * most - turning * turning, 0.0)), _LEAST * most)
        loads = self._loads(twist.vx / speed * brake if speed > _STILL else 0.0, twist.vx * twist.r)
        scale = self._vehicle.mass * brake / sum(loads)
        largest = clipped(per_wheel(lambda i: scale * loads[i]), self._steering.maximum_drive_force)
        return stopping_forces(largest, speeds, self._vehicle.mass)

    def _loads(self, deceleration: float, lateral: float) -> PerWheel:
        """Return the loads [N] while the vehicle brakes ahead and turns [m/s2]."""
        shift = self._transfer * deceleration
        front, rear = max(self._model.front_load + shift, 0.0), max(self._model.rear_load - shift, 0.0)
        return vertical_loads(lateral, front, rear, self._model)
