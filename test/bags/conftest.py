"""A bag with some of everything, and what is in it."""

import math
from typing import NamedTuple

import pytest

from omni_vehicle_ros import interface, messages
from omni_vehicle_ros.bags import BagWriter
from omni_vehicle_ros.messages import encode
from omni_vehicle_ros.wheels import WHEELS

PERIOD = 5_000_000
CYCLES = 240


class Sent(NamedTuple):
    """A message that was written."""

    topic: str
    type_name: str
    stamp: int
    value: tuple
    data: bytes


def drive(namespace=''):
    """Generate the messages of some cycles of a vehicle on a circle."""
    for cycle in range(CYCLES):
        stamp = (cycle + 1) * PERIOD
        angle = 0.02 * cycle
        steer = tuple(0.1 * wheel + 0.001 * cycle for wheel in range(4))
        heading = math.remainder(angle, math.tau)
        values = {
            'odom': messages.Odometry(stamp, math.cos(angle), math.sin(angle), heading, 4.0, 0.1, 4.0),
            'tyres/side_slip': messages.Joints(stamp, WHEELS, steer, (4.0,) * 4, (0.5,) * 4),
            'tyres/force': messages.Forces(stamp, WHEELS, tuple((0.0, angle, 3000.0 + wheel) for wheel in range(4))),
            'joint_states': messages.Joints(stamp, WHEELS, steer, frame='base_link'),
            '/clock': messages.Clock(stamp),
        }
        if cycle % 60 == 0:
            values['environment/friction'] = messages.Joints(stamp, (WHEELS[cycle // 60],), effort=(0.1 + cycle / 600,))
            values['/diagnostics'] = messages.Diagnostics(stamp, (messages.Status(0, 'plant', f'cycle {cycle}'),))
        for name, value in values.items():
            type_name = interface.topic(name).type
            yield Sent(interface.resolve(name, namespace), type_name, stamp, value, encode(type_name, value))


def add_topics(writer, namespace=''):
    """Announce every recorded topic."""
    for row in interface.TOPICS:
        if row.recorded:
            writer.add_topic(interface.resolve(row.name, namespace), row.type, row.qos)


def write_bag(directory, sent, namespace='', **options):
    """Write a bag and close it."""
    with BagWriter(directory, **options) as writer:
        add_topics(writer, namespace)
        for message in sent:
            writer.write(message.topic, message.data, message.stamp)
    return directory


@pytest.fixture(scope='session')
def sent():
    """Return what lies in ``bag``."""
    return list(drive())


@pytest.fixture(scope='session')
def bag(tmp_path_factory, sent):
    """Return the directory of a bag of one vehicle in the root namespace."""
    return write_bag(tmp_path_factory.mktemp('bags') / 'drive', sent)
