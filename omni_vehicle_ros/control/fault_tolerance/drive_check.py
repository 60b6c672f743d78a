"""Whether the drive of a wheel makes the torque that it should, and whether its wheel turns at all."""

from collections import deque

from omni_vehicle_ros.control.fault_tolerance.condition import DriveFault
from omni_vehicle_ros.control.fault_tolerance.debounce import Debounce
from omni_vehicle_ros.control.fault_tolerance.steering_check import LATENESS, LIFTED_AFTER, SEEN_AFTER, fits

TORQUE_TOLERANCE = 30.0
"""Error of a drive torque that is no fault [N m]."""

LOCKED_AFTER = 10
"""Cycles in a row in which a wheel stands though the others roll that make it a locked one."""

LOCKED_SPEED = 0.5
"""Speed over ground from which on a wheel has to turn [m/s]."""

STANDS = 0.02
"""Speed below which a wheel stands [m/s]: one that is free to turn is soon faster, whatever the others do on ice."""

# A drive that makes less torque than this makes none, and one whose torque varies less is stuck [N m].
_NO_TORQUE = 1.0


class DriveCheck:
    """Compares the torque of one drive with what it should have made, and its speed with that of the vehicle.

    Parameters
    ----------
    late
        Cycles by which it may act late.

    Notes
    -----
    The torque is right if it is within `TORQUE_TOLERANCE` of what was expected in one of the last ``late`` cycles
    or between two of them.
    """

    def __init__(self, late: int = LATENESS) -> None:
        self.fault = DriveFault.NONE
        self.at = 0.0
        """Torque at which the fault was named [N m]."""
        self._debounce = Debounce(SEEN_AFTER, LIFTED_AFTER)
        self._locked = Debounce(LOCKED_AFTER, LIFTED_AFTER)
        self._expected: deque[float] = deque(maxlen=late + 1)
        self._measured: deque[float] = deque(maxlen=SEEN_AFTER)

    def update(self, measured: float, expected: float, speed: float, over_ground: float) -> DriveFault:
        """Take one cycle and return what is wrong.

        Parameters
        ----------
        measured, expected
            Drive torque [N m].
        speed, over_ground
            Of the wheel as it turns, and of its place along its heading as those that roll tell it [m/s].
        """
        self._expected.append(expected)
        self._measured.append(measured)
        wrong = self._debounce.update(not fits(measured, self._expected, TORQUE_TOLERANCE))
        stands = abs(over_ground) > LOCKED_SPEED and abs(speed) < STANDS
        # A wheel that its brake stops, as it is told, is not a fault.
        told = expected * over_ground < -TORQUE_TOLERANCE * abs(over_ground)
        if self._locked.update(stands and not told):
            kind = DriveFault.LOCKED
        else:
            kind = self._kind() if wrong else DriveFault.NONE
        if kind is not self.fault:
            self.fault, self.at = kind, measured
        return self.fault

    def _kind(self) -> DriveFault:
        low, high = min(self._measured), max(self._measured)
        if max(-low, high) < _NO_TORQUE:
            return DriveFault.DEAD
        return DriveFault.STUCK if high - low < _NO_TORQUE else DriveFault.WRONG
