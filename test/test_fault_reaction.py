"""Runs with faults and without: no false alarm, every fault seen in time, and what the vehicle does then."""

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from omni_vehicle_ros.components.component import Output
from omni_vehicle_ros.components.icr_steering import IcrSteering
from omni_vehicle_ros.interface import ICR_STEERING, SIDE_SLIP_CONTROLLER, WHEEL_MODULES
from omni_vehicle_ros.messages import Diagnostics
from omni_vehicle_ros.scenarios import Scenario, load_scenario, scenario_names
from omni_vehicle_ros.scenarios.scenario import make_scenario
from omni_vehicle_ros.simulation import Simulation

SOUND = [name for name in scenario_names() if not name.startswith('faults/')]
ALARMS = (
    'steering', 'drive is', 'drive does', 'locked', 'silent', 'controlled stop', "can't be believed", 'odom ', 'imu ',
    'tyres/side_slip ', 'fault',
)  # fmt: skip
SLALOM = {
    'duration': 6.0,
    'side_slip_control': True,
    'plant': {'initial_speed': 4.0},
    'commands': [
        {'at': 0.0, 'icr': 'straight', 'speed': 4.0},
        {'at': 1.0, 'icr': [0.0, 15.0], 'speed': 4.0},
        {'at': 3.0, 'icr': [0.0, -15.0], 'speed': 3.0},
        {'at': 5.0, 'icr': 'straight', 'speed': 4.0},
    ],
}


def slalom(*faults: tuple, **sections: dict) -> Scenario:
    events = [dict(zip(('at', 'component', 'failure', 'value'), fault, strict=False)) for fault in faults]
    reacting = {name: {'fault_reaction': True, **sections.get(name, {})} for name in ('steering', 'side_slip')}
    return make_scenario('slalom', {**SLALOM, **sections, **reacting, 'faults': events})


def drive(scenario: Scenario) -> list[Output]:
    outputs: list[Output] = []
    Simulation(scenario, outputs.append).run()
    return outputs


def said(outputs: list[Output], nodes: Sequence[str] = (ICR_STEERING, SIDE_SLIP_CONTROLLER)) -> list[tuple[float, str]]:
    """Return what some nodes warn of."""
    return [
        (output.value.stamp / 1e9, status.message)
        for output in outputs
        if output.topic == '/diagnostics' and isinstance(output.value, Diagnostics)
        for status in output.value.statuses
        if status.level and status.name[1:] in nodes
    ]


def places(outputs: list[Output]) -> np.ndarray:
    return np.array([(o.value.x, o.value.y) for o in outputs if o.topic == 'odom'])


def speed_at_the_end(outputs: list[Output]) -> float:
    last = [o.value for o in outputs if o.topic == 'odom'][-1]
    return math.hypot(last.vx, last.vy)


def path_error(path: np.ndarray, reference: np.ndarray) -> float:
    return max(np.hypot(*(reference - place).T).min() for place in path[::20])


def alarms(outputs: list[Output]) -> list[tuple[float, str]]:
    return [entry for entry in said(outputs) if any(word in entry[1] for word in ALARMS)]


@pytest.mark.slow
@pytest.mark.parametrize('name', SOUND)
def test_no_false_alarm(name: str) -> None:
    """Side-slip control, a slippery road, banks, wind, steps of the ICR at once, crab, stop and spin in place."""
    assert alarms(drive(load_scenario(name))) == []


@pytest.mark.parametrize('controller', ['wheel_slip', 'allocation'])
def test_no_false_alarm_on_ice_in_reverse_at_the_limits_and_with_eight_degrees_of_freedom(controller: str) -> None:
    scenario = make_scenario('rough', {
        'duration': 4.0,
        'side_slip_control': True,
        'side_slip': {'controller': controller},
        'vehicle': {'body_model': 'eight_dof'},
        'plant': {'friction': [0.1] * 4},
        'commands': [
            {'at': 0.0, 'icr': 'straight', 'speed': 3.0},
            {'at': 1.0, 'icr': [0.0, 3.0], 'speed': 6.0},
            {'at': 2.0, 'icr': [1.0, -0.72], 'speed': -2.0},
            {'at': 3.0, 'teleop': [0.0, 0.0, 1.5]},
        ],
    })  # fmt: skip
    assert alarms(drive(scenario)) == []


