"""Whether joint_states can be of one moving vehicle: they are all that ICR steering sees of it."""

from typing import NamedTuple

from omni_vehicle_ros.control.fault_tolerance.debounce import Debounce
from omni_vehicle_ros.control.fault_tolerance.steering_check import LIFTED_AFTER, SEEN_AFTER
from omni_vehicle_ros.control.freshness import NANOSECONDS
from omni_vehicle_ros.wheels import PerWheel

ROTATION_TOLERANCE = 0.005
"""Difference between what a wheel has turned in a cycle and its speed that is no fault [rad]."""

ANGLE_TOLERANCE = 0.05
"""Step of a steer angle beyond the rate limit that is no fault [rad]."""

# A longer gap between two messages tells nothing [s].
_LONGEST = 0.1


class Joints(NamedTuple):
    """What joint_states say: steer angles and rotations of the wheels [rad], wheel speeds [rad/s]."""

    steer_angle: PerWheel
    rotation: PerWheel
    wheel_speed: PerWheel


class JointCheck:
    """Compares joint_states with those before: a wheel turns by its speed, and steers no faster than it can.

    Parameters
    ----------
    rate_limit
        Of the steering [rad/s]; inf: any.

    Attributes
    ----------
    fits
        Whether the last ones fitted those before, and nobody contradicts.
    """

    def __init__(self, rate_limit: float) -> None:
        self.fits = True
        self._rate = rate_limit
        self._debounce = Debounce(SEEN_AFTER, LIFTED_AFTER)
        self._before: tuple[int, Joints] | None = None

    def update(self, stamp: int, joints: Joints | None, *, contradicted: bool = False) -> bool:
        """Take one cycle and return whether joint_states can't be believed.

        Parameters
        ----------
        stamp
            Of the cycle [ns].
        joints
            What they say; None if that is not a number for each joint.
        contradicted
            Whether those who should know say otherwise.
        """
        before = self._before
        self._before = (stamp, joints) if joints else before
        dt = (stamp - before[0]) / NANOSECONDS if before else 0.0
        comparable = before is not None and 0.0 < dt <= _LONGEST
        self.fits = joints is not None and not (before and comparable and not self._fits(before[1], joints, dt))
        self.fits = self.fits and not contradicted
        return self._debounce.update(not self.fits)

    def _fits(self, before: Joints, now: Joints, dt: float) -> bool:
        largest_step = ANGLE_TOLERANCE + self._rate * dt
        for angle, rotation, speed, last_angle, last_rotation, last_speed in zip(*now, *before, strict=True):
            mean = 0.5 * (speed + last_speed)
            if abs(rotation - last_rotation - mean * dt) > ROTATION_TOLERANCE + 0.2 * abs(mean) * dt:
                return False
            if abs(angle - last_angle) > largest_step:
                return False
        return True
