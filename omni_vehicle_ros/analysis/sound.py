"""Whether the plant's topics in a bag hold what a plant says: others may have published on them, too."""

import numpy as np

from omni_vehicle_ros.analysis.signals import Array
from omni_vehicle_ros.analysis.topics import has
from omni_vehicle_ros.bags import Bag
from omni_vehicle_ros.errors import BagError
from omni_vehicle_ros.wheels import WHEELS, drive_joint, steer_joint

LARGEST = 1e9
"""No number about a vehicle is larger, in SI units."""

_TOPICS: dict[str, tuple[str, ...]] = {
    'odom': (),
    'imu': (),
    'joint_states': (*map(steer_joint, WHEELS), *map(drive_joint, WHEELS)),
    'tyres/side_slip': WHEELS,
    'tyres/force': WHEELS,
}
"""The joints that each names."""

_PLACE = 'x', 'y', 'heading'
"""What of odom makes a path; other numbers that are not finite are left out where they matter."""

_REMEDY = 'somebody else than the plant has published there; look at it by: omni_vehicle export'


def check_sound(bag: Bag) -> None:
    """Check that figures and plots of a run can be made.

    Raises
    ------
    BagError
        A message names other joints than the plant does, a number is larger than `LARGEST`, or a place is not finite.
    """
    for topic in _TOPICS:
        if has(bag, topic):
            _check_names(bag, topic)
            for name, column in bag[topic].arrays.items():
                if column.dtype.kind == 'f':
                    _check_numbers(bag, topic, name, column)


def _check_names(bag: Bag, topic: str) -> None:
    names = bag[topic].names
    if names != _TOPICS[topic]:
        strange = ', '.join(map(repr, [name for name in names if name not in _TOPICS[topic]][:3]))
        what = f'a message names {strange}' if strange else 'a message names other joints, or in another order'
        raise BagError(f'{bag.path}: topic {topic}: {what}; {_REMEDY}')


def _check_numbers(bag: Bag, topic: str, name: str, column: Array) -> None:
    finite = np.isfinite(column)
    strange = finite & (np.abs(column) > LARGEST)
    if topic == 'odom' and name in _PLACE:
        strange |= ~finite
    if strange.any():
        row = int(np.argmax(strange.reshape(len(column), -1).any(axis=1)))
        value = column[row][strange[row]].flat[0] if column.ndim > 1 else column[row]
        at = bag[topic].log_time[row]
        raise BagError(
            f'{bag.path}: topic {topic}: {name} is {value:g} at {at:.3f} s, where no more than {LARGEST:g} is '
            f'possible; {_REMEDY}'
        )
