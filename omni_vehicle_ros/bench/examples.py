"""A message for each cyclic topic of the vehicle, as long as in a drive."""

from collections.abc import Iterator
from itertools import islice
from typing import Any

from omni_vehicle_ros.components.joints import JOINT_NAMES
from omni_vehicle_ros.interface import Topic
from omni_vehicle_ros.messages import (
    SECOND,
    VALUE_TYPES,
    Clock,
    Forces,
    Imu,
    Joints,
    Odometry,
    Step,
    Twist,
)
from omni_vehicle_ros.wheels import WHEELS, drive_joint, steer_joint

END = 200 * SECOND
"""Of the scenario [ns]."""


def example(row: Topic, stamp: int, numbers: Iterator[float]) -> Any:
    """Return what a cyclic topic may say at ``stamp`` [ns], with the next of ``numbers`` wherever one belongs."""

    def take(count: int) -> tuple[float, ...]:
        return tuple(islice(numbers, count))

    kind = VALUE_TYPES[row.type]
    if kind is Clock:
        return Clock(stamp)
    if kind is Step:
        return Step(stamp, END, ('driver/icr', 'driver/speed'))
    if kind is Joints:
        names = _joints(row.name)
        size = len(names)
        return Joints(stamp, names, take(size), take(size), take(size), row.frame)
    if kind is Forces:
        return Forces(stamp, WHEELS, tuple((next(numbers), next(numbers), next(numbers)) for _ in WHEELS))
    return {Odometry: Odometry, Imu: Imu, Twist: Twist}[kind](stamp, *take(3 if kind is Twist else 6))


def _joints(topic: str) -> tuple[str, ...]:
    wheel = topic.partition('/')[0]
    if wheel in WHEELS:
        return steer_joint(wheel), drive_joint(wheel)
    return WHEELS if topic.startswith('tyres') else JOINT_NAMES
