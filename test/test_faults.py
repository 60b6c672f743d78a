"""The vocabulary of faults: what is known is read, and what is not is refused with what is allowed."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omni_vehicle_ros import interface
from omni_vehicle_ros.errors import FaultError
from omni_vehicle_ros.faults import (
    CARRIERS,
    COMPONENTS,
    KINDS,
    OK,
    Fault,
    faults_message,
    kind_of,
    make_fault,
    parse_fault,
    read_faults,
)
from omni_vehicle_ros.messages import Diagnostics, Status, decode, encode

TYPE = 'diagnostic_msgs/msg/DiagnosticArray'


@st.composite
def any_fault(draw: st.DrawFn) -> Fault:
    component = draw(st.sampled_from(COMPONENTS))
    known = KINDS[kind_of(component)]
    failure = draw(st.sampled_from((OK, *known)))
    if failure == OK or known[failure].default is None:
        return make_fault(component, failure)
    return make_fault(component, failure, draw(st.floats(known[failure].low, known[failure].high)))


@given(st.lists(any_fault(), max_size=5))
@settings(deadline=None)
def test_what_is_said_on_the_topic_is_what_is_read(faults: list[Fault]) -> None:
    message = decode(TYPE, encode(TYPE, faults_message(5_000_000, faults)))
    assert read_faults(message) == (faults, [])
    assert all((status.level == 0) == (status.message == OK) for status in message.statuses)


def test_words_are_read() -> None:
    assert parse_fault('front_left/steering', 'slow 0.3') == ('front_left/steering', 'slow', 0.3)
    assert parse_fault('front_left/steering', ' slow ').value == KINDS['steering']['slow'].default
    assert parse_fault('odom', '').failure == parse_fault('odom', 'ok').failure == OK
    assert parse_fault('odom', 'stuck').words == 'stuck'
    assert parse_fault('odom', make_fault('odom', 'wrong', -0.5).words) == ('odom', 'wrong', -0.5)


@pytest.mark.parametrize(
    ('component', 'text', 'answer'),
    [
        ('front_left/steer', 'stuck', "unknown component 'front_left/steer'; did you mean 'front_left/steering'?"),
        ('messages/tyres/force', 'off', "unknown component 'messages/tyres/force'"),
        ('odom', 'stck', "odom: unknown failure 'stck'; did you mean 'stuck'?"),
        ('odom', 'reordered', "odom: unknown failure 'reordered'; allowed: ok, off, stuck"),
        ('odom', 'stuck 3', 'odom: stuck takes no value, but 3 is given; leave it out'),
        ('front_left/steering', 'slow 2', 'front_left/steering: slow: 2 is outside 0.001 .. 1'),
        ('front_left/steering', 'delayed -1', 'front_left/steering: delayed: -1 is outside 0 .. 5 s'),
        ('front_left/steering', 'slow nan', "value 'nan' must be a finite number"),
        ('front_left/steering', 'slow much', "value 'much' must be a finite number"),
        ('front_left/steering', 'slow 0.3 0.4', 'must be a failure and at most one value'),
    ],
)
def test_what_is_refused(component: str, text: str, answer: str) -> None:
    with pytest.raises(FaultError) as caught:
        parse_fault(component, text)
    assert answer in str(caught.value)
    assert '\n' not in str(caught.value)


def test_of_a_message_with_nonsense_the_rest_is_taken() -> None:
    statuses = Status(2, 'odom', 'stuck'), Status(2, 'engine', 'off'), Status(2, 'odom', 'wrong', (('value', 'x'),))
    faults, refused = read_faults(Diagnostics(0, statuses))
    assert faults == [Fault('odom', 'stuck')]
    assert [text.split(' ')[0] for text in refused] == ['unknown', 'odom:']


@pytest.mark.parametrize('component', COMPONENTS)
def test_a_component_belongs_to_nodes_and_knows_its_failures(component: str) -> None:
    assert set(CARRIERS[component]) <= {*interface.NODES} - {interface.RECORDER}
    for name, failure in KINDS[kind_of(component)].items():
        assert failure.text
        assert failure.default is None or failure.low <= failure.default <= failure.high
        assert make_fault(component, name).failure == name


def test_lock_step_itself_can_not_fail() -> None:
    assert not {'messages/driver/step', 'messages/recorder/step', 'messages/ready', 'messages/faults'} & {*COMPONENTS}
