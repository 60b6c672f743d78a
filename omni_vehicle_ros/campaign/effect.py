"""Whether a fault does anything to the motion of the vehicle."""

from dataclasses import replace

import numpy as np

from omni_vehicle_ros.bags import Bag
from omni_vehicle_ros.campaign.checks import true_columns
from omni_vehicle_ros.scenarios import FaultEvent, Scenario
from omni_vehicle_ros.simulation import record

ANGLE = 0.01
"""Difference of a steer angle or the heading that counts as an effect [rad]."""

SPEED = 0.05
"""Difference of the speed along or across that counts as an effect [m/s]."""

PLACE = 0.05
"""Difference of the position that counts as an effect [m]."""


def has_effect(scenario: Scenario, event: FaultEvent) -> bool:
    """Whether a drive with one fault differs from that without any, both offline, by more than the limits above.

    What only wall time feels, such as a node that answers late, has none by this measure.
    """
    return differ(record(replace(scenario, faults=())), record(replace(scenario, faults=(event,))))


def differ(one: Bag, other: Bag) -> bool:
    """Whether the true motions in two bags differ by more than the limits, cycle by cycle."""
    names = ('x', 'y', 'heading', 'vx', 'vy')
    limits = (PLACE, PLACE, ANGLE, SPEED, SPEED, ANGLE)
    motions = []
    for bag in (one, other):
        columns = true_columns(bag, 'odom', *names)[1]
        motions.append([*columns, true_columns(bag, 'joint_states', 'position')[1][0][:, :4]])
    for a, b, limit in zip(*motions, limits, strict=True):
        cycles = min(len(a), len(b))
        if not np.abs(a[:cycles] - b[:cycles]).max() <= limit:
            return True
    return False
