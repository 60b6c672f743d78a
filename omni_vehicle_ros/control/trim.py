"""What all controllers behind the node ``side_slip_controller`` share: what they sense, what they trim."""

from itertools import chain
from typing import NamedTuple, Protocol

from omni_vehicle_ros.control.freshness import NANOSECONDS
from omni_vehicle_ros.control.health import Health
from omni_vehicle_ros.model.kinematics import Twist
from omni_vehicle_ros.wheels import PerWheel

NO_WHEEL: PerWheel = (0.0, 0.0, 0.0, 0.0)

# No number of a vehicle is larger, in SI; also keeps the sums of the controllers finite.
_LARGEST = 1e6

# After a longer gap the past says nothing about the present [s].
_LONGEST_GAP = 0.5


class Sensed(NamedTuple):
    """What a controller knows of one cycle; fl, fr, rl, rr where per wheel.

    Attributes
    ----------
    side_slip
        Side-slip angles of the tyres [rad].
    wheel_speed
        Speeds of the wheels along their headings [m/s].
    steer_angle
        Measured steer angles [rad].
    drive_torque
        Torques of the drives [N m].
    twist
        Motion of the centre of gravity.
    lateral_acceleration
        What an accelerometer at the centre of gravity feels to the left [m/s2].
    commanded
        The motion that the set-points of the cycle belong to.
    """

    side_slip: PerWheel = NO_WHEEL
    wheel_speed: PerWheel = NO_WHEEL
    steer_angle: PerWheel = NO_WHEEL
    drive_torque: PerWheel = NO_WHEEL
    twist: Twist = Twist(0.0, 0.0, 0.0)
    lateral_acceleration: float = 0.0
    commanded: Twist = Twist(0.0, 0.0, 0.0)

    @property
    def usable(self) -> bool:
        """Whether all of it are numbers that a vehicle can have."""
        wheels = chain(self.side_slip, self.wheel_speed, self.steer_angle, self.drive_torque)
        numbers = chain(wheels, self.twist, (self.lateral_acceleration,), self.commanded)
        return all(abs(number) < _LARGEST for number in numbers)


class Trims(NamedTuple):
    """What is added to the set-points of the four wheels: steer angles [rad] and drive torques [N m]."""

    steer_angle: PerWheel = NO_WHEEL
    torque: PerWheel = NO_WHEEL


NO_TRIMS = Trims()


class Controller(Protocol):
    """A control law that trims the set-points of the wheels."""

    def update(self, stamp: int, sensed: Sensed) -> Trims:
        """Return the trims of a cycle.

        Parameters
        ----------
        stamp
            Stamp of the cycle [ns]. The same stamp again gives the same answer; a clock that jumped back, or
            a long gap, starts anew.
        sensed
            What is known of it; where that is no number, the last trims hold.
        """

    @property
    def status(self) -> Health:
        """How the controller is doing, as of the last update."""


class Cycles:
    """Tells how much time lies between two cycles."""

    def __init__(self) -> None:
        self._stamp: int | None = None

    def next(self, stamp: int) -> float | None:
        """Return the time since the last cycle [s]; 0 to start anew, None for the same cycle again."""
        if stamp == self._stamp:
            return None
        dt = 0.0 if self._stamp is None else (stamp - self._stamp) / NANOSECONDS
        self._stamp = stamp
        return dt if 0.0 < dt <= _LONGEST_GAP else 0.0


def fade(speed: float, minimum_speed: float) -> float:
    """Return the share of a trim at a speed [m/s]: all from ``minimum_speed`` on, none below half of that."""
    return min(max(2.0 * abs(speed) / minimum_speed - 1.0, 0.0), 1.0)
