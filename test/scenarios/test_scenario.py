import dataclasses
import math
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omni_vehicle_ros import share
from omni_vehicle_ros.control.motion import MINIMUM_ICR_DISTANCE
from omni_vehicle_ros.errors import RunError, ScenarioError
from omni_vehicle_ros.scenarios import Scenario, load_scenario, scenario_directory, scenario_names
from omni_vehicle_ros.scenarios.loading import build_scenario
from omni_vehicle_ros.scenarios.yaml_text import parse

Write = Callable[..., str]


def test_values_stand_where_their_names_are(scenario_file: Write) -> None:
    scenario = load_scenario(scenario_file())
    assert scenario.name == 'small'
    assert scenario.commands[0].icr == (0.0, 5.0)
    assert scenario.commands[0].speed == scenario.plant.initial_speed == 4.0
    assert scenario.commands[1].icr == 'straight'
    assert scenario.commands[1].traction == -500.0
    assert scenario.environment[0].friction == (0.5, 0.5, 0.5, 0.5)
    assert scenario.values == {'radius': 5.0, 'speed': 4.0}


def test_overrides(scenario_file: Write) -> None:
    overrides = [
        'radius=-1e1', 'radius=-7', 'vehicle.mass=1400', 'steering.command_timeout=0', 'plant.constant_speed=true',
        'side_slip.proportional_gains=[5, 1, 0, 0]', 'duration=3', 'side_slip_control=true',
    ]
    scenario = load_scenario(scenario_file(), overrides)
    assert scenario.commands[0].icr == (0.0, -7.0)
    assert scenario.vehicle.mass == 1400.0
    assert scenario.steering.command_timeout == 0.0
    assert scenario.plant.constant_speed is True
    assert scenario.side_slip.proportional_gains == (5.0, 1.0, 0.0, 0.0)
    assert scenario.duration == 3.0
    assert scenario.side_slip_control is True


def test_the_duration_is_a_whole_number_of_cycles(scenario_file: Write) -> None:
    path = scenario_file()
    assert load_scenario(path, ['duration=2.0001']).cycles == 401
    assert load_scenario(path, ['duration=2.0000000001']).cycles == 400
    third = load_scenario(path, ['plant.control_period=0.003'])
    assert third.cycles == 667
    assert third.duration == pytest.approx(2.001)


@pytest.mark.parametrize('name', scenario_names())
def test_a_resolved_scenario_reads_back_equal(name: str, tmp_path: Path) -> None:
    scenario = load_scenario(name, ['vehicle.mass=1234.5'])
    path = tmp_path / 'scenario.yaml'
    path.write_text(scenario.as_yaml(), encoding='utf-8')
    assert load_scenario(str(path)) == dataclasses.replace(scenario, vary={})


def test_a_resolved_scenario_refuses_values_that_would_have_no_effect(scenario_file: Write) -> None:
    resolved = load_scenario(scenario_file()).as_yaml()
    with pytest.raises(ScenarioError, match=r'radius has no effect'):
        load_scenario(scenario_file(resolved), ['radius=3'])
    assert load_scenario(scenario_file(resolved), ['vehicle.mass=1400']).vehicle.mass == 1400.0


def test_the_first_scenarios_are_there() -> None:
    assert {'demo', 'simple_turning'} <= set(scenario_names())
    turning = load_scenario('simple_turning', ['radius=-3.0', 'speed=2.0', 'duration=5.0'])
    assert turning.plant.constant_speed
    assert turning.plant.initial_speed == 2.0
    assert turning.wheel_module.ideal_actuators
    assert not turning.side_slip_control
    assert turning.cycles == 1000
    demo = load_scenario('demo')
    assert demo.side_slip_control
    assert not demo.wheel_module.ideal_actuators


