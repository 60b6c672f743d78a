"""Which signals of which topic are followed, and what can't be said without that topic."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from omni_vehicle_ros.analysis.signals import Array
from omni_vehicle_ros.bags import Columns
from omni_vehicle_ros.wheels import WHEELS, drive_joint, steer_joint

STEER_JOINTS, DRIVE_JOINTS = tuple(map(steer_joint, WHEELS)), tuple(map(drive_joint, WHEELS))
OTHER_JOINTS = 8
"""Joints of other vehicles that are followed at most."""


class Trace(NamedTuple):
    """Signals of one topic with one unit.

    ``read`` gives them from the columns, shape (n, k), one column for each of ``labels``.
    """

    name: str
    unit: str
    labels: tuple[str, ...]
    read: Callable[[Columns], Array]


def by_name(columns: Columns, field: str, names: Sequence[str]) -> Array:
    """Return a column of joints in an order of one's own, shape (n, len(names)); NaN for those that are not there."""
    column = columns.arrays[field]
    found = np.full((len(columns), len(names)), np.nan)
    for place, name in enumerate(names):
        if name in columns.names:
            found[:, place] = column[:, columns.names.index(name)]
    return found


def wheel_forces(columns: Columns) -> Array:
    """Return the forces on the wheels in their order [N], shape (n, 4, 3)."""
    found = np.full((len(columns), 4, 3), np.nan)
    for place, name in enumerate(WHEELS):
        if name in columns.names:
            found[:, place] = columns.forces[:, columns.names.index(name)]
    return found


def _plain(name: str, unit: str, *fields: str) -> Trace:
    return Trace(name, unit, fields, lambda columns: np.column_stack([columns.arrays[field] for field in fields]))


def _joints(name: str, unit: str, field: str, names: tuple[str, ...], labels: tuple[str, ...] = WHEELS) -> Trace:
    return Trace(name, unit, labels, lambda columns: by_name(columns, field, names))


def _force(name: str, axis: int) -> Trace:
    return Trace(name, 'N', WHEELS, lambda columns: wheel_forces(columns)[:, :, axis])


def _of_wheel(number: int) -> dict[str, tuple[Trace, ...]]:
    wheel, steer, drive = WHEELS[number], STEER_JOINTS[number : number + 1], DRIVE_JOINTS[number : number + 1]
    return {
        f'{wheel}/command': (
            _joints(f'steer_command.{wheel}', 'rad', 'position', steer, (wheel,)),
            _joints(f'torque_command.{wheel}', 'N m', 'effort', drive, (wheel,)),
        ),
        f'{wheel}/trim': (_joints(f'steer_trim.{wheel}', 'rad', 'position', steer, (wheel,)),),
    }


TYPES = {
    'odom': 'nav_msgs/msg/Odometry',
    'imu': 'sensor_msgs/msg/Imu',
    'joint_states': 'sensor_msgs/msg/JointState',
    'tyres/side_slip': 'sensor_msgs/msg/JointState',
    'tyres/force': 'sensor_msgs/msg/MultiDOFJointState',
    'commanded_twist': 'geometry_msgs/msg/TwistStamped',
    'driver/speed': 'geometry_msgs/msg/TwistStamped',
    'driver/traction': 'geometry_msgs/msg/WrenchStamped',
    'teleop/cmd_vel': 'geometry_msgs/msg/TwistStamped',  # before the one that it ends with
    'cmd_vel': 'geometry_msgs/msg/TwistStamped',
    'environment/bank': 'geometry_msgs/msg/Vector3Stamped',
    'environment/wind': 'geometry_msgs/msg/Vector3Stamped',
    'environment/friction': 'sensor_msgs/msg/JointState',
    '/diagnostics': 'diagnostic_msgs/msg/DiagnosticArray',
    **{f'{wheel}/{what}': 'sensor_msgs/msg/JointState' for wheel in WHEELS for what in ('command', 'trim')},
}
"""The type that a topic must have to be taken for what it is called."""

TRACES: dict[str, tuple[Trace, ...]] = {
    'odom': (_plain('speed', 'm/s', 'vx', 'vy'), _plain('yaw_rate', 'rad/s', 'yaw_rate')),
    'imu': (_plain('acceleration', 'm/s2', 'ax', 'ay'), _plain('roll', 'rad', 'roll')),
    'joint_states': (
        _joints('steer_angle', 'rad', 'position', STEER_JOINTS),
        _joints('steer_rate', 'rad/s', 'velocity', STEER_JOINTS),
        _joints('wheel_speed', 'rad/s', 'velocity', DRIVE_JOINTS),
        _joints('drive_torque', 'N m', 'effort', DRIVE_JOINTS),
    ),
    'tyres/side_slip': (
        _joints('side_slip', 'rad', 'position', WHEELS),
        _joints('friction_use', '1', 'effort', WHEELS),
    ),
    'tyres/force': (_force('load', 2), _force('lateral_force', 1), _force('traction', 0)),
    'commanded_twist': (
        _plain('commanded_twist', 'm/s', 'vx', 'vy'),
        _plain('commanded_yaw_rate', 'rad/s', 'yaw_rate'),
    ),
    'driver/speed': (_plain('driver_speed', 'm/s', 'vx'),),
    'teleop/cmd_vel': (_plain('teleop', 'm/s', 'vx', 'vy'), _plain('teleop_yaw_rate', 'rad/s', 'yaw_rate')),
    'cmd_vel': (_plain('cmd_vel', 'm/s', 'vx', 'vy'), _plain('cmd_vel_yaw_rate', 'rad/s', 'yaw_rate')),
    'environment/bank': (_plain('bank', 'rad', 'x'),),
    'environment/wind': (_plain('wind', 'm/s', 'y'),),
    'environment/friction': (_joints('friction', '1', 'effort', WHEELS),),
    **{topic: traces for number in range(4) for topic, traces in _of_wheel(number).items()},
}
"""The signals of each topic."""

NEEDED_FOR = {
    'odom': 'the path from above, speed and yaw rate',
    'joint_states': 'steer angles and rates, wheel speeds, torques, and the wheels along the path',
    'imu': 'acceleration and roll (the g-g diagram of the body is worked out from odom, if there is one)',
    'tyres/side_slip': 'side slip and friction use',
    'tyres/force': 'loads, lift of wheels, and the g-g diagrams of the tyres',
    'commanded_twist': 'speed and yaw rate against their commands',
    '<wheel>/command': 'steer angles against their commands',
    '/diagnostics': 'what the nodes complain about',
}
"""What is left out of a report without a topic."""


def other_joints(columns: Columns) -> tuple[Trace, ...]:
    """Return the signals of joint_states of a vehicle that is not ours: its first joints."""
    known = (*STEER_JOINTS, *DRIVE_JOINTS)
    names = tuple(name for name in columns.names if name not in known)[:OTHER_JOINTS]
    if not names:
        return ()
    return (
        _joints('joint_position', 'rad', 'position', names, names),
        _joints('joint_velocity', 'rad/s', 'velocity', names, names),
    )
