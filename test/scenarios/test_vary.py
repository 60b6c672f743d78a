import dataclasses
import itertools
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omni_vehicle_ros.errors import ScenarioError
from omni_vehicle_ros.scenarios import load_scenario, variants
from omni_vehicle_ros.scenarios.loading import build_scenario
from omni_vehicle_ros.scenarios.settings import read_vary
from omni_vehicle_ros.scenarios.yaml_text import parse

Write = Callable[..., str]

STUDY = """
values: {radius: 5.0, speed: 4.0, roll_steer: 0.2, brake: 100.0}
vary:
  speed: [3.0, 4.0]
  vehicle.load_transfer: [true, false]
  radius: {from: 2.0, to: 3.0, count: 3}
duration: 2.0
vehicle: {front_roll_steer: -$roll_steer, rear_roll_steer: $roll_steer}
plant: {initial_speed: $speed}
commands:
  - {at: 0.0, icr: [0.0, $radius], speed: $speed}
  - {at: 1.0, icr: straight, wheel_traction: -$brake}
"""


def test_a_plain_run_uses_the_defaults(scenario_file: Write) -> None:
    scenario = load_scenario(scenario_file(STUDY))
    assert scenario.vary == {
        'speed': (3.0, 4.0), 'vehicle.load_transfer': (True, False), 'radius': (2.0, 2.5, 3.0)
    }
    assert (scenario.commands[0].speed, scenario.commands[0].icr) == (4.0, (0.0, 5.0))
    assert scenario.vehicle.load_transfer


def test_variants_are_the_whole_grid_and_the_last_name_changes_fastest(scenario_file: Write) -> None:
    path = scenario_file(STUDY)
    found = variants(path)
    grid = itertools.product((3.0, 4.0), (True, False), (2.0, 2.5, 3.0))
    assert [tuple(point.values()) for point, _ in found] == list(grid)
    for point, scenario in found:
        assert tuple(point) == ('speed', 'vehicle.load_transfer', 'radius')
        assert scenario.plant.initial_speed == scenario.commands[0].speed == point['speed']
        assert scenario.vehicle.load_transfer is point['vehicle.load_transfer']
        assert scenario.commands[0].icr == (0.0, point['radius'])


def test_a_variant_is_the_run_with_the_same_overrides(scenario_file: Write) -> None:
    path = scenario_file(STUDY)
    for point, scenario in variants(path, ['vehicle.mass=1400']):
        overrides = [f'{name}={str(value).lower()}' for name, value in point.items()]
        assert dataclasses.replace(load_scenario(path, ['vehicle.mass=1400', *overrides]), vary={}) == scenario


def test_what_is_overridden_is_no_longer_varied(scenario_file: Write) -> None:
    path = scenario_file(STUDY)
    found = variants(path, ['radius=-7', 'vehicle.load_transfer=false'])
    assert [point for point, _ in found] == [{'speed': 3.0}, {'speed': 4.0}]
    assert {scenario.commands[0].icr for _, scenario in found} == {(0.0, -7.0)}
    assert not any(scenario.vehicle.load_transfer for _, scenario in found)
    assert 'radius' not in load_scenario(path, ['radius=-7']).vary


def test_without_vary_there_is_one_variant(scenario_file: Write) -> None:
    path = scenario_file()
    assert variants(path) == (({}, load_scenario(path)),)


def test_a_resolved_run_varies_nothing(scenario_file: Write) -> None:
    scenario = load_scenario(scenario_file(STUDY))
    resolved = load_scenario(scenario_file(scenario.as_yaml()))
    assert resolved.vary == {}
    assert resolved == dataclasses.replace(scenario, vary={})


def test_a_minus_means_the_opposite(scenario_file: Write) -> None:
    scenario = load_scenario(scenario_file(STUDY), ['roll_steer=0.3', 'brake=50'])
    assert scenario.vehicle.front_roll_steer == -scenario.vehicle.rear_roll_steer == -0.3
    assert scenario.commands[1].traction == -200.0


