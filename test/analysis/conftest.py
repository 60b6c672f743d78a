"""Bags for the analysis, made from numbers: no run is needed."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from omni_vehicle_ros import messages
from omni_vehicle_ros.bags import Bag, BagWriter, open_bag
from omni_vehicle_ros.interface import topic
from omni_vehicle_ros.wheels import WHEELS, drive_joint, steer_joint

PERIOD_NS = 10_000_000
LOAD = 3000.0
JOINTS = (*map(steer_joint, WHEELS), *map(drive_joint, WHEELS))


class Motion:
    """A vehicle that drives a circle, with a side slip of one's own choice; all can be overwritten before `write`."""

    def __init__(self, duration: float = 4.0, radius: float = 10.0, speed: float = 5.0) -> None:
        self.time = np.arange(round(duration * 1e9 / PERIOD_NS) + 1) * PERIOD_NS * 1e-9
        ones = np.ones_like(self.time)
        self.yaw_rate = ones * speed / radius
        self.slipping = np.zeros((len(ones), 4))
        self.heading = self.time * speed / radius
        self.x, self.y = radius * np.sin(self.heading), radius * (1.0 - np.cos(self.heading))
        self.vx, self.vy = ones * speed, ones * 0.0
        self.side_slip = np.outer(ones, [0.04, 0.03, 0.02, 0.01])
        self.friction_use = np.outer(ones, [0.4, 0.3, 0.2, 0.1])
        self.load = np.full((len(ones), 4), LOAD)
        self.friction: list[tuple[float, dict[str, float]]] = [(0.0, dict.fromkeys(WHEELS, 0.9))]
        self.long_force = np.zeros((len(ones), 4))
        self.icr: tuple[float, float] | None = None
        self.steer_angles = (0.1, 0.1, -0.1, -0.1)
        self.bank = 0.0
        self.topics_left_out: set[str] = set()

    def write(self, directory: Path) -> Bag:
        """Write the bag and open it."""
        writer = BagWriter(directory)
        for name, value in self._messages():
            if name not in self.topics_left_out:
                row = topic(name)
                writer.add_topic(f'/{name}', row.type, row.qos)
                writer.write(f'/{name}', messages.encode(row.type, value), value.stamp)
        writer.close()
        return open_bag(directory)

    def _messages(self) -> Any:
        for time, friction in self.friction:
            stamp = round(time * 1e9)
            yield 'environment/friction', messages.Joints(stamp, tuple(friction), effort=tuple(friction.values()))
        yield 'environment/bank', messages.Vector(0, self.bank, 0.0)
        yield 'environment/wind', messages.Vector(0, 0.0, 0.0)
        yield 'driver/speed', messages.Twist(0, 5.0)
        if self.icr is not None:
            yield 'driver/icr', messages.Point(0, *self.icr)
        zeros, numbers = (0.0,) * 8, [*map(tuple, self.side_slip.tolist())]
        for k in range(len(self.time)):
            stamp, vx, r = k * PERIOD_NS, float(self.vx[k]), float(self.yaw_rate[k])
            pose = float(self.x[k]), float(self.y[k]), float(self.heading[k])
            use, loads = tuple(self.friction_use[k].tolist()), self.load[k].tolist()
            yield 'odom', messages.Odometry(stamp, *pose, vx, float(self.vy[k]), r)
            yield 'imu', messages.Imu(stamp, 0.01, pose[2], r, 0.0, vx * r, 9.81)
            rims = tuple((vx + self.slipping[k]).tolist())
            yield 'tyres/side_slip', messages.Joints(stamp, WHEELS, numbers[k], rims, use)
            forces = zip(self.long_force[k].tolist(), loads, strict=True)
            yield 'tyres/force', messages.Forces(stamp, WHEELS, tuple((drive, 100.0, load) for drive, load in forces))
            yield 'joint_states', messages.Joints(stamp, JOINTS, (*self.steer_angles, *zeros[4:]), zeros, zeros)
            yield 'front_left/command', messages.Joints(stamp, JOINTS[::4], (0.1, 0.0), (0.0, 1.0), (0.0, 1.0))


@pytest.fixture
def motion() -> type[Motion]:
    """Return the class of motions, to be made and changed."""
    return Motion


@pytest.fixture
def bag_of(tmp_path: Path) -> Callable[[Motion], Bag]:
    """Write a motion as a bag."""
    return lambda motion: motion.write(tmp_path / 'bag')
