"""Steps and profiles of the environment: what is said in each cycle is what the file draws over time."""

from collections.abc import Callable
from operator import attrgetter
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omni_vehicle_ros.analysis.summary import timeline
from omni_vehicle_ros.errors import ScenarioError
from omni_vehicle_ros.scenarios import DriverScript, Scenario, load_scenario
from omni_vehicle_ros.scenarios.loading import build_scenario
from omni_vehicle_ros.scenarios.yaml_text import parse
from omni_vehicle_ros.simulation import record

Write = Callable[..., str]

PERIOD = 0.005
FIELDS = {'bank': 'x', 'wind': 'y', 'friction': 'effort'}


def scenario_of(environment: list[dict[str, Any]], duration: float = 4.0) -> Scenario:
    return build_scenario('weather', {'duration': duration, 'environment': environment})


def said(scenario: Scenario, quantity: str) -> dict[int, Any]:
    """Return what the driver says about a quantity, by cycle."""
    script, topic, field = DriverScript(scenario), f'environment/{quantity}', attrgetter(FIELDS[quantity])
    messages = {cycle: dict(script.messages(cycle)) for cycle in range(scenario.cycles + 1)}
    return {cycle: field(said[topic]) for cycle, said in messages.items() if topic in said}


def held(scenario: Scenario, quantity: str) -> list[Any]:
    """Return what acts in each cycle: what was said last."""
    values, acting = said(scenario, quantity), []
    for cycle in range(scenario.cycles + 1):
        acting.append(values[cycle] if cycle in values else acting[-1])
    return acting


TIMES = st.integers(0, 4000).map(lambda milliseconds: 0.001 * milliseconds)
POINTS = st.lists(st.tuples(TIMES, st.floats(-0.5, 0.5)), min_size=2, max_size=6, unique_by=lambda point: point[0])


@settings(deadline=None, max_examples=50)
@given(POINTS.map(sorted))
def test_a_profile_is_the_straight_lines_of_numpy(points: list[tuple[float, float]]) -> None:
    acting = np.array(held(scenario_of([{'profile': 'bank', 'points': list(map(list, points))}]), 'bank'))
    times, values = zip(*points, strict=True)
    time = np.arange(len(acting)) * PERIOD
    begun = time >= times[0] - 1e-9
    np.testing.assert_array_equal(acting[~begun], 0.0)
    # The steepest line rises by 1 in 1 ms, so that rounding of the time, 1e-15 s, makes 1e-12.
    np.testing.assert_allclose(acting[begun], np.interp(time[begun], times, values), rtol=0.0, atol=1e-11)
    assert acting[-1] == values[-1]


@pytest.mark.parametrize('end', [1e-300, 1e-9, 1e-3])
def test_a_profile_shorter_than_a_cycle_leaves_its_last_value(end: float) -> None:
    acting = held(scenario_of([{'profile': 'bank', 'points': [[0.0, 0.1], [end, 0.2]]}]), 'bank')
    assert acting[1] == acting[-1] == 0.2


def test_friction_has_a_profile_for_each_wheel() -> None:
    points = [[1.0, 0.9], [2.0, [0.3, 0.9, 0.5, 0.9]], [3.0, 0.8]]
    acting = np.array(held(scenario_of([{'profile': 'friction', 'points': points}]), 'friction'))
    time = np.arange(len(acting)) * PERIOD
    for wheel, lowest in enumerate((0.3, 0.9, 0.5, 0.9)):
        np.testing.assert_allclose(acting[:, wheel], np.interp(time, [1.0, 2.0, 3.0], [0.9, lowest, 0.8]), atol=1e-12)


def test_it_is_said_in_the_cycles_in_which_it_changes_and_in_no_other() -> None:
    points = [[1.0, 0.0], [1.02, 0.1], [2.0, 0.1], [2.01, 0.0]]
    values = said(scenario_of([{'profile': 'bank', 'points': points}]), 'bank')
    assert sorted(values) == [0, 200, 201, 202, 203, 204, 401, 402]
    assert values[204] == 0.1
    assert values[402] == 0.0


