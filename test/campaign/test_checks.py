"""What the checks of a campaign find in recordings that are made to break them, and in sound ones."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from omni_vehicle_ros.analysis.troubles import Trouble
from omni_vehicle_ros.bags import Bag, RecordedMessage
from omni_vehicle_ros.campaign.checks import incomplete, marks, named_after, not_finite, steering_excess, true_columns
from omni_vehicle_ros.campaign.draw import draw
from omni_vehicle_ros.campaign.effect import has_effect
from omni_vehicle_ros.campaign.judge import Finding, Verdict, judge
from omni_vehicle_ros.campaign.store import Campaign, Request, read_before, row, write
from omni_vehicle_ros.campaign.tables import page
from omni_vehicle_ros.campaign.trial import Trial
from omni_vehicle_ros.errors import RunError
from omni_vehicle_ros.faults import make_fault
from omni_vehicle_ros.messages import Point, encode
from omni_vehicle_ros.scenarios import FaultEvent, Scenario
from omni_vehicle_ros.scenarios.scenario import make_scenario
from omni_vehicle_ros.simulation import record

DRIVE = {
    'duration': 1.0,
    'plant': {'initial_speed': 3.0},
    'commands': [
        {'at': 0.0, 'icr': 'straight', 'speed': 3.0},
        {'at': 0.2, 'icr': [0.0, 8.0], 'speed': 3.0},
        {'at': 0.6, 'icr': [0.0, -8.0], 'speed': 3.0},
    ],
}


def scenario(*faults: FaultEvent) -> Scenario:
    return replace(make_scenario('drive', DRIVE), faults=faults)


@cache
def sound() -> Bag:
    return record(scenario())


def test_a_sound_drive_passes_all() -> None:
    assert steering_excess(sound(), scenario()) == []
    assert incomplete(sound(), scenario()) == []


def test_limits_that_were_passed_are_named() -> None:
    """The same recording, judged by half of the angle and of the rate that are in it."""
    angles = sound()['joint_states'].position[:, :4]
    angle = float(np.abs(angles).max())
    rate = float(np.abs(np.diff(angles, axis=0)).max() / 0.005)
    limits = replace(scenario().wheel_module, steer_limit=angle / 2, steer_rate_limit=rate / 2)
    first, second = steering_excess(sound(), replace(scenario(), wheel_module=limits))
    assert f'{angle:.4f} rad is beyond steer_limit' in first
    assert f'{rate:.4f} rad/s is beyond steer_rate_limit' in second


def test_a_bag_that_ends_early_is_named() -> None:
    longer = replace(scenario(), duration=1.5)
    assert incomplete(sound(), longer) == ['joint_states ends at 1 s of 1.5 s', 'odom ends at 1 s of 1.5 s']


@pytest.mark.parametrize('number', [math.nan, math.inf, -math.inf])
def test_a_number_that_is_not_finite_is_found(number: float) -> None:
    kind = 'geometry_msgs/msg/PointStamped'
    messages = [
        RecordedMessage('/driver/icr', kind, 0, encode(kind, Point(0, 1.0, y))) for y in (2.0, number, number)
    ]
    assert not_finite(messages[:1]) == []
    assert not_finite(messages) == ['/driver/icr has a number that is not finite']


def test_the_truth_counts_where_a_sensor_lies() -> None:
    lie = FaultEvent(0.3, make_fault('odom', 'wrong', 2.0), 0.3)
    bag = record(scenario(lie))
    _, (told,) = true_columns(bag, 'odom', 'x')
    assert np.abs(np.diff(bag['odom'].x)).max() > 0.5
    assert np.abs(np.diff(told)).max() < 3.0 * 0.005 * 1.5


def test_what_has_an_effect() -> None:
    """A wheel that is locked brakes; messages of a topic on which nobody speaks can be lost."""
    assert has_effect(scenario(), FaultEvent(0.3, make_fault('front_left/brake', 'stuck')))
    assert not has_effect(scenario(), FaultEvent(0.3, make_fault('messages/cmd_vel', 'off')))
    assert not has_effect(scenario(), FaultEvent(0.3, make_fault('front_left/module', 'delayed')))


def fault(component: str, failure: str, at: float = 1.0) -> FaultEvent:
    return FaultEvent(at, make_fault(component, failure))


def test_a_diagnostic_names_a_fault_after_it_only_and_by_its_own_words() -> None:
    stuck = fault('front_left/steering', 'stuck')
    text = 'front_left: steering is stuck'
    assert named_after(stuck, [stuck], [Trouble(1.25, 2, '/run/icr_steering', text)]) == 0.25
    assert named_after(stuck, [stuck], [Trouble(0.5, 2, '/run/icr_steering', text)]) is None
    other = Trouble(1.25, 2, '/run/icr_steering', 'front_right: steering is stuck')
    assert named_after(stuck, [stuck], [other]) is None
    assert named_after(stuck, [stuck], [Trouble(1.25, 1, '/run/front_left/wheel_module', 'trim is beyond')]) == 0.25
    assert named_after(stuck, [stuck], [Trouble(1.25, 1, '/run/plant: inputs', f'{text} has 2 publishers')]) is None


def test_what_is_said_after_the_clock_went_back_counts_by_its_stamps() -> None:
    back, stuck = FaultEvent(1.0, make_fault('clock', 'wrong', -0.5)), fault('imu', 'stuck', 0.8)
    said = [Trouble(0.505, 1, '/icr_steering', 'the clock went back'), Trouble(0.6, 1, '/side_slip_controller', 'imu')]
    assert named_after(back, [stuck, back], said) == pytest.approx(0.005)
    assert named_after(stuck, [stuck, back], said) == pytest.approx(0.1)
    assert named_after(stuck, [stuck], said) is None


def test_a_sensor_is_not_named_by_the_name_of_who_complains() -> None:
    slip = fault('tyres/side_slip', 'off')
    complaint = Trouble(1.5, 2, '/side_slip_controller', 'what is measured or commanded is not finite')
    assert named_after(slip, [slip], [complaint]) is None
    assert named_after(slip, [slip], [complaint._replace(message='side_slip has no numbers')]) == 0.5
    assert 'command timeout' in marks('messages/driver/icr')
    assert marks('messages/rear_left/command') == ('rear left',)


def test_a_bad_end_is_a_failure_with_its_reason(tmp_path) -> None:
    (drive,) = draw(1, 0, 'offline')
    said = 'error: plant ended with code 1\nTraceback (most recent call last):\n5 messages, 3 lost\n'
    verdict = judge(drive, Trial(tmp_path, 2, 1.0, said, [7], ['fastrtps_0']))
    assert verdict.failures == (
        'exit code 2: error: plant ended with code 1',
        'a traceback in its output or the logs of its nodes',
        '1 processes left',
        '1 segments of shared memory left',
        '3 messages lost',
    )
    assert not verdict.passed
    assert judge(drive, Trial(tmp_path, None, 1.0, '', [], [])).failures[0].startswith('hangs')


def test_the_page_counts_what_is_in_the_verdicts() -> None:
    one, two = draw(2, 0, 'offline')
    event = one.scenario.faults[0]
    verdicts = [
        Verdict(one, 1.0, (), (Finding(event, 0.25),)),
        Verdict(two, 1.0, ('a bad end',), (Finding(event, None), Finding(event, None, acts=False))),
    ]
    text = page(Campaign(Request(2, 0, 'offline', 1, 0), 60.0, verdicts))
    assert '2 drives (2 offline) in 1.0 min. 1 passed' in text
    assert '| brake | stuck | 3 | 1 | 0.25 | 1 | 1 |' in text
    assert '- run 2 (offline): a bad end' in text
    assert row(verdicts[1])['named_after'] == [None, None]
    assert [verdict.passed for verdict in verdicts] == [True, False]


def test_a_campaign_goes_on_with_what_is_there(tmp_path) -> None:
    drives = draw(3, 0, 'offline')
    event = drives[0].scenario.faults[0]
    verdicts = [
        Verdict(drives[0], 1.5, (), (Finding(event, 0.25),)),
        Verdict(drives[2], 2.5, ('a bad end',), ()),
    ]
    request = Request(3, 0, 'offline', 1, 0)
    write(Campaign(request, 60.0, verdicts), tmp_path)
    assert read_before(tmp_path, request._replace(jobs=2), drives) == Campaign(request._replace(jobs=2), 60.0, verdicts)
    with pytest.raises(RunError, match='holds a campaign with seed 0, not 1'):
        read_before(tmp_path, request._replace(seed=1), drives)
    with pytest.raises(RunError, match='holds no campaign'):
        read_before(tmp_path.parent, request, drives)
