from collections.abc import Callable

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omni_vehicle_ros import messages
from omni_vehicle_ros.interface import topic
from omni_vehicle_ros.scenarios import DriverScript, load_scenario, scenario_names
from omni_vehicle_ros.scenarios.loading import build_scenario
from omni_vehicle_ros.wheels import WHEELS

Write = Callable[..., str]


def test_commands_begin_on_time_and_repeat(scenario_file: Write) -> None:
    script = DriverScript(load_scenario(scenario_file()))
    speeds = [cycle for cycle in range(401) if any(name == 'driver/speed' for name, _ in script.messages(cycle))]
    brakes = [cycle for cycle in range(401) if any(name == 'driver/traction' for name, _ in script.messages(cycle))]
    assert speeds == list(range(0, 200, 4))
    assert brakes == list(range(200, 300, 4))
    assert all(script.messages(cycle) == [] for cycle in range(300, 401))


def test_what_the_messages_say(scenario_file: Write) -> None:
    script = DriverScript(load_scenario(scenario_file()))
    start, brake = dict(script.messages(0)), dict(script.messages(200))
    assert start['driver/icr'] == messages.Point(0, 0.0, 5.0)
    assert start['driver/speed'] == messages.Twist(0, 4.0)
    assert start['environment/friction'] == messages.Joints(0, WHEELS, effort=(0.9, 0.9, 0.9, 0.9))
    assert start['environment/bank'] == messages.Vector(0, 0.0, 0.0)
    assert brake['driver/traction'] == messages.Wrench(10**9, -500.0)
    assert brake['driver/icr'].x == 0.0
    assert brake['driver/icr'].y > 1e5
    assert brake['environment/friction'].effort == (0.5, 0.5, 0.5, 0.5)
    assert 'environment/bank' not in brake


def test_the_environment_at_the_start_is_the_plants_unless_the_scenario_says_otherwise() -> None:
    tree = {'duration': 1, 'plant': {'bank': 0.1, 'wind': 3.0}, 'environment': [{'at': 0.0, 'wind': -2.0}]}
    start = dict(DriverScript(build_scenario('windy', tree)).messages(0))
    assert start['environment/bank'].x == 0.1
    assert start['environment/wind'].y == -2.0


def test_cmd_vel() -> None:
    tree = {'duration': 1, 'commands': [{'at': 0, 'cmd_vel': [1, 2, 3]}]}
    assert ('cmd_vel', messages.Twist(0, 1.0, 2.0, 3.0)) in DriverScript(build_scenario('twist', tree)).messages(0)


def test_a_stop_is_said_beside_any_command_and_as_often() -> None:
    commands = [{'at': 0, 'teleop': [1, 2, 3], 'emergency_stop': True}, {'at': 0.5, 'silent': True}]
    commands += [{'at': 0.8, 'silent': True, 'emergency_stop': False}]
    script = DriverScript(build_scenario('stop', {'duration': 1, 'command_period': 0.1, 'commands': commands}))
    assert script.messages(20)[-2:] == [
        ('emergency_stop', messages.Flag(True)), ('teleop/cmd_vel', messages.Twist(100_000_000, 1.0, 2.0, 3.0)),
    ]
    assert script.messages(100) == []
    assert script.messages(180) == [('emergency_stop', messages.Flag(False))]


@settings(deadline=None, max_examples=50)
@given(st.integers(1, 100), st.integers(0, 10**7))
def test_stamps_are_exact_for_ever(period_ms: int, cycle: int) -> None:
    tree = {
        'duration': 1e5, 'command_period': period_ms * 1e-3, 'plant': {'control_period': period_ms * 1e-3},
        'commands': [{'at': 0, 'icr': 'straight', 'speed': 1}],
    }
    said = DriverScript(build_scenario('long', tree)).messages(cycle)
    assert {value.stamp for _, value in said} == {cycle * period_ms * 10**6}


@pytest.mark.parametrize('name', scenario_names())
def test_every_message_fits_its_topic(name: str) -> None:
    scenario = load_scenario(name)
    script = DriverScript(scenario)
    for cycle in range(scenario.cycles):
        for topic_name, value in script.messages(cycle):
            row = topic(topic_name)
            assert 'driver' in row.publishers
            assert messages.decode(row.type, messages.encode(row.type, value)) == value
