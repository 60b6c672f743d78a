"""Whether joint_states say the same of the wheels as the wheel modules do of themselves."""

from collections import deque
from collections.abc import Sequence
from typing import NamedTuple

from omni_vehicle_ros.control.fault_tolerance.drive_check import TORQUE_TOLERANCE
from omni_vehicle_ros.control.fault_tolerance.steering_check import ANGLE_TOLERANCE, lateness
from omni_vehicle_ros.control.freshness import NANOSECONDS
from omni_vehicle_ros.wheels import PerWheel

SETTLING = 100
"""Cycles after a gap in which wheels may not yet be where their modules have them."""

# So many wheel modules are not wrong at once.
_MOST = 3


class Word(NamedTuple):
    """What a wheel module says of a cycle: stamp [ns], steer angle at its end [rad], mean drive torque [N m]."""

    stamp: int
    steer_angle: float
    torque: float


class WordCheck:
    """Compares joint_states with the words of the wheel modules.

    Parameters
    ----------
    control_period
        Time from one cycle to the next [s].

    Notes
    -----
    A joint is as its module has it if it is within the tolerances of what that has said of one of the last cycles or
    between two of them, as many as a module may be late by. A single one that is not may be a fault of the module.
    """

    def __init__(self, control_period: float) -> None:
        late = lateness(control_period)
        self._step = round(control_period * NANOSECONDS)
        self._gap = late * self._step
        self._words: list[deque[Word]] = [deque(maxlen=late + 1) for _ in range(4)]
        self._now: int | None = None
        self._settling = 0

    def update(
        self, stamp: int, steer_angle: PerWheel, torque: PerWheel, words: Sequence[Word | None]
    ) -> bool:
        """Take one cycle and return whether most modules contradict joint_states.

        Parameters
        ----------
        stamp
            Of the cycle [ns].
        steer_angle, torque
            By joint_states [rad], [N m].
        words
            The latest of each module. One that is not of the cycle before counts for nothing.
        """
        if self._now is not None and not 0 <= stamp - self._now <= self._gap:
            self._settling = SETTLING
        self._now = stamp
        wrong = 0
        for said, word, angle, made in zip(self._words, words, steer_angle, torque, strict=True):
            if word is None or stamp - word.stamp != self._step:
                said.clear()
                continue
            said.append(word)
            wrong += (
                abs(angle - word.steer_angle) > ANGLE_TOLERANCE or abs(made - word.torque) > TORQUE_TOLERANCE
            ) and not _among(said, angle, made)
        if self._settling:
            self._settling = self._settling - 1 if wrong else 0
            return False
        return wrong >= _MOST


def _among(said: Sequence[Word], angle: float, torque: float) -> bool:
    angles, torques = [word.steer_angle for word in said], [word.torque for word in said]
    return (
        min(angles) - ANGLE_TOLERANCE <= angle <= max(angles) + ANGLE_TOLERANCE
        and min(torques) - TORQUE_TOLERANCE <= torque <= max(torques) + TORQUE_TOLERANCE
    )
