"""Faults in scenario files."""

import pytest

from omni_vehicle_ros.errors import ScenarioError
from omni_vehicle_ros.faults import COMPONENTS, KINDS, kind_of, make_fault, read_faults
from omni_vehicle_ros.scenarios import DriverScript, FaultEvent, load_scenario, scenario_names
from omni_vehicle_ros.scenarios.scenario import make_scenario
from omni_vehicle_ros.scenarios.yaml_text import parse


def scenario(*faults: str, control: bool = False):
    events = [parse(text) for text in faults]
    return make_scenario('x', {'duration': 1.0, 'side_slip_control': control, 'faults': events})


def test_a_file_says_what_happens_and_is_written_back() -> None:
    made = scenario(
        '{at: 0.2, component: front_left/steering, failure: slow, value: 0.3, for: 0.1}',
        '{at: 0.2, component: odom, failure: off}',
    )
    assert made.faults == (
        FaultEvent(0.2, make_fault('front_left/steering', 'slow', 0.3), 0.1),
        FaultEvent(0.2, make_fault('odom', 'off')),
    )
    assert make_scenario('x', parse(made.as_yaml())).faults == made.faults


def test_the_driver_says_when_faults_begin_and_end() -> None:
    script = DriverScript(
        scenario(
            '{at: 0.1, component: odom, failure: stuck, for: 0.2}',
            '{at: 0.3, component: odom, failure: wrong}',
        )
    )
    said = {}
    for cycle in range(201):
        for topic, value in script.messages(cycle):
            if topic == 'faults':
                said[cycle] = [fault.failure for fault in read_faults(value)[0]]
                assert value.stamp == cycle * 5_000_000
    assert said == {20: ['stuck'], 60: ['ok', 'wrong']}


@pytest.mark.parametrize(
    ('text', 'answer'),
    [
        ('{at: 0.1, component: odom}', 'faults[0]: failure: None must be a word'),
        ('{component: odom, failure: off}', 'faults[0]: at is missing'),
        ('{at: 0.1, component: odm, failure: off}', "unknown component 'odm'; did you mean 'odom'?"),
        ('{at: 0.1, component: odom, failure: off, value: 1}', 'off takes no value'),
        ('{at: 0.1, component: odom, failure: wrong, value: 99}', 'wrong: 99 is outside -10 .. 10'),
        ('{at: 0.1, component: odom, failure: off, until: 1}', "unknown key 'until'"),
        ('{at: 0.1, component: driver, failure: off, for: 1}', 'does not come back'),
        ('{at: 0.1, component: side_slip_controller, failure: off}', 'no effect without side_slip_control'),
        ('{at: 0.1, component: messages/front_left/trim, failure: [off]}', 'must be a word'),
    ],
)
def test_what_is_refused(text: str, answer: str) -> None:
    with pytest.raises(ScenarioError) as caught:
        scenario(text)
    assert answer in str(caught.value)


def test_faults_of_one_component_follow_each_other() -> None:
    first = '{at: 0.2, component: odom, failure: off, for: 0.5}'
    for later in ('{at: 0.1, component: imu, failure: off}', '{at: 0.3, component: odom, failure: stuck}'):
        with pytest.raises(ScenarioError, match=r'faults\[1\]: at: 0\.[13] s'):
            scenario(first, later)
    scenario(first, '{at: 0.3, component: imu, failure: stuck}', '{at: 0.7, component: odom, failure: stuck}')


def test_there_is_a_scenario_for_each_kind_of_fault() -> None:
    names = [name for name in scenario_names() if name.startswith('faults/')]
    seen = {(kind_of(e.fault.component), e.fault.failure) for name in names for e in load_scenario(name).faults}
    assert {kind for kind, _ in seen} == {kind_of(component) for component in COMPONENTS}
    assert {failure for kind, failure in seen if kind == 'messages'} == {*KINDS['messages']}
    for name in names:
        assert load_scenario(name).faults
