"""The columns of a topic as flat columns: one for each number of each joint, with its unit."""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from omni_vehicle_ros.bags.columns.columns import Columns
from omni_vehicle_ros.interface import TOPICS

AXES = ('x', 'y', 'z')
NANOSECONDS = ('stamp_ns', 'end_ns', 'log_time_ns')

_BY_TYPE = {
    'nav_msgs/msg/Odometry': {'x': 'm', 'y': 'm', 'heading': 'rad', 'vx': 'm/s', 'vy': 'm/s', 'yaw_rate': 'rad/s'},
    'sensor_msgs/msg/Imu': {
        'roll': 'rad', 'heading': 'rad', 'yaw_rate': 'rad/s', 'ax': 'm/s2', 'ay': 'm/s2', 'az': 'm/s2',
    },
    'sensor_msgs/msg/MultiDOFJointState': {'forces': 'N'},
    'geometry_msgs/msg/PointStamped': {'x': 'm', 'y': 'm', 'z': 'm'},
    'geometry_msgs/msg/TwistStamped': {'vx': 'm/s', 'vy': 'm/s', 'yaw_rate': 'rad/s'},
    'geometry_msgs/msg/WrenchStamped': {'fx': 'N', 'fy': 'N', 'fz': 'N', 'tx': 'N m', 'ty': 'N m', 'tz': 'N m'},
}
_JOINTS = {'position': 'rad', 'velocity': 'rad/s', 'effort': 'N m'}  # of ours: others' joints may be prismatic
_BY_TOPIC = {
    'tyres/side_slip': {'velocity': 'm/s', 'effort': '1'},
    'environment/friction': {'position': '1', 'velocity': '1', 'effort': '1'},
    'environment/bank': {'x': 'rad'},
    'environment/wind': {'y': 'm/s'},
}


class FlatColumn(NamedTuple):
    """A column of numbers or texts.

    Attributes
    ----------
    name
        Such as ``position_front_left_steer``.
    unit
        SI, '1' for ratios, '' for texts and what is not known.
    kind
        ``int``, ``float`` or ``text``.
    values
        Shape (n,).
    """

    name: str
    unit: str
    kind: str
    values: Any


def flat_columns(columns: Columns, names: tuple[str, ...]) -> Iterator[FlatColumn]:
    """Give the flat columns of a block of a topic.

    Parameters
    ----------
    columns
        Of the block.
    names
        All joints of the topic, in the order of their columns; NaN where the block does not know one.
    """
    units = _units(columns.topic, columns.type_name)
    for field, column in columns.arrays.items():
        unit = 'ns' if field in NANOSECONDS else 's' if f'{field}_ns' in NANOSECONDS else units.get(field, '')
        if column.ndim > 1:
            yield from _by_joint(field, unit, column, columns.names, names)
        elif column.dtype == object:
            yield FlatColumn(field, '', 'text', [_text(value) for value in column])
        else:
            yield FlatColumn(field, unit, 'int' if field in NANOSECONDS else 'float', column)


def _by_joint(
    field: str, unit: str, column: Any, known: tuple[str, ...], names: tuple[str, ...]
) -> Iterator[FlatColumn]:
    missing = np.full(column.shape[:1] + column.shape[2:], np.nan)
    for name in names:
        values = column[:, known.index(name)] if name in known else missing
        if values.ndim == 1:
            yield FlatColumn(f'{field}_{name}', unit, 'float', values)
        else:
            for axis, one in zip(AXES, values.T, strict=True):
                yield FlatColumn(f'{field}_{name}_{axis}', unit, 'float', one)


def _units(topic: str, type_name: str) -> dict[str, str]:
    """Return the units of the fields; on our own topics more is known than the type says."""
    for row in TOPICS:
        if row.type == type_name and (topic == row.name or topic.endswith(f'/{row.name}')):
            return _BY_TYPE.get(type_name, _JOINTS) | _BY_TOPIC.get(row.name, {})
    return _BY_TYPE.get(type_name, {})


def _text(value: Any) -> str:
    if isinstance(value, str):
        return value
    if value and isinstance(value[0], str):
        return ' '.join(value)
    return '; '.join(f'{status.level} {status.name}: {status.message}' for status in value)
