"""Bags into which others than the vehicle have spoken: an error of one line, or figures and plots."""

import json
import math

import pytest
from hypothesis import HealthCheck, given, reject, settings
from hypothesis import strategies as st

from omni_vehicle_ros.analysis import compute_metrics
from omni_vehicle_ros.analysis.plots import draw_plots
from omni_vehicle_ros.bags import Bag
from omni_vehicle_ros.bags.memory import MemoryWriter
from omni_vehicle_ros.errors import BagError, MessageError
from omni_vehicle_ros.interface import TOPICS, topic
from omni_vehicle_ros.messages import Forces, Joints, Odometry, Twist, Value, Vector, encode
from omni_vehicle_ros.scenarios import load_scenario
from omni_vehicle_ros.wheels import WHEELS

from ..garbage import values
from .conftest import Motion

Said = list[tuple[str, Value, float]]
READ = [row for row in TOPICS if row.name in (
    'odom', 'imu', 'joint_states', 'tyres/side_slip', 'tyres/force', 'front_left/command', 'driver/icr',
    'driver/speed', 'environment/bank', 'environment/wind', 'environment/friction', '/diagnostics',
)]


class Drive(list[tuple[str, bytes, int]]):
    """Topics, messages and stamps; too many to be printed."""

    def __repr__(self) -> str:
        return 'a drive'


@pytest.fixture(scope='module')
def drive() -> Drive:
    """Return what a vehicle says in 1.2 s."""
    return Drive((name, encode(topic(name).type, value), value.stamp) for name, value in Motion(1.2)._messages())


def bag(drive: list[tuple[str, bytes, int]], others: Said) -> Bag:
    """Return a bag with that, and what others say at some times [s]."""
    writer = MemoryWriter()
    names = {row.name: f'/{row.name.removeprefix("/")}' for row in TOPICS}
    for row in TOPICS:
        writer.add_topic(names[row.name], row.type, row.qos)
    strange = [(name, encode(topic(name).type, value), round(at * 1e9)) for name, value, at in others]
    for name, data, stamp in sorted([*drive, *strange], key=lambda one: one[2]):
        writer.write(names[name], data, stamp)
    return writer.bag('strange')


foreign = st.sampled_from(READ).flatmap(
    lambda row: st.tuples(st.just(row.name), values(row.type), st.floats(0.0, 1.3))
)


@settings(deadline=None, max_examples=15, suppress_health_check=[HealthCheck.too_slow])
@given(others=st.lists(foreign, min_size=1, max_size=3))
def test_whatever_others_say_there_are_figures_or_one_line(drive, others):
    try:
        strange = bag(drive, others)
    except MessageError:  # there is no such message
        reject()
    try:
        found = compute_metrics(strange)
    except BagError as error:
        assert '\n' not in str(error)
    else:
        json.dumps(found, allow_nan=False)


@pytest.mark.parametrize(('name', 'value', 'words'), [
    ('tyres/force', Forces(0, ('fifth',), ((1.0, 2.0, 3.0),)), "tyres/force: a message names 'fifth'"),
    ('tyres/side_slip', Joints(0, WHEELS[:1], (1e300,)), 'tyres/side_slip: position is 1e+300'),
    ('joint_states', Joints(0, ()), ''),
    ('odom', Odometry(0, math.nan, 0.0, 0.0, 1.0, 0.0, 0.0), 'odom: x is nan at 0.500 s'),
    ('odom', Odometry(0, 0.0, 0.0, 0.0, math.inf, 0.0, 0.0), ''),
])
def test_what_the_plant_can_not_have_said_is_named(drive, name, value, words):
    spoiled = bag(drive, [(name, value, 0.5)])
    if words:
        with pytest.raises(BagError) as caught:
            compute_metrics(spoiled)
        assert words in str(caught.value)
    else:
        compute_metrics(spoiled)
        for plot in draw_plots(spoiled, load_scenario('simple_turning')):
            for axes in plot.figure.axes:
                assert all(map(math.isfinite, (*axes.get_xlim(), *axes.get_ylim()))), plot.name


def test_plots_leave_out_what_nobody_can_follow(drive):
    """Commands and environments that the vehicle refuses are in the bag all the same."""
    others: Said = [
        ('driver/speed', Twist(0, math.inf), 0.3), ('driver/speed', Twist(0, math.nan), 0.4),
        ('environment/bank', Vector(0, math.nan, 0.0), 0.5), ('environment/wind', Vector(0, 0.0, -math.inf), 0.6),
        ('environment/friction', Joints(0, ('fifth', *WHEELS), effort=(1.0, math.nan, 1e300, -1.0, 0.5)), 0.7),
        ('front_left/command', Joints(0, ()), 0.1),
        ('front_right/command', Joints(0, ('fifth',), (math.inf,)), 0.8),
    ]
    for plot in draw_plots(bag(drive, others), load_scenario('simple_turning')):
        for axes in plot.figure.axes:
            assert all(map(math.isfinite, (*axes.get_xlim(), *axes.get_ylim()))), plot.name
