"""What the actuators of a sound wheel module would do with the same set-points."""

from typing import NamedTuple

from omni_vehicle_ros.control.actuator import DriveActuator, SteerActuator
from omni_vehicle_ros.control.freshness import CommandMonitor, Freshness
from omni_vehicle_ros.control.wheel_module import NO_TRIM, Setpoint, Trim
from omni_vehicle_ros.parameters import WheelModuleParameters


class Expected(NamedTuple):
    """What a sound module has done at the end of a cycle: steer angle [rad], mean drive torque over it [N m]."""

    steer_angle: float
    torque: float


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

    def update(self, command: Setpoint, trim: Trim | None) -> Expected:
        """Go on by the cycle that a command belongs to; ``trim`` is that of the cycle, None if none has come."""
        if trim is not None:
            self._trims.received(trim.stamp, command.stamp)
            self._trim = trim
        fresh = self._trims.state(command.stamp) is Freshness.FRESH
        added, torque = (self._trim.steer_angle, self._trim.torque) if fresh else (0.0, 0.0)
        added = min(max(added, -self._trim_limit), self._trim_limit)
        motion = self._steer.update(command.stamp, command.steer_angle + added, self._period)
        made = self._drive.update(command.torque + torque, self._period)
        return Expected(motion.angle + motion.rate * self._period, made)
