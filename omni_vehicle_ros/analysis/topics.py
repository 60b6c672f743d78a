"""Topics of a bag as an analysis needs them: never empty, and friction for every wheel at every change."""

from dataclasses import replace
from typing import Protocol

import numpy as np

from omni_vehicle_ros.analysis.signals import Array
from omni_vehicle_ros.bags import Bag, Columns
from omni_vehicle_ros.errors import BagError
from omni_vehicle_ros.parameters import PlantParameters
from omni_vehicle_ros.wheels import WHEELS

MOST_FRICTION = 2.0


class Topics(Protocol):
    """Columns by topic: a bag, or what is left of one."""

    def __contains__(self, topic: str, /) -> bool:
        """Tell whether there is a topic."""

    def __getitem__(self, topic: str, /) -> Columns:
        """Return the columns of a topic."""


def has(bag: Bag, topic: str) -> bool:
    """Tell whether a bag has messages on a topic."""
    return topic in bag and bag.topics[topic].message_count > 0


def columns(bag: Bag, topic: str) -> Columns:
    """Return the messages of a topic; those of a sensor as they should have been, see `truth`.

    Raises
    ------
    BagError
        There are none.
    """
    found = truth(bag, topic)
    if not len(found):
        raise BagError(f'{bag.path} has no messages on {topic}; was the plant running?')
    return found


def truth(bag: Topics, topic: str) -> Columns:
    """Return the messages of a sensor as they should have been: where it failed, the truth from beside it."""
    said, beside = bag[topic], f'{topic}/truth'
    if beside not in bag or not len(bag[beside]):
        return said
    true = bag[beside]
    order = np.argsort(said.stamp_ns, kind='stable')
    places = order[np.searchsorted(said.stamp_ns, true.stamp_ns, sorter=order)]
    arrays = {name: column.copy() for name, column in said.arrays.items()}
    for name, column in true.arrays.items():
        arrays[name][places] = column
    return replace(said, arrays=arrays)


def friction(bag: Bag) -> tuple[Array, Array]:
    """Return the times of change [s], shape (n,), and the friction under each wheel from then on, shape (n, 4).

    A message names some wheels, the others keep theirs; at first it is the default of the plant. What no road has, the
    plant takes no notice of.
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
            if 0.0 < efforts[column] <= MOST_FRICTION:
                now[wheel] = efforts[column]
        rows.append(now)
    return said.stamp, np.array(rows)