@pytest.mark.parametrize(('shares', 'driven'), [
    ('[0.25, 0.25, 0.25, 0.25]', 4), ('[0.5, 0.5, 0, 0]', 2), ('[0, 0, 0.5, 0.5]', 2), ('[0, 1, 0, 0]', 1),
])
def test_traction_may_be_that_of_each_driven_wheel(scenario_file: Write, shares: str, driven: int) -> None:
    scenario = load_scenario(scenario_file(STUDY), [f'steering.drive_shares={shares}'])
    assert scenario.commands[1].traction == -100.0 * driven


@settings(deadline=None, max_examples=100)
@given(st.floats(-1e6, 1e6), st.floats(-1e6, 1e6), st.integers(2, 50))
def test_an_even_grid_is_that_of_numpy_with_exact_ends(first: float, last: float, count: int) -> None:
    grid = read_vary({'radius': {'from': first, 'to': last, 'count': count}})['radius']
    assert (grid[0], grid[-1]) == (first, last)
    rounding = 4e-15 * (abs(first) + abs(last))
    np.testing.assert_allclose(grid, np.linspace(first, last, count), rtol=0.0, atol=rounding)


@settings(deadline=None, max_examples=25)
@given(st.lists(st.lists(st.floats(0.1, 9.0), min_size=1, max_size=3), min_size=3, max_size=3))
def test_what_varies_keeps_the_order_of_the_file(axes: list[list[float]]) -> None:
    vary = dict(zip(('speed', 'duration', 'radius'), axes, strict=True))
    scenario = build_scenario('any', {**parse(STUDY), 'vary': vary})
    assert list(scenario.vary.items()) == [(name, tuple(values)) for name, values in vary.items()]


@pytest.mark.parametrize(
    ('vary', 'problem'),
    [
        ('3', 'vary: 3 must be a mapping'),
        ('{radius: 3.0}', 'vary: radius: 3.0 must be a list of values, or {from, to, count}'),
        ('{radius: []}', 'vary: radius: [] must be a list of values'),
        ('{radius: {from: 1.0, to: 2.0}}', 'vary: radius: from, to given; an even grid has from, to and count'),
        ('{radius: {from: 1, to: 2, count: 1}}', 'vary: radius: count: 1 must be a whole number, 2 .. 1000'),
        ('{radius: {from: 1, to: 2, count: 2.5}}', 'count: 2.5 must be a whole number'),
        ('{radius: {from: 1, to: .inf, count: 3}}', 'vary: radius: to: inf is outside'),
        ('{radios: [1.0]}', "vary: radios = 1.0: unknown name 'radios'; did you mean 'radius'?"),
        ('{vehicle.mas: [1.0]}', "vehicle: unknown parameter 'mas'; did you mean 'mass'?"),
        ('{vehicle.mass: [1400.0, -1.0]}', 'vary: vehicle.mass = -1.0: vehicle: mass: -1.0 is outside'),
        ('{radius: [2.0, far]}', "vary: radius = far: commands[0]: icr[1]: 'far' must be a number"),
        ('{roll_steer: [[0.1, 0.2]]}', 'roll_steer: [0.1, 0.2] must be a number'),
        ('{description: [short, long]}', "unknown name 'description'"),
    ],
)
def test_a_bad_vary_is_refused_in_one_line(scenario_file: Write, vary: str, problem: str) -> None:
    path = scenario_file(STUDY.split('vary:')[0] + f'vary: {vary}\nduration' + STUDY.split('duration')[1])
    with pytest.raises(ScenarioError) as caught:
        load_scenario(path)
    assert problem in str(caught.value)
    assert path in str(caught.value)
    assert '\n' not in str(caught.value)


def test_values_that_do_not_go_together_are_named(scenario_file: Write) -> None:
    path = scenario_file(
        'duration: 1\nvehicle: {mass: 1500, sprung_mass: 1000}\n'
        'vary: {vehicle.mass: [1200.0, 1500.0], vehicle.sprung_mass: [1000.0, 1300.0]}'
    )
    load_scenario(path)
    with pytest.raises(ScenarioError, match=r'vary: vehicle.mass = 1200.0, vehicle.sprung_mass = 1300.0: vehicle: '):
        variants(path)
