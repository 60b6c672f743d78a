"""What a bag says about the types in it, so that readers without ROS understand them."""

from functools import cache
from typing import TYPE_CHECKING, NamedTuple

from omni_vehicle_ros.errors import BagError
from omni_vehicle_ros.messages import VALUE_TYPES

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore

ENCODING = 'ros2msg'


class Schema(NamedTuple):
    """A message type."""

    definition: str
    """Its ``.msg`` text, and after it that of every type in it, as rosbag2 concatenates them."""
    type_hash: str
    """Its RIHS01 hash (REP-2016)."""


@cache
def schema(type_name: str) -> Schema:
    """Return the schema of a type of ``messages``, as ROS 2 Jazzy defines it.

    Raises
    ------
    BagError
        The type is unknown.
    """
    if type_name not in VALUE_TYPES:
        raise BagError(f'type {type_name!r} is unknown; known are {", ".join(sorted(VALUE_TYPES))}')
    definition, _ = _typestore().generate_msgdef(type_name, ros_version=2)
    return Schema(definition, _typestore().hash_rihs01(type_name))


@cache
def _typestore() -> 'Typestore':
    from rosbags.typesys import Stores, get_typestore  # 0.2 s, of use to those who write only

    return get_typestore(Stores.ROS2_JAZZY)
