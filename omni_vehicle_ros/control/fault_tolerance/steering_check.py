"""Whether the steering of a wheel does what it should, and if not, in what way it fails."""

import math
from collections import Counter, deque
from collections.abc import Callable, Iterable, Sequence

from omni_vehicle_ros.control.fault_tolerance.condition import SteerFault
from omni_vehicle_ros.control.fault_tolerance.debounce import Debounce

ANGLE_TOLERANCE = 0.03
"""Error of a steer angle that is no fault [rad]."""

LATENESS = 4
"""Cycles by which a module may act late, as it does in real time, and ..."""

LATE = 0.02
"""... time by which it may, be the cycles ever so short [s]."""

SEEN_AFTER = 5
"""Cycles in a row beyond the tolerance that make a fault."""

LIFTED_AFTER = 200
"""Cycles in a row within it that end one."""

# Cycles over which it is looked at how wheel and expectation move; cycles in which a fault settles; cycles after that
# which name it, how many of them have to be of one kind, and how many in which it goes away from where it should.
_WINDOW = 20
_SETTLING = 60
_JURY = 40
_MAJORITY = 24
_AWAY = 20

# Less than this is no motion [rad].
_MOTION = 0.01

# A wheel that turns away by as much in the window drifts with the vehicle, maybe; one that is driven goes faster [rad].
_DRIFT = 0.005, 0.03

# A wheel that swings freely stays that near to the direction in which it moves [rad].
_SWINGING = 0.06

# A share of what is told that is little.
_LITTLE = 0.3


def lateness(control_period: float) -> int:
    """Return by how many cycles a module may act late.

    Parameters
    ----------
    control_period
        Time from one cycle to the next [s].
    """
    return max(LATENESS, math.ceil(LATE / control_period))


def fits(measured: float, expected: Sequence[float], tolerance: float) -> bool:
    """Return whether a measurement is as expected in one of the last cycles, or between two of them.

    Parameters
    ----------
    measured
        In the last cycle.
    expected
        From cycle to cycle; it is the last one in nearly all cases.
    tolerance
        To either side.
    """
    last = expected[-1]
    if last - tolerance <= measured <= last + tolerance:
        return True
    return min(expected) - tolerance <= measured <= max(expected) + tolerance


class SteeringCheck:
    """Compares the steer angle of one wheel with what its actuator should have made of its set-points.

    Parameters
    ----------
    late
        Cycles by which it may act late.

    Notes
    -----
    The angle is right if it is within `ANGLE_TOLERANCE` of what was expected in one of the last ``late`` cycles
    or between two of them. How it fails is told by what moves, the wheel or what is expected of it, in most of the
    latest cycles in which it was wrong, after some in which it settles. Until then a wheel that drifts with the
    vehicle is told from others: who turns about its axle line goes where it goes, and it goes where the vehicle does.
    """

    def __init__(self, late: int = LATENESS) -> None:
        self.fault = SteerFault.NONE
        self.at = 0.0
        """Steer angle at which the fault was named [rad]."""
        self.offset = 0.0
        """Constant error of an `SteerFault.OFFSET`, else 0 [rad]."""
        self._debounce = Debounce(SEEN_AFTER, LIFTED_AFTER)
        self._expected: deque[float] = deque(maxlen=late + 1)
        self._seen: deque[tuple[float, float]] = deque(maxlen=_WINDOW)
        self._votes: deque[SteerFault] = deque(maxlen=_JURY)
        self._right = self._strayed = 0.0
        self._age = 0

    def update(self, measured: float, expected: float, direction: Callable[[], float | None]) -> SteerFault:
        """Take one cycle and return what is wrong.

        Parameters
        ----------
        measured, expected
            Steer angle [rad].
        direction
            Returns in which one the wheel moves over ground [rad]; None if it hardly moves.
        """
        self._expected.append(expected)
        self._seen.append((measured, expected))
        wrong = not fits(measured, self._expected, ANGLE_TOLERANCE)
        if not wrong and not self._debounce.on:
            self._right, self._strayed = measured, 0.0
            self._age = 0
            self._votes.clear()
        if wrong:
            self._age += 1
            self._strayed = max(self._strayed, abs(measured - self._right))
            if self._age > _SETTLING:
                self._votes.append(self._kind(measured, expected, direction()))
        if not self._debounce.update(wrong):
            self.fault = SteerFault.NONE
        elif wrong:
            self._name(measured, expected, direction)
        self.offset = self._mean_error() if self.fault is SteerFault.OFFSET else 0.0
        return self.fault

    def _mean_error(self) -> float:
        errors = self._errors()
        return sum(errors) / len(errors)

    def _errors(self) -> list[float]:
        return [measured - expected for measured, expected in self._seen]

    def _name(self, measured: float, expected: float, direction: Callable[[], float | None]) -> None:
        """Name the fault: at first as any, and by its kind when it has been seen long enough."""
        kind = self.fault
        if kind is SteerFault.NONE:
            drifts = self._drifts(measured, expected) and _along(measured, direction(), ANGLE_TOLERANCE)
            kind = SteerFault.DRIFTING if drifts else SteerFault.UNKNOWN
        elif len(self._votes) == _JURY and kind is not SteerFault.ERRATIC:
            votes = Counter(self._votes)
            most, count = votes.most_common(1)[0]
            if votes[SteerFault.ERRATIC] > _AWAY:
                kind = SteerFault.ERRATIC
            elif count >= _MAJORITY:
                kind = most
        if kind is not self.fault:
            self.fault, self.at = kind, measured

    def _drifts(self, measured: float, expected: float) -> bool:
        """Return whether the wheel turns slowly away from where it should point."""
        moved = measured - self._seen[0][0]
        return _DRIFT[0] < abs(moved) < _DRIFT[1] and moved * (expected - measured) < 0.0

    def _kind(self, measured: float, expected: float, direction: float | None) -> SteerFault:
        moved, told = (_range(numbers) for numbers in zip(*self._seen, strict=True))
        near = _SWINGING if self.fault is SteerFault.FREE else ANGLE_TOLERANCE
        if max(moved, told) < _MOTION and self.fault not in (SteerFault.UNKNOWN, SteerFault.DRIFTING):
            return self.fault
        swings = _along(measured, direction, near)
        if swings and self.fault is SteerFault.FREE:
            return SteerFault.FREE
        if self._strayed < _MOTION:
            return SteerFault.STUCK
        if _range(self._errors()) < max(_LITTLE * told, _MOTION):
            return SteerFault.OFFSET
        if swings:
            return SteerFault.FREE
        if (expected - measured) * (measured - self._seen[0][0]) > 0.0:
            return SteerFault.SLOW
        return SteerFault.STUCK if moved < _MOTION else SteerFault.ERRATIC


def _along(angle: float, direction: float | None, tolerance: float) -> bool:
    """Return whether a wheel points where it moves, or the opposite way."""
    return direction is not None and abs(math.remainder(angle - direction, math.pi)) < tolerance


def _range(numbers: Iterable[float]) -> float:
    numbers = tuple(numbers)
    return max(numbers) - min(numbers)