@pytest.mark.parametrize(('component', 'failure', 'text', 'cycles'), [
    ('front_left/steering', 'wrong', 'front_left steering does not follow', 20),
    ('front_left/brake', 'stuck', 'front_left wheel is locked', 10),
    ('front_right/module', 'off', 'front_right wheel module is silent', 21),
    ('joint_states', 'off', "joint_states can't be believed", 5),
    ('joint_states', 'stuck', "joint_states can't be believed", 6),
    ('odom', 'stuck', 'odom stands still', 6),
    ('imu', 'off', 'imu says nothing', 26),
    ('tyres/side_slip', 'garbage', 'tyres/side_slip', 5),
])  # fmt: skip
def test_each_fault_is_named_in_time(component: str, failure: str, text: str, cycles: int) -> None:
    """At 2 s in a turn at 4 m/s; a wheel that is off by a step has to get there first."""
    outputs = drive(replace(slalom((2.0, component, failure)), duration=2.3))
    when = next(when for when, message in said(outputs) if text in message)
    assert 2.0 <= when <= 2.0 + (cycles + 20 * (component == 'joint_states')) * 0.005


@cache
def reference_path() -> np.ndarray:
    return places(drive(slalom()))


def without_reaction(scenario: Scenario) -> Scenario:
    return replace(
        scenario,
        steering=replace(scenario.steering, fault_reaction=False),
        side_slip=replace(scenario.side_slip, fault_reaction=False),
    )


@pytest.mark.parametrize('fault', [
    (2.0, 'front_left/steering', 'stuck'), (2.0, 'front_left/module', 'off'),
    (3.3, 'rear_left/drive', 'stuck'), (2.0, 'tyres/side_slip', 'stuck'),
])  # fmt: skip
def test_the_path_is_better_kept_with_the_reaction(fault: tuple) -> None:
    scenario, reference = slalom(fault), reference_path()
    with_it, without = places(drive(scenario)), places(drive(without_reaction(scenario)))
    assert path_error(with_it, reference) < 0.7 * path_error(without, reference)


@pytest.mark.parametrize('at', [0.5, 2.0])
@pytest.mark.parametrize('wheel', ['front_left', 'rear_right'])
def test_a_wheel_that_castors_leads_nobody(wheel: str, at: float) -> None:
    """It goes where the vehicle goes, and the path is no worse than if nobody had seen it, to a few centimetres."""
    scenario, reference = slalom((at, f'{wheel}/steering', 'off')), reference_path()
    with_it, without = places(drive(scenario)), places(drive(without_reaction(scenario)))
    assert path_error(with_it, reference) < path_error(without, reference) + 0.05


def test_a_vehicle_that_cannot_be_steered_stops() -> None:
    """Front left held, rear right held: their lines meet on the left, and the driver wants to the right."""
    scenario = load_scenario('faults/messages_nan')
    outputs = drive(scenario)
    assert any('the vehicle stops' in text for _, text in said(outputs))
    assert speed_at_the_end(outputs) < 0.05


@pytest.mark.parametrize('faults', [
    [(2.0, 'front_left/module', 'off'), (2.5, 'rear_right/module', 'off')],
    [(2.0, 'rear_left/brake', 'stuck')],
    [(2.0, 'joint_states', 'stuck')],
    [(2.0, 'front_left/steering', 'garbage')],
])  # fmt: skip
def test_a_controlled_stop_stands_though_the_driver_goes_on(faults: list[tuple]) -> None:
    outputs = drive(slalom(*faults))
    assert speed_at_the_end(outputs) < 0.1
    assert any('controlled stop' in message for _, message in said(outputs))


