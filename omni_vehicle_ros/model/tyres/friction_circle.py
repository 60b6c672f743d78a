"""The friction circle of a tyre whose traction is given (thesis sec. 4.1)."""

import math


def limited_drive_force(drive_force: float, capacity: float) -> float:
    """Return the traction that a tyre can carry: ``drive_force`` within +-``capacity`` [N]."""
    return max(-capacity, min(capacity, drive_force))


def lateral_capacity(capacity: float, longitudinal_force: float) -> float:
    """Return what the friction circle leaves for the side force [N] (thesis eq. 4.1, 4.2).

    Parameters
    ----------
    capacity
        Friction coefficient times vertical load [N].
    longitudinal_force
        Traction or brake force on the tyre [N]; beyond the capacity nothing is left.
    """
    rest = (capacity - longitudinal_force) * (capacity + longitudinal_force)
    return math.sqrt(max(0.0, rest))