COMMAND = 'duration: 1\ncommands: [{%s}]'
BAD_FILES = [
    ('', 'is empty; it must be a mapping'),
    ('duration: 1\nvehicle:', 'vehicle: is empty; it must be a mapping'),
    ('- a', 'must be a mapping'),
    ('duration: [', 'line 1'),
    ('commands: []', 'duration is missing'),
    ('duration: abc', "duration: 'abc' must be a number"),
    ('duration: .nan', 'duration: nan is outside 0.005 .. 100000'),
    ('duration: 0', 'outside 0.005'),
    ('duration: true', 'must be a number'),
    ('duration: $time', '$time is not among the values'),
    ('values: {time: 1.0}\nduration: $tim', "did you mean 'time'?"),
    ('duration: 1\ncomands: []', "unknown key 'comands'; did you mean 'commands'?"),
    ('duration: 1\nside_slip_control: 1', 'side_slip_control: 1 must be true or false'),
    ('duration: 1\ncommand_period: 0', 'command_period: 0 is outside'),
    ('duration: 1\ndescription: 3', 'description: 3 must be a text'),
    ('duration: 1\nvalues: []', 'values: [] must be a mapping'),
    ('duration: 1\nvehicle: 3', 'vehicle: 3 must be a mapping'),
    ('duration: 1\nvehicle: {mas: 3}', "vehicle: unknown parameter 'mas'; did you mean 'mass'?"),
    ('duration: 1\nvehicle: {mass: heavy}', "vehicle: mass: 'heavy' must be a number"),
    ('duration: 1\nvehicle: {mass: .nan}', 'mass: nan is outside 1 .. 100000 kg'),
    ('duration: 1\nplant: {constant_speed: 1}', 'plant: constant_speed: 1 must be true or false'),
    ('duration: 1\ncommands: {}', 'commands: {} must be a list'),
    ('duration: 1\ncommands: [3]', 'commands[0]: 3 must be a mapping'),
    (COMMAND % 'icr: straight, speed: 1', 'commands[0]: at is missing'),
    (COMMAND % 'at: 0', 'commands[0]: nothing beside at; allowed: icr and speed;'),
    (COMMAND % 'at: 0, icr: straight', 'allowed: icr and speed'),
    (COMMAND % 'at: 0, speed: 1, cmd_vel: [0, 0, 0]', 'allowed: icr and speed'),
    (COMMAND % 'at: -1, silent: true', 'at: -1 is outside 0 .. inf'),
    (COMMAND % 'at: 0, silent: false', 'silent: False must be true'),
    (COMMAND % 'at: 0, icr: left, speed: 1', "icr: 'left' must be [x, y] or straight"),
    (COMMAND % 'at: 0, icr: [0], speed: 1', 'icr: [0] must be a list of 2 numbers'),
    (COMMAND % 'at: 0, icr: [0, .inf], speed: 1', 'icr[1]: inf is outside'),
    (
        COMMAND % 'at: 0, icr: [0, 0.006], speed: 1',
        'commands[0]: icr: [0, 0.006] is nearer than 0.01 m to the centre of gravity',
    ),
    (COMMAND % 'at: 0, icr: straight, speed: .nan', 'speed: nan is outside'),
    (COMMAND % 'at: 0, emergency_stop: true', 'commands[0]: nothing beside at; allowed: icr and speed;'),
    (COMMAND % 'at: 0, silent: true, emergency_stop: 1', 'emergency_stop: 1 must be true or false'),
    (COMMAND % 'at: 0, teleop: [0, 0]', 'teleop: [0, 0] must be a list of 3 numbers'),
    (COMMAND % 'at: 0, cmd_vel: [0, 0]', 'cmd_vel: [0, 0] must be a list of 3 numbers'),
    ('duration: 1\ncommands: [{at: 0, silent: true}, {at: 0, silent: true}]', 'commands[1]: at: 0 s must be later'),
    ('duration: 1\nenvironment: [{at: 0, winds: 1}]', "unknown key 'winds'; did you mean 'wind'?"),
    ('duration: 1\nenvironment: [{at: 0, wind: .nan}]', 'wind: nan is outside -60 .. 60 m/s'),
    ('duration: 1\nenvironment: [{at: 0, bank: 2}]', 'bank: 2 is outside -0.7 .. 0.7 rad'),
    ('duration: 1\nenvironment: [{at: 0, friction: [1, 1]}]', 'friction: [1, 1] must be a list of 4 values'),
    ('duration: 1\nenvironment: [{at: 0, friction: [1, 1, 1, 0]}]', 'friction: 0 is outside 0.01 .. 2'),
]


@pytest.mark.parametrize(('text', 'problem'), BAD_FILES)
def test_a_bad_file_is_refused_in_one_line(scenario_file: Write, text: str, problem: str) -> None:
    path = scenario_file(text)
    with pytest.raises(ScenarioError) as caught:
        load_scenario(path)
    assert problem in str(caught.value)
    assert path in str(caught.value)
    assert '\n' not in str(caught.value)


