"""Values of the types of our topics, as hypothesis makes them: right in type, wrong in all else."""

import math
from typing import Any

from hypothesis import strategies as st

from omni_vehicle_ros import interface
from omni_vehicle_ros.components.joints import JOINT_NAMES, MODULE_NAMES
from omni_vehicle_ros.messages import SECOND, VALUE_TYPES, Joints, Status, encode
from omni_vehicle_ros.wheels import WHEELS

STEP = 5_000_000

stamps = st.one_of(
    st.integers(-(2**31) * SECOND, (2**31 - 1) * SECOND), st.integers(0, 20).map(lambda cycle: cycle * STEP)
)
texts = st.sampled_from(['', 'ok', 'off', 'front_left/steering', 'plant', 'nonsense'])
numbers = st.one_of(st.floats(), st.floats(-10.0, 10.0), st.sampled_from([math.nan, math.inf, -math.inf, 1e300]))


def joints() -> st.SearchStrategy[Joints]:
    """Generate joints whose names and lengths are often right, and whose numbers are often not."""
    names = st.sampled_from([JOINT_NAMES, WHEELS, *MODULE_NAMES.values(), (), ('', 'fifth'), WHEELS[:1] * 8])
    values = st.tuples(numbers, numbers, st.sampled_from([(), (0,), (0, 1), (1, 0), (0, 1, 0, 0), (0, 0, 1, 0) * 2]))
    arrays = values.map(lambda drawn: tuple(drawn[which] for which in drawn[2]))
    return st.builds(Joints, stamps, names, arrays, arrays, arrays, st.sampled_from(['', 'base_link', 'map']))


def values(type_name: str) -> st.SearchStrategy[Any]:
    """Generate values of a type, with stamps that a message can have."""
    kind = VALUE_TYPES[type_name]
    if kind is Joints:
        return joints()
    fields = {'stamp': stamps} if 'stamp' in kind._fields else {}
    if 'end' in kind._fields:
        fields['end'] = stamps
    if 'statuses' in kind._fields:
        fields['statuses'] = st.lists(st.builds(Status, st.integers(0, 255), texts, texts), max_size=2).map(tuple)
    frames = st.sampled_from(['', 'base_link', 'odom', 'map'])
    fields |= {
        name: numbers if hint is float else frames for name, hint in kind.__annotations__.items()
        if hint is float or name in ('frame', 'child_frame')
    }
    return st.builds(kind, **fields)


def encode_at(row: interface.Topic, stamp: int) -> bytes:
    """Return a message of a topic with a stamp of any sign."""
    seconds, nanoseconds = divmod(stamp, SECOND)
    header = seconds.to_bytes(4, 'little', signed=True) + nanoseconds.to_bytes(4, 'little')
    if row.type == 'std_msgs/msg/Bool':
        return encode(row.type, VALUE_TYPES[row.type](data=True))
    blank = {'stamp': 0, 'names': (), 'forces': (), 'statuses': (), 'end': 0, 'data': ''}
    kind = VALUE_TYPES[row.type]
    fields = {name: blank.get(name, 0.0) for name in kind._fields if name not in kind._field_defaults}
    content = encode(row.type, kind(**fields))
    return content[:4] + header + content[12:]
