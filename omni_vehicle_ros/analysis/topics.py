"""Topics of a bag as an analysis needs them: never empty, and friction for every wheel at every change."""

import numpy as np

from omni_vehicle_ros.analysis.signals import Array
from omni_vehicle_ros.bags import Bag, Columns
from omni_vehicle_ros.errors import BagError
from omni_vehicle_ros.parameters import PlantParameters
from omni_vehicle_ros.wheels import WHEELS


def has(bag: Bag, topic: str) -> bool:
    """Tell whether a bag has messages on a topic."""
    return topic in bag and bag.topics[topic].message_count > 0


def columns(bag: Bag, topic: str) -> Columns:
    """Return the messages of a topic.

    Raises
    ------
    BagError
        There are none.
    """
    found = bag[topic]
    if not len(found):
        raise BagError(f'{bag.path} has no messages on {topic}; was the plant running?')
    return found


def friction(bag: Bag) -> tuple[Array, Array]:
    """Return the times of change [s], shape (n,), and the friction under each wheel from then on, shape (n, 4).

    A message names some wheels, the others keep theirs; at first it is the default of the plant.
    """
    now = np.array(PlantParameters().friction)
    if not has(bag, 'environment/friction'):
        return np.zeros(1), now[np.newaxis]
    said = bag['environment/friction']
    places = [(WHEELS.index(name), said.names.index(name)) for name in WHEELS if name in said.names]
    rows = []
    for efforts in said.effort:
        now = now.copy()
        for wheel, column in places:
            if np.isfinite(efforts[column]):
                now[wheel] = efforts[column]
        rows.append(now)
    return said.stamp, np.array(rows)
