"""Actuators that can fail: what stands for the motors of a wheel, so that the law that drives them knows nothing of it.

Random numbers are those of a seed and of the time since the failure began: a run can be repeated.
"""

from collections import deque
from random import Random

from omni_vehicle_ros.control.actuator import DriveActuator, SteerActuator
from omni_vehicle_ros.control.freshness import NANOSECONDS
from omni_vehicle_ros.faults import OK, Fault
from omni_vehicle_ros.parameters import WheelModuleParameters

RANDOM_PERIOD = NANOSECONDS // 10
"""How long a random set-point holds [ns]."""


def broken_turn(fault: Fault, age: int) -> bool:
    """Whether an intermittent fault is at work: in the first half of each of its periods.

    Parameters
    ----------
    fault
        Its value is the period [s].
    age
        Time since it began [ns].
    """
    period = round(fault.value * NANOSECONDS)
    return 2 * (age % period) < period


def random_set_point(fault: Fault, age: int) -> float:
    """Return a number within +-value of a fault, at an age of it [ns]."""
    return Random(f'{fault.component} {age // RANDOM_PERIOD}').uniform(-fault.value, fault.value)


class FailingSteer:
    """The steering of one wheel, with its faults.

    A wheel whose motor is off is moved by the road, which the plant does; what moves it is measured here only.

    Parameters
    ----------
    parameters
        Of the actuator.

    Attributes
    ----------
    measured
        Steer angle that a sensor sees [rad].
    """

    def __init__(self, parameters: WheelModuleParameters) -> None:
        self.measured = 0.0
        self._actuator = SteerActuator(parameters)
        self._fault = Fault('')
        self._since: int | None = None
        self._held: float | None = None
        self._given: deque[tuple[int, float]] = deque()

    def fail(self, fault: Fault) -> None:
        """Fail so from the next update on, or be ok."""
        self._fault, self._since = fault, None
        self._given.clear()
        self._actuator.slow_to(fault.value if fault.failure == 'slow' else 1.0)

    def rest_at(self, angle: float) -> None:
        """Begin anew at an angle [rad]; see `SteerActuator.rest_at`."""
        self._actuator.rest_at(angle)

    def reach(self, now: int) -> float:
        """Return the steer angle at ``now`` [ns]; see `SteerActuator.reach`."""
        return self._actuator.reach(now) if self._held is None else self._held

    def update(self, now: int, set_point: float, period: float) -> tuple[float, float]:
        """Take a set-point; see `SteerActuator.update`."""
        if self._fault.failure == OK and self._held is None:
            return self._actuator.update(now, set_point, period)
        if self._since is None or now < self._since:
            self._since = now
        if self._stands(now - self._since):
            self._held = self.measured if self._fault.failure == 'off' else self.reach(now)
            self._actuator.rest_at(self._held)
            return self._held, 0.0
        self._held = None
        return self._actuator.update(now, self._misled(now, set_point), period)

    def _stands(self, age: int) -> bool:
        failure = self._fault.failure
        return failure in ('off', 'stuck') or (failure == 'intermittent' and broken_turn(self._fault, age))

    def _misled(self, now: int, set_point: float) -> float:
        """Return the set-point that the actuator goes to instead."""
        failure, value = self._fault.failure, self._fault.value
        if failure == 'wrong':
            return set_point + value
        if failure == 'garbage' and self._since is not None:
            return random_set_point(self._fault, now - self._since)
        if failure == 'delayed':
            return self._late(now, set_point, round(value * NANOSECONDS))
        return set_point

    def _late(self, now: int, set_point: float, delay: int) -> float:
        """Return the set-point of ``delay`` [ns] ago, or the first since the fault began."""
        given = self._given
        given.append((now, set_point))
        while len(given) > 1 and given[1][0] <= now - delay:
            given.popleft()
        return given[0][1]


class FailingDrive:
    """The drive of one wheel, with its faults.

    Parameters
    ----------
    parameters
        Of the actuator.
    """

    def __init__(self, parameters: WheelModuleParameters) -> None:
        self._actuator = DriveActuator(parameters)
        self._limit = parameters.drive_torque_limit
        self._fault = Fault('')
        self._age = 0
        self._last = 0.0

    def fail(self, fault: Fault) -> None:
        """Fail so from the next update on, or be ok."""
        self._fault, self._age = fault, 0
        self._actuator.slow_to(fault.value if fault.failure == 'slow' else 1.0)

    def rest_at(self, torque: float) -> None:
        """Begin anew at a torque [N m]; see `DriveActuator.rest_at`."""
        self._actuator.rest_at(torque)

    def update(self, set_point: float, period: float) -> float:
        """Take a set-point and return the mean torque; see `DriveActuator.update`."""
        if self._fault.failure == OK:
            self._last = self._actuator.update(set_point, period)
            return self._last
        age, self._age = self._age, self._age + round(period * NANOSECONDS)
        self._last = self._failing(age, set_point, period)
        return self._last

    def _failing(self, age: int, set_point: float, period: float) -> float:
        failure, value = self._fault.failure, self._fault.value
        if failure == 'off' or (failure == 'intermittent' and broken_turn(self._fault, age)):
            return self._at_once(0.0)
        if failure == 'stuck':
            return self._at_once(self._last)
        if failure == 'garbage':
            set_point = random_set_point(self._fault, age)
        torque = self._actuator.update(set_point, period)
        return max(-self._limit, min(self._limit, value * torque)) if failure == 'wrong' else torque

    def _at_once(self, torque: float) -> float:
        self._actuator.rest_at(torque)
        return torque
