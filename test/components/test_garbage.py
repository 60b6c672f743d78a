"""Components and the journal take any value of the right type: nothing is raised, and all that is said is finite."""

import math
from functools import cache
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from omni_vehicle_ros import interface
from omni_vehicle_ros.components.icr_steering import IcrSteering
from omni_vehicle_ros.components.inbox import LARGEST, Inbox
from omni_vehicle_ros.components.joints import JOINT_NAMES
from omni_vehicle_ros.components.journal import FOREIGN, SETTLE, Journal
from omni_vehicle_ros.components.plant import Plant
from omni_vehicle_ros.components.side_slip_controller import SideSlipController
from omni_vehicle_ros.components.wheel_module import WheelModule
from omni_vehicle_ros.interface import TOPICS
from omni_vehicle_ros.messages import SECOND, VALUE_TYPES, Joints, encode
from omni_vehicle_ros.parameters import (
    PlantParameters,
    SideSlipParameters,
    SteeringParameters,
    VehicleParameters,
    WheelModuleParameters,
)
from omni_vehicle_ros.wheels import WHEELS

from ..garbage import STEP, encode_at, stamps, values

MODULE = f'{WHEELS[0]}/wheel_module'


def component(role: str) -> Any:
    """Return the component of a node, with the default parameters."""
    vehicle, module = VehicleParameters(), WheelModuleParameters()
    if role == interface.PLANT:
        return Plant(vehicle, PlantParameters())
    if role == interface.ICR_STEERING:
        return IcrSteering(vehicle, SteeringParameters(), module, 0.005, 0.2)
    if role == interface.SIDE_SLIP_CONTROLLER:
        return SideSlipController(SideSlipParameters(), vehicle)
    return WheelModule(WHEELS[0], module, 0.005, 0.2)


@cache
def said(role: str) -> st.SearchStrategy[tuple[str, Any]]:
    """Generate topics that a node subscribes to, with a value."""
    rows = [row for row in TOPICS if role in row.subscribers and row.name not in ('ready', 'recorder/step')]
    return st.sampled_from(rows).flatmap(lambda row: st.tuples(st.just(row.name), values(row.type)))


def finite(value: Any) -> bool:
    """Whether all numbers in a value are finite."""
    if isinstance(value, tuple):
        return all(map(finite, value))
    return not isinstance(value, float) or math.isfinite(value)


@pytest.mark.parametrize(
    'role', [interface.PLANT, interface.ICR_STEERING, interface.SIDE_SLIP_CONTROLLER, MODULE]
)
@settings(deadline=None, max_examples=20, suppress_health_check=[HealthCheck.too_slow])
@given(data=st.data())
def test_garbage_makes_no_node_say_garbage(role, data):
    inbox = Inbox(role, subject := component(role), fault_injection=False)
    outputs = subject.begin() if role == interface.PLANT else []
    for cycle in range(data.draw(st.integers(1, 3))):
        for topic, value in data.draw(st.lists(said(role), max_size=5)):
            inbox.put(topic, value)
        inbox.hand_over(cycle * STEP)
        outputs += subject.step(cycle * STEP)
    for topic, value in outputs:
        assert finite(value), topic
        encode(interface.topic(topic).type, value)


def test_of_a_flood_the_latest_are_kept():
    class Keeper:
        def __init__(self):
            self.seen = []

        def receive(self, topic, value, now):
            self.seen.append(value.stamp)

    inbox = Inbox(interface.ICR_STEERING, keeper := Keeper(), fault_injection=False)
    for number in range(10 * LARGEST):
        inbox.put('driver/speed', VALUE_TYPES['geometry_msgs/msg/TwistStamped'](number, 1.0))
    inbox.hand_over(0)
    assert keeper.seen == list(range(9 * LARGEST, 10 * LARGEST))


class Page:
    """Keeps the times of what a journal writes."""

    def __init__(self):
        self.times = []

    def add_topic(self, name, type_name, qos):
        """Take a topic."""

    def write(self, name, data, log_time):
        """Note a time."""
        self.times.append(log_time)


def beat(stamp: int) -> bytes:
    """Return the message that begins a cycle."""
    return encode('sensor_msgs/msg/JointState', Joints(stamp, JOINT_NAMES))


@settings(deadline=None, max_examples=30)
@given(
    st.lists(st.tuples(st.integers(0, 300), st.sampled_from([row for row in TOPICS if row.recorded]), stamps)),
    st.integers(0, 10**6),
)
def test_foreign_stamps_neither_stop_a_journal_nor_move_its_time(strange, first):
    """What has a stamp of nobody's is written at the time at which it came; nothing waits for its own."""
    journal, first = Journal(page := Page(), '', STEP), first * STEP
    far = [(cycle, row, stamp) for cycle, row, stamp in strange if abs(stamp - first) > 3 * FOREIGN or stamp < 0]
    contents = [(cycle, row, encode_at(row, stamp)) for cycle, row, stamp in far]
    for cycle in range(301):
        journal.add('joint_states', beat(first + cycle * STEP))
        for at, row, content in contents:
            if at == cycle:
                journal.add(row.name, content)
    assert journal.now == first + 300 * STEP
    journal.flush()
    assert len(page.times) == 301 + len(far)
    assert first <= min(page.times) <= max(page.times) == journal.now


def test_a_clock_that_has_gone_on_elsewhere_is_followed():
    """After a gap, as of a plant that was started anew, the journal goes on from there when many beats agree."""
    journal = Journal(Page(), '', STEP)
    for cycle in range(10):
        journal.add('joint_states', beat(cycle * STEP))
    for cycle in range(SETTLE):
        journal.add('joint_states', beat(100 * SECOND + cycle * STEP))
    assert journal.now == 100 * SECOND + (SETTLE - 1) * STEP
