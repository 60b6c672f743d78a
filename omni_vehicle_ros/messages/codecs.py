"""How each type's value is laid out on the wire."""

import math
from itertools import chain
from typing import Any

import numpy as np

from omni_vehicle_ros.messages.cdr import LayoutBuilder, Reader
from omni_vehicle_ros.messages.codec import SECOND, CachedCodec, Codec, StampedCodec
from omni_vehicle_ros.messages.values import (
    Clock,
    Diagnostics,
    Flag,
    Forces,
    Imu,
    Joints,
    Odometry,
    Point,
    Status,
    Step,
    Text,
    Twist,
    Vector,
    Wrench,
)


def _odometry_to_wire(
    x: float, y: float, heading: float, vx: float, vy: float, yaw_rate: float
) -> tuple[float, ...]:
    half = 0.5 * heading
    return x, y, 0.0, 0.0, math.sin(half), math.cos(half), vx, vy, yaw_rate


def _odometry_from_wire(
    x: float, y: float, qx: float, qy: float, qz: float, qw: float, vx: float, vy: float, yaw_rate: float
) -> tuple[float, ...]:
    return x, y, _heading(qx, qy, qz, qw), vx, vy, yaw_rate


def _imu_to_wire(
    roll: float, heading: float, yaw_rate: float, ax: float, ay: float, az: float
) -> tuple[float, ...]:
    sin_roll, cos_roll = math.sin(0.5 * roll), math.cos(0.5 * roll)
    sin_heading, cos_heading = math.sin(0.5 * heading), math.cos(0.5 * heading)
    return (
        cos_heading * sin_roll, sin_heading * sin_roll, sin_heading * cos_roll, cos_heading * cos_roll,
        yaw_rate, ax, ay, az,
    )


def _imu_from_wire(
    qx: float, qy: float, qz: float, qw: float, yaw_rate: float, ax: float, ay: float, az: float
) -> tuple[float, ...]:
    roll = _atan2(2.0 * (qw * qx + qy * qz), qw * qw - qx * qx - qy * qy + qz * qz)
    return roll, _heading(qx, qy, qz, qw), yaw_rate, ax, ay, az


def _heading(qx: Any, qy: Any, qz: Any, qw: Any) -> Any:
    """Return the yaw angle of the ZYX Euler angles; the quaternion need not have unit length."""
    return _atan2(2.0 * (qw * qz + qx * qy), qw * qw + qx * qx - qy * qy - qz * qz)


def _atan2(y: Any, x: Any) -> Any:
    """Return the angle, also of columns; numpy's own may differ from the other in the last bit."""
    if isinstance(y, float):
        return math.atan2(y, x)
    return np.fromiter(map(math.atan2, y.tolist(), x.tolist()), np.float64, len(y))


class JointsCodec(CachedCodec):
    """Codec of ``JointState``; shape: names, frame, lengths of the three arrays."""

    def encode(self, value: Joints) -> bytes:
        """Return the message."""
        stamp, names, position, velocity, effort, frame = value
        layout = self.layout((names, frame, len(position), len(velocity), len(effort)))
        begin, strings, second, third = layout.runs
        seconds, nanoseconds = divmod(stamp, SECOND)
        return layout.pack(
            begin, seconds, nanoseconds, strings, *position, second, *velocity, third, *effort
        )

    def describe(self, builder: LayoutBuilder, shape: Any) -> None:
        """Add the fields."""
        names, frame, *lengths = shape
        builder.stamp()
        builder.string(frame)
        builder.strings(names)
        for length in lengths:
            builder.doubles(length)

    def read(self, reader: Reader) -> tuple[Any, tuple[Any, ...]]:
        """Return shape and numbers."""
        stamp, frame, names = reader.stamp(), reader.string(), reader.strings()
        arrays = [reader.doubles() for _ in range(3)]
        return (names, frame, *map(len, arrays)), stamp + tuple(chain.from_iterable(arrays))

    def value(self, shape: Any, numbers: Any) -> Joints:
        """Return the value."""
        names, frame, positions, velocities, _ = shape
        second = 2 + positions
        third = second + velocities
        stamp = numbers[0] * SECOND + numbers[1]
        return Joints(stamp, names, numbers[2:second], numbers[second:third], numbers[third:], frame)


class ForcesCodec(CachedCodec):
    """Codec of ``MultiDOFJointState``; shape: names, frame, number of forces."""

    def encode(self, value: Forces) -> bytes:
        """Return the message."""
        stamp, names, forces, frame = value
        layout = self.layout((names, frame, len(forces)))
        seconds, nanoseconds = divmod(stamp, SECOND)
        return layout.pack(layout.runs[0], seconds, nanoseconds, layout.runs[1], *chain.from_iterable(forces))

    def describe(self, builder: LayoutBuilder, shape: Any) -> None:
        """Add the fields, without transforms and twists."""
        names, frame, length = shape
        builder.stamp()
        builder.string(frame)
        builder.strings(names)
        builder.count(0)
        builder.count(0)
        builder.count(length)
        builder.numbers('3d24x' * length)

    def read(self, reader: Reader) -> tuple[Any, tuple[Any, ...]]:
        """Return shape and numbers; transforms and twists are skipped."""
        stamp, frame, names = reader.stamp(), reader.string(), reader.strings()
        reader.numbers('56x' * reader.count(56))
        reader.numbers('48x' * reader.count(48))
        length = reader.count(48)
        return (names, frame, length), stamp + reader.numbers('3d24x' * length)

    def value(self, shape: Any, numbers: Any) -> Forces:
        """Return the value."""
        names, frame, _ = shape
        forces = tuple(zip(numbers[2::3], numbers[3::3], numbers[4::3], strict=True))
        return Forces(numbers[0] * SECOND + numbers[1], names, forces, frame)