def test_steps_and_profiles_of_one_quantity_take_turns() -> None:
    scenario = scenario_of([
        {'at': 0.5, 'wind': 3.0},
        {'profile': 'wind', 'points': [[1.0, 3.0], [2.0, 5.0]]},
        {'profile': 'bank', 'points': [[1.0, 0.0], [3.0, 0.2]]},
        {'at': 2.5, 'wind': -1.0},
    ])
    wind, bank = held(scenario, 'wind'), held(scenario, 'bank')
    times = (0.4, 0.5, 1.0, 2.0, 2.4, 2.5, 4.0)
    assert [wind[round(time / PERIOD)] for time in times] == [0.0, 3.0, 3.0, 5.0, 5.0, -1.0, -1.0]
    assert wind[300] == pytest.approx(4.0, abs=1e-12)
    assert bank[400] == pytest.approx(0.1, abs=1e-12)


def test_a_profile_between_two_cycles_begins_in_the_next_one() -> None:
    scenario = scenario_of([
        {'at': 1.001, 'bank': 0.3}, {'profile': 'bank', 'points': [[1.002, 0.1], [1.003, 0.2]]}
    ])
    assert said(scenario, 'bank') == {0: 0.0, 201: 0.2}


@pytest.mark.parametrize(('number', 'wind'), [(0, 1.5), (2, 5.0), (4, 9.5), (5, 9.5), (-6, -15.0), (17, 56.0)])
def test_a_beaufort_number_is_the_middle_of_its_range_in_table_4_1(number: int, wind: float) -> None:
    change = scenario_of([{'at': 1.0, 'beaufort': number}]).environment[0]
    assert change == scenario_of([{'at': 1.0, 'wind': wind}]).environment[0]


def test_the_bag_shows_what_acted() -> None:
    """The bank pushes a rolling vehicle: its tyres carry m g sin b, and their load is scaled by cos b."""
    points = [[0.1, 0.0], [0.4, 0.06], [0.6, 0.06]]
    tree = {
        'duration': 1.0,
        'plant': {'initial_speed': 10.0, 'constant_speed': True},
        'commands': [{'at': 0.0, 'icr': 'straight', 'speed': 10.0}],
        'environment': [{'profile': 'bank', 'points': points}],
    }
    bag = record(build_scenario('banked', tree))
    bank, force = bag['environment/bank'], bag['tyres/force']
    np.testing.assert_allclose(bank.x, np.interp(bank.stamp, *zip(*points, strict=True)), atol=1e-12)
    assert len(bank) == 1 + 61
    weight = 1298.9 * 9.81
    np.testing.assert_allclose(force.forces[-1, :, 2].sum(), weight * np.cos(0.06), rtol=1e-9)


def test_a_report_says_what_happens_and_when() -> None:
    scenario = scenario_of([
        {'at': 0.5, 'beaufort': -4},
        {'profile': 'bank', 'points': [[1.0, 0.0], [1.5, 0.1], [2.0, 0.0]]},
        {'profile': 'friction', 'points': [[3.0, 0.9], [4.0, [0.3, 0.9, 0.9, 0.9]]]},
    ])
    assert timeline(scenario) == [
        ('0.5 s', 'wind -9.5 m/s'),
        ('1 s', 'bank 0°, in straight lines to 5.73° at 1.5 s; 0° at 2 s'),
        ('3 s', 'friction 0.9, in straight lines to 0.3, 0.9, 0.9, 0.9 at 4 s'),
    ]


@settings(deadline=None, max_examples=25)
@given(st.integers(1, 800))
def test_what_lies_after_the_end_never_happens(cycles: int) -> None:
    """A run that is cut short is the begin of the whole one, in the middle of a profile, too."""
    bank = {'profile': 'bank', 'points': [[1.5, 0.0], [3.0, 0.1]]}
    weather = [{'at': 1.0, 'wind': 1.0}, bank, {'at': 3.5, 'wind': 2.0}]
    whole, short = scenario_of(weather), scenario_of(weather, cycles * PERIOD)
    assert short.environment == whole.environment
    for quantity in ('bank', 'wind'):
        assert held(short, quantity) == held(whole, quantity)[: cycles + 1]


@settings(deadline=None, max_examples=50)
@given(POINTS.map(sorted), st.sampled_from(sorted(FIELDS)))
def test_profiles_read_back_equal(points: list[tuple[float, float]], quantity: str) -> None:
    grip = [0.3, 0.9, 0.5, 0.8]
    drawn = [[time, grip if quantity == 'friction' else value] for time, value in points]
    scenario = scenario_of([{'profile': quantity, 'points': drawn}])
    assert build_scenario('other', parse(scenario.as_yaml())) == scenario


