"""The stamp of a message, straight from its bytes."""

import struct

from omni_vehicle_ros.errors import MessageError

_LITTLE, _BIG = struct.Struct('<iI'), struct.Struct('>iI')


def stamp_of(data: bytes) -> int:
    """Return the stamp [ns] of a message that begins with one: a header, or a clock.

    Raises
    ------
    MessageError
        The message is too short to hold a stamp.
    """
    if len(data) < 12:
        raise MessageError(f'a message of {len(data)} bytes holds no stamp; 12 are needed')
    seconds, nanoseconds = (_LITTLE if data[1] & 1 else _BIG).unpack_from(data, 4)
    return int(seconds * 1_000_000_000 + nanoseconds)


def restamped_now(data: bytes) -> bytes:
    """Return a message that begins with a header, with the stamp 0: to a vehicle that means now.

    Raises
    ------
    MessageError
        The message is too short to hold a stamp.
    """
    stamp_of(data)
    return data[:4] + bytes(8) + data[12:]
