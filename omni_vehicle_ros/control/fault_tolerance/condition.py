"""What is known to be wrong with the four wheel modules."""

from enum import Enum
from typing import NamedTuple

from omni_vehicle_ros.wheels import PerWheel

_ZERO: PerWheel = (0.0, 0.0, 0.0, 0.0)


class SteerFault(Enum):
    """What is wrong with the steering of a wheel, as a diagnostic says it."""

    NONE = ''
    STUCK = 'is stuck'
    SLOW = 'is slow'
    OFFSET = 'is off'
    FREE = 'swings freely'
    UNKNOWN = 'does not follow'
    DRIFTING = 'does not follow but drifts with the vehicle'
    ERRATIC = 'goes its own ways'


class DriveFault(Enum):
    """What is wrong with the drive of a wheel, as a diagnostic says it."""

    NONE = ''
    DEAD = 'is dead'
    STUCK = 'is stuck'
    WRONG = 'does not follow'
    LOCKED = 'is locked'


# With these a wheel is told otherwise, or swings where the vehicle goes; the ICR need not be where it points.
_NOT_HELD = {SteerFault.NONE, SteerFault.OFFSET, SteerFault.FREE, SteerFault.DRIFTING}


class WheelCondition(NamedTuple):
    """What is wrong with one wheel module.

    Attributes
    ----------
    steer, drive
        Of its steering and of its drive.
    silent
        Whether the module says nothing.
    """

    steer: SteerFault = SteerFault.NONE
    drive: DriveFault = DriveFault.NONE
    silent: bool = False

    @property
    def steers(self) -> bool:
        """Whether the wheel turns as told."""
        return not self.silent and self.steer is SteerFault.NONE

    @property
    def holds_icr(self) -> bool:
        """Whether the ICR has to be where the wheel points: it does not turn as told, nor can it be told otherwise."""
        return self.silent or self.steer not in _NOT_HELD

    @property
    def pulls_otherwise(self) -> bool:
        """Whether the drive makes another force than it is told."""
        return self.silent or self.drive is not DriveFault.NONE


class Condition(NamedTuple):
    """What is wrong with the four wheel modules; fl, fr, rl, rr.

    Attributes
    ----------
    wheels
        What is wrong with each.
    torque
        That its drive really makes [N m].
    trim
        Mean of what side-slip control has lately added to its set-points [rad].
    offset
        By how much it is off its set-points, where that is constant [rad].
    blind
        Whether joint_states can't be believed: nothing is measured then.
    """

    wheels: tuple[WheelCondition, WheelCondition, WheelCondition, WheelCondition]
    torque: PerWheel = _ZERO
    trim: PerWheel = _ZERO
    offset: PerWheel = _ZERO
    blind: bool = False

    @property
    def sound(self) -> bool:
        """Whether nothing is wrong."""
        return self.wheels == SOUND.wheels and not self.blind


SOUND = Condition((WheelCondition(),) * 4)
