"""Messages as values and as bytes: the same bytes on every topic and in every bag, with or without ROS.

Nodes publish and take raw bytes, for converting rclpy's message objects costs 5 to 20 times more.
"""

import struct
from typing import Any

from omni_vehicle_ros.errors import MessageError
from omni_vehicle_ros.messages.codec import SECOND
from omni_vehicle_ros.messages.codecs import CODECS
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
    Value,
    Vector,
    Wrench,
)

__all__ = [
    'SECOND',
    'VALUE_TYPES',
    'Clock',
    'Diagnostics',
    'Flag',
    'Forces',
    'Imu',
    'Joints',
    'MessageError',
    'Odometry',
    'Point',
    'Status',
    'Step',
    'Text',
    'Twist',
    'Value',
    'Vector',
    'Wrench',
    'decode',
    'encode',
]

VALUE_TYPES: dict[str, type[Any]] = {name: codec.value_type for name, codec in CODECS.items()}
"""The class of the values of each type, by the type's name."""


def encode(type_name: str, value: Any) -> bytes:
    """Return the message that carries a value, as it goes over the wire and into a bag.

    Parameters
    ----------
    type_name
        Such as ``sensor_msgs/msg/JointState``.
    value
        Of the class ``VALUE_TYPES[type_name]``.

    Raises
    ------
    MessageError
        The type is unknown, or the value doesn't fit: a stamp outside int32 seconds, an infinite angle, a NUL in a
        text, something that is not a number.
    """
    try:
        data = CODECS[type_name].encode(value)
    except KeyError:
        raise _unknown(type_name) from None
    except (struct.error, ValueError, TypeError, AttributeError, OverflowError) as error:
        raise MessageError(f'{type_name}: {value!r} can not be encoded: {error}') from error
    # RTPS carries whole words: with the padding here, what is sent is what arrives.
    return data if len(data) % 4 == 0 else data + bytes(-len(data) % 4)


def decode(type_name: str, data: bytes) -> Any:
    """Return the value that a message carries, in the class ``VALUE_TYPES[type_name]``.

    Parameters
    ----------
    type_name
        Such as ``sensor_msgs/msg/JointState``.
    data
        Header and body in CDR, of either byte order.

    Raises
    ------
    MessageError
        The type is unknown, or the bytes are not such a message.
    """
    try:
        return CODECS[type_name].decode(data)
    except KeyError:
        raise _unknown(type_name) from None
    except MessageError as error:
        raise MessageError(f'{type_name}: {error}') from error


def _unknown(type_name: str) -> MessageError:
    return MessageError(f'type {type_name!r} is unknown; known are {", ".join(sorted(CODECS))}')
