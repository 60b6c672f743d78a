"""The motion over ground in bounded memory."""

import numpy as np

from omni_vehicle_ros.analysis.signals import Array
from omni_vehicle_ros.analysis.stream.envelope import Times
from omni_vehicle_ros.bags import Columns

POINTS = 4096
"""Poses that are kept at most."""


class Samples:
    """The first sample in each interval of time; the intervals double when there are too many.

    An interval is ``2 ** shift`` ns wide and begins at a multiple of that, so that topics with the same stamps keep the
    same ones, but for the width.
    """

    def __init__(self, width: int, most: int = POINTS) -> None:
        self._shift, self._most = 0, most
        self.times, self.rows = np.empty(0, np.int64), np.empty((0, width))

    def add(self, times: Times, rows: Array) -> None:
        """Take samples: times [ns], shape (n,), and values, shape (n, k)."""
        times, rows = np.concatenate([self.times, times]), np.concatenate([self.rows, rows])
        order = np.argsort(times, kind='stable')
        times, rows = times[order], rows[order]
        while True:
            keys = times >> self._shift
            first = np.diff(keys, prepend=keys[0] - 1) != 0
            if np.count_nonzero(first) <= self._most:
                break
            self._shift += 1
        self.times, self.rows = times[first], rows[first]


class PathTrace:
    """Poses, twists and steer angles along a path, and its length.

    Attributes
    ----------
    length
        [m]
    final
        Position and heading at the end [m, m, rad]; None before any.
    """

    def __init__(self) -> None:
        self.length = 0.0
        self.final: tuple[float, float, float] | None = None
        self._odom, self._angles = Samples(6), Samples(4)

    def add(self, times: Times, odom: Columns) -> None:
        """Take messages of odom, and their times [ns]."""
        x, y = odom.x, odom.y
        if self.final is not None:
            x, y = np.append(self.final[0], x), np.append(self.final[1], y)
        self.length += float(np.nansum(np.hypot(np.diff(x), np.diff(y))))
        self.final = float(odom.x[-1]), float(odom.y[-1]), float(odom.heading[-1])
        rows = np.column_stack([odom.arrays[name] for name in ('x', 'y', 'heading', 'vx', 'vy', 'yaw_rate')])
        self._odom.add(times, rows)

    def add_angles(self, times: Times, angles: Array) -> None:
        """Take steer angles [rad], shape (n, 4), and their times [ns]."""
        self._angles.add(times, angles)

    def columns(self, begin: int) -> dict[str, Columns]:
        """Return what is kept as columns of odom and, if steer angles are known, of joint_states.

        Parameters
        ----------
        begin
            Time that counts as 0 [ns].
        """
        names = ('x', 'y', 'heading', 'vx', 'vy', 'yaw_rate')
        known = np.isfinite(self._odom.rows).all(axis=1)
        odom = {name: self._odom.rows[known, place] for place, name in enumerate(names)}
        found = {'odom': _columns('odom', self._odom.times[known] - begin, odom)}
        if len(self._angles.times):
            joints = {'position': self._angles.rows}
            found['joint_states'] = _columns('joint_states', self._angles.times - begin, joints)
        return found


def _columns(topic: str, times: Times, arrays: dict[str, Array]) -> Columns:
    return Columns(topic, '', (), {'stamp': times * 1e-9, 'stamp_ns': times, **arrays})
