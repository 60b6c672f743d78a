"""Scenarios of faults, offline: nothing but numbers, wheels within range and rate, and what each fault is to do."""

import math

import numpy as np
import pytest

from omni_vehicle_ros.campaign.checks import numbers
from omni_vehicle_ros.components.component import Output
from omni_vehicle_ros.faults import read_faults
from omni_vehicle_ros.scenarios import Scenario, load_scenario, scenario_names
from omni_vehicle_ros.scenarios.scenario import make_scenario
from omni_vehicle_ros.simulation import Simulation
from omni_vehicle_ros.wheels import WHEELS

NAMES = [name for name in scenario_names() if name.startswith('faults/')]


def drive(scenario: Scenario) -> list[Output]:
    outputs: list[Output] = []
    Simulation(scenario, outputs.append).run()
    return outputs


def truth(outputs: list[Output], topic: str) -> list:
    """Return what is true by cycle, be the sensor right or not."""
    found = {output.value.stamp: output.value for output in outputs if output.topic == topic}
    found |= {output.value.stamp: output.value for output in outputs if output.topic == f'{topic}/truth'}
    return [found[stamp] for stamp in sorted(found)]


@pytest.mark.parametrize('name', NAMES)
def test_a_scenario_runs_whatever_fails(name: str) -> None:
    """Its first 2.6 s; each fault begins at 2 s or before."""
    scenario = load_scenario(name, ['duration=2.6'])
    outputs = drive(scenario)
    assert not {output.topic for output in outputs if not all(map(math.isfinite, numbers(output.value)))}
    said = [fault for output in outputs if output.topic == 'faults' for fault in read_faults(output.value)[0]]
    assert set(said) >= {event.fault for event in scenario.faults if event.at < 2.1}
    angles = np.array([joints.position[:4] for joints in truth(outputs, 'joint_states')])
    assert np.abs(angles).max() <= scenario.wheel_module.steer_limit
    if not name.endswith('clock_jump'):
        rates = np.abs(np.diff(angles, axis=0)) / scenario.plant.control_period
        assert rates.max() <= scenario.wheel_module.steer_rate_limit * (1 + 1e-6)


def test_a_stuck_wheel_stays_and_the_others_steer_on() -> None:
    outputs = drive(load_scenario('faults/steering_stuck', ['duration=4.0']))
    angles = np.array([joints.position[:4] for joints in truth(outputs, 'joint_states')])
    assert np.ptp(angles[402:, 0]) == 0.0
    assert np.ptp(angles[402:, 1:], axis=0).min() > 0.02


def test_a_castering_wheel_carries_no_side_force() -> None:
    outputs = drive(load_scenario('faults/steering_castering', ['duration=4.0', 'steering.fault_reaction=false']))
    forces = np.array([[force[1] for force in o.value.forces] for o in outputs if o.topic == 'tyres/force'])
    slips = np.array([joints.position for joints in truth(outputs, 'tyres/side_slip')])
    assert np.abs(forces[300:400, 0]).min() > 100.0
    assert np.abs(forces[460:, 0]).max() < 0.1 * np.abs(forces[460:, 1]).max()
    assert np.abs(slips[460:, 0]).max() < 0.1 * np.abs(slips[460:, 1]).max()


def test_a_locked_wheel_stands_still_and_brakes_with_all_its_friction() -> None:
    outputs = drive(load_scenario('faults/brake_locked', ['duration=2.4']))
    speeds = np.array([joints.velocity[4:] for joints in truth(outputs, 'joint_states')])
    forces = np.array([o.value.forces[0] for o in outputs if o.topic == 'tyres/force'])[405:]
    use = np.array([joints.effort[0] for joints in truth(outputs, 'tyres/side_slip')])[405:]
    assert not speeds[402:, 0].any()
    assert speeds[402:, 1:].min() > 1.0
    assert forces[:, 0].max() < 0.0
    assert (np.hypot(forces[:, 0], forces[:, 1]) <= 0.9 * forces[:, 2] * (1 + 1e-9)).all()
    assert use.min() > 0.95


def test_the_clock_jumps_and_the_drive_goes_on() -> None:
    outputs = drive(load_scenario('faults/clock_jump', ['duration=3.6', 'later=3.0']))
    stamps = np.array([output.value.stamp for output in outputs if output.topic == 'joint_states'])
    steps = np.diff(stamps) // 5_000_000
    assert sorted(steps[steps != 1]) == [-99, 101]
    speed = np.array([output.value.vx for output in outputs if output.topic == 'odom'])
    assert speed.min() > 3.0


@pytest.mark.parametrize('wheel', WHEELS)
def test_a_silent_module_leaves_its_wheel_passive(wheel: str) -> None:
    fault = {'at': 0.5, 'component': f'{wheel}/module', 'failure': 'off'}
    base = load_scenario('faults/module_killed').to_mapping()
    outputs = drive(make_scenario('x', {**base, 'duration': 0.7, 'faults': [fault]}))
    states = [output.value for output in outputs if output.topic == f'{wheel}/state']
    assert states[-1].stamp == 495_000_000
    joints = truth(outputs, 'joint_states')[-1]
    assert joints.effort[4 + WHEELS.index(wheel)] == 0.0
    text = [s.message for o in outputs if o.topic == '/diagnostics' for s in o.value.statuses if s.name == '/plant']
    assert f'no answer from {wheel}/wheel_module: no torque, steer angle held' in text
