"""What is asked of the grip, as a g-g diagram: how often which force along and across."""

import numpy as np
import numpy.typing as npt

from omni_vehicle_ros.analysis.signals import Array
from omni_vehicle_ros.analysis.stream.envelope import Times

GRAVITY = 9.81
REACH = 1.2
CELLS = 61


class GripMap:
    """Counts pairs of numbers in square cells over +-`REACH`; what is beyond counts in the outermost cells.

    Attributes
    ----------
    counts
        Along, across; shape (CELLS, CELLS).
    largest
        Largest distance from 0.
    """

    def __init__(self) -> None:
        self.counts = np.zeros((CELLS, CELLS), np.int64)
        self.largest = 0.0

    def add(self, along: Array, across: Array) -> None:
        """Take pairs, shape (n,) each; what is not finite is left out."""
        known = np.isfinite(along) & np.isfinite(across)
        if not known.any():
            return
        self.largest = max(self.largest, float(np.max(np.hypot(along[known], across[known]))))
        np.add.at(self.counts, (_cell(along[known]), _cell(across[known])), 1)

    def cells(self) -> tuple[Array, Array, Array]:
        """Return the middle of each cell that was met, along and across, and its share of the time."""
        rows, columns = np.nonzero(self.counts)
        shares: Array = self.counts[rows, columns] / max(int(self.counts.sum()), 1)
        return _middle(rows), _middle(columns), shares


def _cell(values: Array) -> npt.NDArray[np.int64]:
    return np.clip((values + REACH) / (2.0 * REACH) * CELLS, 0, CELLS - 1).astype(np.int64)


def _middle(cells: npt.NDArray[np.int64]) -> Array:
    found: Array = (cells + 0.5) / CELLS * 2.0 * REACH - REACH
    return found


class BodyMotion:
    """Works out the acceleration of the body from its twist, for a bag without an IMU."""

    def __init__(self) -> None:
        self.grip = GripMap()
        self._last = np.empty((0, 4))

    def add(self, times: Times, vx: Array, vy: Array, yaw_rate: Array) -> None:
        """Take times [ns], speeds ahead and to the left [m/s] and yaw rates [rad/s], shape (n,)."""
        rows = np.concatenate([self._last, np.column_stack([times * 1e-9, vx, vy, yaw_rate])])
        self._last = rows[-1:]
        step = np.diff(rows[:, 0])
        step = np.where(step > 0.0, step, np.nan)
        vx, vy, rate = (0.5 * (rows[1:, i] + rows[:-1, i]) for i in (1, 2, 3))
        along, across = np.diff(rows[:, 1]) / step - rate * vy, np.diff(rows[:, 2]) / step + rate * vx
        self.grip.add(along / GRAVITY, across / GRAVITY)


def tyre_use(forces: Array, friction: Array) -> tuple[Array, Array]:
    """Return how much of its grip each tyre uses along and across: force over friction times load.

    Parameters
    ----------
    forces
        In the frame of each wheel [N], shape (n, 4, 3): along, to the left, load.
    friction
        Shape (n, 4).

    Returns
    -------
    tuple of ndarray
        Shape (n, 4) each; NaN without load.
    """
    grip = friction * forces[:, :, 2]
    grip = np.where(grip > 0.0, grip, np.nan)
    return forces[:, :, 0] / grip, forces[:, :, 1] / grip
