"""What the actuators of a sound wheel module would do with the same set-points."""

import math

from omni_vehicle_ros.control.actuator import DriveActuator, SteerActuator
from omni_vehicle_ros.control.freshness import CommandMonitor
from omni_vehicle_ros.control.wheel_module import NO_TRIM, Trim
from omni_vehicle_ros.parameters import WheelModuleParameters


class ActuatorTwin:
    """Delay, lag, rate limit and range of one wheel, beside the real one.

    Parameters
    ----------
    parameters
        Of the module.
    control_period
        Time from one cycle to the next [s].
    trim_limit
        Largest steer angle that a trim adds [rad].
    angle
        Where the wheel points at first [rad].
    """

    def __init__(
        self, parameters: WheelModuleParameters, control_period: float, trim_limit: float, angle: float
    ) -> None:
        self._steer, self._drive = SteerActuator(parameters, angle), DriveActuator(parameters)
        self._trims = CommandMonitor(parameters.module_timeout)
        self._trim = NO_TRIM
        self._period, self._trim_limit = control_period, trim_limit

    def update(self, stamp: int, steer_angle: float, torque: float, trim: Trim | None) -> tuple[float, float]:
        """Go on by one cycle; return the steer angle at its end [rad] and the mean drive torque over it [N m].

        Parameters
        ----------
        stamp
            Of the cycle [ns].
        steer_angle, torque
            What the module was told [rad], [N m].
        trim
            That of the cycle; None if none has come.
        """
        if trim is not None:
            self._trims.received(trim.stamp, stamp)
            self._trim = trim
        if self._trims.fresh(stamp):
            added, torque = self._trim.steer_angle, torque + self._trim.torque
            if abs(added) > self._trim_limit:
                added = math.copysign(self._trim_limit, added)
            steer_angle += added
        angle, rate = self._steer.update(stamp, steer_angle, self._period)
        return angle + rate * self._period, self._drive.update(torque, self._period)