@pytest.mark.parametrize(
    ('override', 'problem'),
    [
        ('radius', "'radius' must be name=value"),
        ('radios=3', "unknown name 'radios'; did you mean 'radius'?"),
        ('wheels.mass=3', "unknown name 'wheels.mass'"),
        ('vehicle.mas=3', "vehicle: unknown parameter 'mas'; did you mean 'mass'?"),
        ('vehicle.mass=-1', 'mass: -1 is outside 1 .. 100000 kg'),
        ('radius=abc', "commands[0]: icr[1]: 'abc' must be a number"),
        ('radius=', 'icr[1] is missing'),
        ('radius=.nan', 'icr[1]: nan is outside'),
        ('radius=[', 'line 1'),
    ],
)
def test_a_bad_override_is_refused_in_one_line(scenario_file: Write, override: str, problem: str) -> None:
    with pytest.raises(ScenarioError) as caught:
        load_scenario(scenario_file(), [override])
    assert problem in str(caught.value)
    assert override in str(caught.value)
    assert '\n' not in str(caught.value)


def test_unknown_scenarios_and_files(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match=r"unknown scenario 'dema'; did you mean 'demo'\?"):
        load_scenario('dema')
    with pytest.raises(ScenarioError, match=r'no such file'):
        load_scenario('dema.yaml')
    with pytest.raises(ScenarioError, match=r'no such file'):
        load_scenario(str(tmp_path))


def test_without_the_source_tree_the_share_folder_below_the_prefix_is_used(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / 'prefix' / 'share' / 'omni_vehicle_ros' / 'config' / 'scenarios'
    installed = tmp_path / 'prefix' / 'lib' / 'site-packages' / 'omni_vehicle_ros' / 'share.py'
    monkeypatch.setattr(share, '__file__', str(installed))
    monkeypatch.setenv('AMENT_PREFIX_PATH', str(tmp_path / 'none'))
    monkeypatch.setattr('sys.prefix', str(tmp_path / 'prefix'))
    with pytest.raises(RunError, match=r'installed without its folder config'):
        scenario_directory()
    folder.mkdir(parents=True)
    assert scenario_directory() == folder


NUMBERS = st.floats(-1e6, 1e6)
CENTRES = st.lists(NUMBERS, min_size=2, max_size=2).filter(lambda icr: math.hypot(*icr) >= MINIMUM_ICR_DISTANCE)
ENTRIES = st.one_of(
    st.fixed_dictionaries({'icr': st.just('straight') | CENTRES, 'speed': NUMBERS}),
    st.fixed_dictionaries({'icr': st.just('straight'), 'traction': NUMBERS, 'yaw_moment': NUMBERS}),
    st.fixed_dictionaries({'cmd_vel': st.lists(NUMBERS, min_size=3, max_size=3)}),
    st.fixed_dictionaries({'teleop': st.lists(NUMBERS, min_size=3, max_size=3)}),
    st.just({'silent': True}),
)
STOPS = st.sampled_from([{}, {'emergency_stop': True}, {'emergency_stop': False}])
SAID = st.tuples(ENTRIES, STOPS).map(lambda two: {**two[0], **two[1]})
CHANGES = st.fixed_dictionaries(
    {'bank': st.floats(-0.5, 0.5)}, optional={'wind': st.floats(-9, 9), 'friction': st.floats(0.1, 1.0)})


@settings(deadline=None, max_examples=100)
@given(st.lists(SAID, max_size=5), st.lists(CHANGES, max_size=3), st.floats(10.0, 100.0))
def test_any_scenario_reads_back_equal(commands: list[dict], environment: list[dict], duration: float) -> None:
    tree = {
        'duration': duration,
        'commands': [{'at': float(at), **entry} for at, entry in enumerate(commands)],
        'environment': [{'at': float(at), **entry} for at, entry in enumerate(environment)],
    }
    scenario = build_scenario('any', tree)
    assert isinstance(scenario, Scenario)
    assert scenario.duration >= duration - 1e-6
    assert math.isclose(scenario.duration, scenario.cycles * scenario.plant.control_period)
    assert build_scenario('other', parse(scenario.as_yaml())) == scenario
