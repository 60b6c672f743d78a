"""Messages and sensors that fail, and what their receivers get."""

import math
from dataclasses import dataclass, field

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omni_vehicle_ros.components.component import Output
from omni_vehicle_ros.components.inbox import Inbox
from omni_vehicle_ros.components.message_fault import MessageFault
from omni_vehicle_ros.components.sensor_faults import SensorFaults
from omni_vehicle_ros.faults import Fault, faults_message, make_fault
from omni_vehicle_ros.messages import Imu, Joints, Odometry, Twist, Value

NS = 5_000_000


def through(failure: str, value: float | None = None, count: int = 200) -> list[list[int]]:
    """Return by cycle the stamps of the messages that get through."""
    fault = MessageFault(make_fault('messages/driver/speed', failure, value), 'icr_steering')
    found = []
    for cycle in range(count):
        now = cycle * NS
        values = [*fault.due(now), *fault.take(Twist(cycle, 1.0), now), *fault.due(now)]
        found.append([message.stamp for message in values])
    return found


def test_what_gets_through() -> None:
    assert through('off', count=3) == [[], [], []]
    assert through('duplicated', count=2) == [[0, 0], [1, 1]]
    assert through('reordered', count=4) == [[], [1, 0], [], [3, 2]]
    assert through('delayed', 0.01, count=5) == [[], [], [0], [1], [2]]
    assert through('delayed', 0.0, count=2) == [[0], [1]]


@given(st.floats(0.0, 1.0))
@settings(deadline=None, max_examples=20)
def test_of_those_that_are_lost_at_random_the_share_is_that_of_the_fault(share: float) -> None:
    """Within five standard deviations; the same ones in each run."""
    count = 2000
    passed = sum(map(len, through('intermittent', share, count)))
    assert abs(passed - (1.0 - share) * count) <= 5.0 * math.sqrt(share * (1.0 - share) * count)
    assert through('intermittent', share) == through('intermittent', share)


def test_numbers_that_are_broken_leave_stamp_and_words() -> None:
    (broken,) = MessageFault(Fault('messages/front_left/command', 'garbage'), 'x').take(
        Joints(7, ('a', 'b'), (1.0, 2.0), (), (3.0, 4.0), 'base_link'), 0
    )
    assert (broken.stamp, broken.names, broken.velocity, broken.frame) == (7, ('a', 'b'), (), 'base_link')
    assert all(map(math.isnan, broken.position + broken.effort))


@dataclass
class Listener:
    name: str = '/icr_steering'
    beat: str = 'joint_states'
    sources: tuple[str, ...] = ()
    heard: list[tuple[str, Value]] = field(default_factory=list)

    def receive(self, topic: str, value: Value, now: int) -> None:
        self.heard.append((topic, value))

    def step(self, stamp: int, missing: tuple[str, ...] = ()) -> list[Output]:
        return []


def test_a_fault_holds_for_all_messages_of_its_cycle_and_until_it_is_ok() -> None:
    listener = Listener()
    inbox = Inbox('icr_steering', listener, fault_injection=True)
    inbox.put('driver/speed', Twist(0, 1.0))
    inbox.put('faults', faults_message(0, [make_fault('messages/driver/speed', 'off')]))
    assert inbox.hand_over(0) == ('driver/speed',)
    inbox.put('cmd_vel', Twist(NS, 1.0))
    assert inbox.hand_over(NS) == ('driver/speed',)
    inbox.put('faults', faults_message(2 * NS, [make_fault('messages/driver/speed', 'ok')]))
    inbox.put('driver/speed', Twist(2 * NS, 1.0))
    assert inbox.hand_over(2 * NS) == ()
    assert listener.heard == [('cmd_vel', Twist(NS, 1.0)), ('driver/speed', Twist(2 * NS, 1.0))]


def test_without_fault_injection_faults_are_refused() -> None:
    listener = Listener()
    inbox = Inbox('icr_steering', listener, fault_injection=False)
    inbox.put('faults', faults_message(0, [make_fault('icr_steering', 'off')]))
    inbox.hand_over(0)
    assert not inbox.silent
    assert 'fault_injection is false' in inbox.refused[0]


ODOM = Odometry(0, 1.0, 2.0, 0.3, 4.0, 0.0, 0.5)


def said(fault: Fault, cycles: int = 100) -> list[list[Output]]:
    """Return what a sensor says in each cycle; its x is the number of the cycle."""
    sensors = SensorFaults()
    sensors.fail(fault, 0)
    return [sensors.apply(k * NS, [Output('odom', ODOM._replace(stamp=k * NS, x=float(k)))]) for k in range(cycles)]


def test_sensors_that_fail_keep_their_stamps_and_leave_the_truth_beside() -> None:
    for failure in ('off', 'stuck', 'wrong', 'garbage', 'delayed'):
        for k, ((topic, value), (beside, truth)) in enumerate(said(make_fault('odom', failure))):
            assert (topic, beside, value.stamp, truth.x) == ('odom', 'odom/truth', k * NS, k)
            assert all(map(math.isfinite, value[1:7]))


def test_what_sensors_say() -> None:
    assert {outputs[0].value.x for outputs in said(make_fault('odom', 'stuck'))} == {0.0}
    assert said(make_fault('odom', 'delayed', 0.05))[50][0].value.x == 40.0
    assert said(make_fault('odom', 'wrong', -2.0))[5][0].value == ODOM._replace(
        stamp=5 * NS, x=-10.0, y=-4.0, heading=-0.6, vx=-8.0, vy=0.0, yaw_rate=-1.0
    )
    noise = [outputs[0].value.x for outputs in said(make_fault('odom', 'garbage', 3.0))]
    assert len(set(noise)) == 100
    assert max(map(abs, noise)) <= 3.0
    half = said(make_fault('odom', 'intermittent', 0.1))
    assert [len(outputs) for outputs in half[:40]] == ([2] * 10 + [1] * 10) * 2


@pytest.mark.parametrize(
    'value', [ODOM, Imu(0, 0.1, 0.2, 0.3, 1.0, 2.0, 9.81), Joints(0, ('a',), (1.0,), (2.0,), (3.0,), 'base_link')]
)
def test_a_sensor_that_is_off_says_nothing_but_its_stamp(value: Value) -> None:
    sensors = SensorFaults()
    sensors.fail(Fault('odom', 'off'), 0)
    (_, empty), _ = sensors.apply(0, [Output('odom', value)])
    if isinstance(value, Joints):
        assert empty == value._replace(position=(), velocity=(), effort=())
    else:
        assert empty.frame == ''
        assert not any(number for number in empty if isinstance(number, float))
