"""Joint states of the whole vehicle and of one wheel module, to and from per-wheel values."""

import math
from typing import NamedTuple

from omni_vehicle_ros.messages import Joints
from omni_vehicle_ros.wheels import WHEELS, PerWheel, drive_joint, steer_joint

JOINT_NAMES = tuple(steer_joint(wheel) for wheel in WHEELS) + tuple(drive_joint(wheel) for wheel in WHEELS)
MODULE_NAMES: dict[str, tuple[str, str]] = {wheel: (steer_joint(wheel), drive_joint(wheel)) for wheel in WHEELS}
ZEROS: PerWheel = (0.0, 0.0, 0.0, 0.0)


class VehicleJoints(NamedTuple):
    """Steering and drive of all four wheels: angles [rad], rates and wheel speeds [rad/s], torques [N m]."""

    steer_angle: PerWheel = ZEROS
    steer_rate: PerWheel = ZEROS
    rotation: PerWheel = ZEROS
    wheel_speed: PerWheel = ZEROS
    torque: PerWheel = ZEROS

    def message(self, stamp: int, frame: str) -> Joints:
        """Return the message for ``joint_states``."""
        return Joints(
            stamp,
            JOINT_NAMES,
            self.steer_angle + self.rotation,
            self.steer_rate + self.wheel_speed,
            ZEROS + self.torque,
            frame,
        )


def vehicle_joints(value: Joints) -> VehicleJoints | None:
    """Read ``joint_states``; None where joints are missing or a number is not finite."""
    if value.names != JOINT_NAMES:
        value = _sorted(value)
    if (
        len(value.position) != 8
        or len(value.velocity) != 8
        or not all(map(math.isfinite, value.position + value.velocity))
    ):
        return None
    position, velocity = value.position, value.velocity
    effort = value.effort if len(value.effort) == 8 else ZEROS + ZEROS
    return VehicleJoints(position[:4], velocity[:4], position[4:], velocity[4:], effort[4:])


def wheel_joints(value: Joints, wheel: int) -> tuple[float, float] | None:
    """Read steer angle [rad] and speed [rad/s] of one wheel from ``joint_states``; None as in `vehicle_joints`."""
    if value.names != JOINT_NAMES or len(value.position) != 8 or len(value.velocity) != 8:
        joints = vehicle_joints(value)
        return None if joints is None else (joints.steer_angle[wheel], joints.wheel_speed[wheel])
    angle, speed = value.position[wheel], value.velocity[4 + wheel]
    return (angle, speed) if math.isfinite(angle + speed) else None


def _sorted(value: Joints) -> Joints:
    """Bring joints of another order into ours; empty where one is missing."""
    index = {name: i for i, name in enumerate(value.names)}
    lengths = {len(value.names), len(value.position), len(value.velocity)}
    if not all(name in index for name in JOINT_NAMES) or len(lengths) != 1:
        return value._replace(position=(), velocity=())
    order = [index[name] for name in JOINT_NAMES]
    effort = tuple(value.effort[i] for i in order) if len(value.effort) == len(value.names) else ()
    return value._replace(
        names=JOINT_NAMES,
        position=tuple(value.position[i] for i in order),
        velocity=tuple(value.velocity[i] for i in order),
        effort=effort,
    )


def module_joints(
    wheel: str, stamp: int, steer_angle: float, steer_rate: float, wheel_speed: float, torque: float
) -> Joints:
    """Return the message of one module [rad, rad/s, rad/s, N m]."""
    return Joints(stamp, MODULE_NAMES[wheel], (steer_angle, 0.0), (steer_rate, wheel_speed), (0.0, torque))
