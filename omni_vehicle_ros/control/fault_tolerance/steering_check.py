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

# A wheel that swings freely stays that near to the direction in which it moves [rad].
_SWINGING = 0.1

# A share of what is compared that is little.
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
    latest cycles in which it was wrong, after some in which it settles.
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
        self._right = 0.0
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
            self._right = measured
            self._age = 0
            self._votes.clear()
        if wrong:
            self._age += 1
            if self._age > _SETTLING:
                self._votes.append(self._kind(measured, expected, direction()))
        if not self._debounce.update(wrong):
            self.fault = SteerFault.NONE
        elif wrong:
            self._name(measured)
        self.offset = self._mean_error() if self.fault is SteerFault.OFFSET else 0.0
        return self.fault

    def _mean_error(self) -> float:
        errors = self._errors()
        return sum(errors) / len(errors)

    def _errors(self) -> list[float]:
        return [measured - expected for measured, expected in self._seen]

    def _name(self, measured: float) -> None:
        """Name the fault: at first as any, and by its kind when it has been seen long enough."""
        kind = self.fault
        if kind is SteerFault.NONE:
            kind = SteerFault.UNKNOWN
        elif len(self._votes) == _JURY and kind is not SteerFault.ERRATIC:
            votes = Counter(self._votes)
            most, count = votes.most_common(1)[0]
            if votes[SteerFault.ERRATIC] > _AWAY:
                kind = SteerFault.ERRATIC
            elif count >= _MAJORITY:
                kind = most
        if kind is not self.fault:
            self.fault, self.at = kind, measured

    def _kind(self, measured: float, expected: float, direction: float | None) -> SteerFault:
        moved, told = (_range(numbers) for numbers in zip(*self._seen, strict=True))
        error = abs(measured - expected)
        near = max(_LITTLE * error, _SWINGING if self.fault is SteerFault.FREE else ANGLE_TOLERANCE)
        if max(moved, told) < _MOTION and self.fault is not SteerFault.UNKNOWN:
            return self.fault
        if moved < max(_LITTLE * told, _MOTION) and abs(measured - self._right) < _LITTLE * error:
            return SteerFault.STUCK
        if _range(self._errors()) < max(_LITTLE * told, _MOTION):
            return SteerFault.OFFSET
        if direction is not None and abs(math.remainder(measured - direction, math.pi)) < near:
            return SteerFault.FREE
        lags = (expected - measured) * (measured - self._seen[0][0]) > 0.0
        return SteerFault.SLOW if lags else SteerFault.ERRATIC


def _range(numbers: Iterable[float]) -> float:
    numbers = tuple(numbers)
    return max(numbers) - min(numbers)