PROFILE = '{profile: bank, points: [%s]}'
BAD = [
    ('{at: 1}', 'nothing beside at; allowed: bank, wind or beaufort, friction'),
    ('{at: 1, beaufort: 4.5}', 'beaufort: 4.5 must be a whole number; negative: the wind blows to the right'),
    ('{at: 1, beaufort: true}', 'beaufort: True must be a whole number'),
    ('{at: 1, beaufort: 32}', 'beaufort: 32 is outside -17 .. 17, as wind is held to 60 m/s'),
    ('{at: 1, beaufort: -18}', 'beaufort: -18 is outside -17 .. 17'),
    ('{at: 1, beaufort: 2, wind: 5.0}', 'wind and beaufort say the same; leave one of them out'),
    ('{profile: bnak, points: []}', "profile: 'bnak' is not one of bank, wind, friction"),
    ('{profile: [bank], points: []}', "profile: ['bank'] is not one of bank, wind, friction"),
    ('{profile: bank, at: 1.0}', "unknown key 'at'; allowed: profile, points"),
    ('{profile: bank, point: []}', "unknown key 'point'; did you mean 'points'?"),
    ('{profile: bank}', 'points: None must be a list of 2 or more [time, value]'),
    (PROFILE % '[1.0, 0.0]', 'must be a list of 2 or more [time, value]'),
    (PROFILE % '[1.0, 0.0], [2.0]', 'points[1]: [2.0] must be [time, value]'),
    (PROFILE % '[1.0, 0.0], [1.0, 0.1]', 'points[1]: time: 1 s must be later than the point before, 1 s'),
    (PROFILE % '[2.0, 0.0], [1.0, 0.1]', 'points[1]: time: 1 s must be later than the point before, 2 s'),
    (PROFILE % '[-1.0, 0.0], [1.0, 0.1]', 'points[0]: time: -1.0 is outside 0 .. inf'),
    (PROFILE % '[.nan, 0.0], [1.0, 0.1]', 'points[0]: time: nan is outside'),
    (PROFILE % '[1.0, 0.0], [2.0, 1.5]', 'points[1]: bank: 1.5 is outside -0.7 .. 0.7 rad'),
    (PROFILE % '[1.0, steep], [2.0, 0.1]', "points[0]: bank: 'steep' must be a number"),
    (PROFILE % '[1.0, [0.0, 0.1]], [2.0, 0.1]', 'points[0]: bank: [0.0, 0.1] must be a number'),
    ('{profile: friction, points: [[1.0, 0.9], [2.0, [1, 1]]]}', 'points[1]: friction: [1, 1] must be a list of 4'),
]


@pytest.mark.parametrize(('entry', 'problem'), BAD)
def test_a_bad_entry_is_refused_in_one_line(scenario_file: Write, entry: str, problem: str) -> None:
    path = scenario_file(f'duration: 4\nenvironment:\n  - {entry}')
    with pytest.raises(ScenarioError) as caught:
        load_scenario(path)
    assert f'{path}: environment[0]: ' in str(caught.value)
    assert problem in str(caught.value)
    assert '\n' not in str(caught.value)


@pytest.mark.parametrize(
    ('second', 'problem'),
    [
        ('{at: 1.5, bank: 0.0}', 'environment[1]: bank: 1.5 s must be later than its last change before, 2 s'),
        ('{at: 2.0, wind: 1.0, bank: 0.0}', 'environment[1]: bank: 2 s must be later'),
        (PROFILE % '[1.0, 0.0], [3.0, 0.1]', 'environment[1]: bank: 1 s must be later'),
        ('{at: 0.5, wind: 1.0}', 'environment[1]: at: 0.5 s must not be earlier than the entry before, 1 s'),
    ],
)
def test_a_profile_is_left_alone_until_it_is_over(scenario_file: Write, second: str, problem: str) -> None:
    first = PROFILE % '[1.0, 0.0], [2.0, 0.1]'
    with pytest.raises(ScenarioError) as caught:
        load_scenario(scenario_file(f'duration: 4\nenvironment:\n  - {first}\n  - {second}'))
    assert problem in str(caught.value)