def test_left_and_right_are_mirror_images() -> None:
    """The same slalom to the other side with the same fault on the other side goes the same way, mirrored."""
    mirrored = [
        {**command, 'icr': [0.0, -command['icr'][1]]} if command['icr'] != 'straight' else command
        for command in SLALOM['commands']
    ]
    left = places(drive(slalom((2.0, 'front_left/steering', 'stuck'))))
    right = places(drive(slalom((2.0, 'front_right/steering', 'stuck'), commands=mirrored)))
    assert np.abs(left * (1.0, -1.0) - right).max() < 1e-6


def lane_change(*faults: tuple) -> Scenario:
    return replace(slalom(*faults), duration=2.6)


@pytest.mark.parametrize('reacts', [False, True])
def test_joint_states_that_are_all_scaled_are_named_and_no_wheel_is(reacts: bool) -> None:
    scenario = lane_change((2.0, 'joint_states', 'wrong', -3.0))
    found = [text for _, text in said(drive(scenario if reacts else without_reaction(scenario)))]
    assert any("joint_states can't be believed" in text for text in found)
    assert not any(word in text for text in found for word in ('does not follow', 'is locked', 'is slow'))


@pytest.mark.parametrize('factor', [-3.0, 0.5, 1.5])
def test_side_slip_control_blames_no_other_sensor_for_joint_states_that_are_scaled(factor: float) -> None:
    outputs = drive(lane_change((2.0, 'joint_states', 'wrong', factor)))
    texts = [text for _, text in said(outputs, [SIDE_SLIP_CONTROLLER])]
    assert texts and all(text.startswith("joint_states can't be believed") for text in texts)


def test_a_drive_that_fails_while_joint_states_repeat_themselves_is_named() -> None:
    outputs = drive(lane_change((2.0, 'joint_states', 'stuck'), (2.2, 'rear_left/drive', 'garbage', 2000.0)))
    when = next(when for when, text in said(outputs) if 'rear_left drive' in text)
    assert 2.2 < when < 2.4


@pytest.mark.parametrize('friction', [[0.9, 0.05, 0.05, 0.9], [0.05, 0.05, 0.9, 0.9]])
def test_wheels_with_grip_are_sound_while_others_spin(friction: list[float]) -> None:
    scenario = make_scenario('launch', {
        'duration': 1.5,
        'vehicle': {'body_model': 'eight_dof'},
        'plant': {'friction': friction},
        'commands': [{'at': 0.0, 'icr': 'straight', 'speed': 8.0}],
    })  # fmt: skip
    assert alarms(drive(scenario)) == []


@pytest.mark.parametrize('cycles', [-4, -2, 1, 2, 19])
def test_a_clock_that_jumps_by_some_cycles_is_named_at_once_and_costs_no_set_point(cycles: int) -> None:
    """The first beat after the jump has the first stamp that nobody could foresee."""
    outputs = drive(replace(slalom((1.5, 'clock', 'wrong', 0.005 * cycles)), duration=1.7))
    when, text = next((when, text) for when, text in said(outputs) if 'clock' in text)
    assert when == pytest.approx(1.505 + 0.005 * cycles)
    assert ('went back' if cycles < 0 else f'comes {0.005 * (cycles + 1):g} s after the last one') in text
    assert said(outputs, WHEEL_MODULES) == []


def test_in_real_time_a_beat_that_was_lost_is_no_jump_of_the_clock() -> None:
    scenario = slalom()
    for lockstep in (False, True):
        steering = IcrSteering(
            scenario.vehicle, scenario.steering, scenario.wheel_module, 0.005, 0.2, lockstep=lockstep
        )
        texts = [
            status.message
            for cycle in (1, 2, 4, 5)
            for output in steering.step(cycle * 5_000_000)
            if output.topic == '/diagnostics' and isinstance(output.value, Diagnostics)
            for status in output.value.statuses
        ]
        assert any('the clock' in text for text in texts) is lockstep