class StepCodec(CachedCodec):
    """Codec of ``TimeReference`` without frame; shape: topics."""

    def encode(self, value: Step) -> bytes:
        """Return the message."""
        layout = self.layout(value.topics)
        begin, frame, source = layout.runs
        return layout.pack(begin, *divmod(value.stamp, SECOND), frame, *divmod(value.end, SECOND), source)

    def describe(self, builder: LayoutBuilder, shape: Any) -> None:
        """Add the fields."""
        source = ' '.join(shape)
        if tuple(source.split()) != shape:
            raise ValueError(f'topics {shape!r} must be words')
        builder.stamp()
        builder.string('')
        builder.stamp()
        builder.string(source)

    def read(self, reader: Reader) -> tuple[Any, tuple[Any, ...]]:
        """Return the topics and the numbers."""
        stamp, _ = reader.stamp(), reader.string()
        end, source = reader.stamp(), reader.string()
        return tuple(source.split()), stamp + end

    def value(self, shape: Any, numbers: Any) -> Step:
        """Return the value."""
        seconds, nanoseconds, end_seconds, end_nanoseconds = numbers
        return Step(seconds * SECOND + nanoseconds, end_seconds * SECOND + end_nanoseconds, shape)


class TextCodec(Codec):
    """Codec of ``String``."""

    def encode(self, value: Text) -> bytes:
        """Return the message."""
        builder = LayoutBuilder()
        builder.string(value.data)
        return _pack(builder)

    def decode(self, data: bytes) -> Text:
        """Return the value, or raise MessageError."""
        reader = Reader(data)
        text = reader.string()
        reader.finish()
        return Text(text)


class FlagCodec(Codec):
    """Codec of ``Bool``."""

    def encode(self, value: Flag) -> bytes:
        """Return the message."""
        builder = LayoutBuilder()
        builder.byte(int(value.data))
        return _pack(builder)

    def decode(self, data: bytes) -> Flag:
        """Return the value, or raise MessageError."""
        reader = Reader(data)
        flag = reader.byte()
        reader.finish()
        return Flag(flag != 0)


class DiagnosticsCodec(Codec):
    """Codec of ``DiagnosticArray``."""

    def encode(self, value: Diagnostics) -> bytes:
        """Return the message."""
        builder = LayoutBuilder()
        builder.stamp()
        builder.string(value.frame)
        builder.count(len(value.statuses))
        for status in value.statuses:
            builder.byte(status.level)
            for text in (status.name, status.message, status.hardware_id):
                builder.string(text)
            builder.count(len(status.values))
            for text in chain.from_iterable(status.values):
                builder.string(text)
        return _pack(builder, *divmod(value.stamp, SECOND))

    def decode(self, data: bytes) -> Diagnostics:
        """Return the value, or raise MessageError."""
        reader = Reader(data)
        seconds, nanoseconds = reader.stamp()
        frame = reader.string()
        statuses = tuple(_read_status(reader) for _ in range(reader.count(17)))
        reader.finish()
        return Diagnostics(seconds * SECOND + nanoseconds, statuses, frame)


def _read_status(reader: Reader) -> Status:
    level, name, message, hardware_id = reader.byte(), reader.string(), reader.string(), reader.string()
    values = tuple((reader.string(), reader.string()) for _ in range(reader.count(8)))
    return Status(level, name, message, values, hardware_id)


def _pack(builder: LayoutBuilder, *numbers: int) -> bytes:
    layout = builder.build()
    return layout.pack(layout.runs[0], *numbers, *layout.runs[1:])


CODECS: dict[str, Codec] = {
    'sensor_msgs/msg/JointState': JointsCodec(Joints),
    'sensor_msgs/msg/MultiDOFJointState': ForcesCodec(Forces),
    'sensor_msgs/msg/TimeReference': StepCodec(Step),
    'sensor_msgs/msg/Imu': StampedCodec(
        Imu, '4d72x16xd72x3d72x', to_wire=_imu_to_wire, from_wire=_imu_from_wire
    ),
    'nav_msgs/msg/Odometry': StampedCodec(
        Odometry, '2d8x4d288x2d24xd288x', strings=2, to_wire=_odometry_to_wire, from_wire=_odometry_from_wire
    ),
    'geometry_msgs/msg/PointStamped': StampedCodec(Point, '3d'),
    'geometry_msgs/msg/Vector3Stamped': StampedCodec(Vector, '3d'),
    'geometry_msgs/msg/TwistStamped': StampedCodec(Twist, '2d24xd'),
    'geometry_msgs/msg/WrenchStamped': StampedCodec(Wrench, '6d'),
    'rosgraph_msgs/msg/Clock': StampedCodec(Clock, '', strings=0),
    'std_msgs/msg/String': TextCodec(Text),
    'std_msgs/msg/Bool': FlagCodec(Flag),
    'diagnostic_msgs/msg/DiagnosticArray': DiagnosticsCodec(Diagnostics),
}
"""The codec of each type, by the type's name."""
