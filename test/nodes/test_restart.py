"""Nodes that die and are started again: the rest goes on, and takes them back."""

import json
import os
import signal
from pathlib import Path

import numpy as np
import pytest

from omni_vehicle_ros.bags import open_bag, read_messages
from omni_vehicle_ros.faults import read_faults
from omni_vehicle_ros.messages import decode
from omni_vehicle_ros.shared_memory import existing, segments_of

from .conftest import Lab, finish, until
from .test_live import diagnostics

pytestmark = pytest.mark.graph

HELPER = str(Path(__file__).with_name('restarted.py'))

KILLED = """
duration: 2.5
side_slip_control: true
plant: {initial_speed: 2.0}
steering: {fault_reaction: false}
commands:
  - {at: 0.0, icr: [0.0, 10.0], speed: 2.0}
  - {at: 1.0, icr: [0.0, -10.0], speed: 2.0}
faults:
"""
COMPONENTS = ('front_left/module', 'icr_steering', 'driver')

OUTAGE = 0.2
"""Simulated time in which a node answers again that the others have waited for: some cycles [s]."""


def test_lock_step_takes_nodes_back_that_were_killed(lab: Lab) -> None:
    """Killed while the wheels point to the left, all three have a part in their turn to the right.

    The others wait until they are there again, so that it costs no simulated time to start them. The faults that kill
    them are said once: a driver that is started again does not say them to itself.
    """
    faults = ''.join(f'  - {{at: 0.8, component: {component}, failure: off}}\n' for component in COMPONENTS)
    out, _ = finish(lab.command('run', str(lab.scenario(KILLED + faults)), '--restart', '--out', 'run'))
    roles = {component.replace('/module', '/wheel_module') for component in COMPONENTS}
    assert all(f'{role} died and was started again, 1 x' in out for role in roles)
    assert json.loads((lab.path / 'run' / 'metrics.json').read_text())['restarts'] == dict.fromkeys(roles, 1)
    bag = open_bag(lab.path / 'run' / 'bag')
    angles = bag['joint_states'].position
    assert np.isfinite(angles).all()
    assert angles[150, :2].min() > 0.05
    assert angles[-1, :2].max() < -0.05
    for topic in ('front_left/state', 'commanded_twist', 'driver/step'):
        assert bag[topic].stamp[-1] == pytest.approx(2.5)
        assert np.diff(bag[topic].stamp).max() < OUTAGE
    told = bag['front_left/command'].position[-1, 0] + bag['front_left/trim'].position[-1, 0]
    assert angles[-1, 0] == pytest.approx(told, abs=2e-3)
    said = [m for m in read_messages(lab.path / 'run' / 'bag') if m.topic == '/faults']
    found = [fault.component for m in said for fault in read_faults(decode(m.type_name, m.data))[0]]
    assert found == list(COMPONENTS)


def test_a_live_vehicle_takes_a_killed_module_back(lab: Lab) -> None:
    """In real time, killed from outside; nobody takes the dead one for a second speaker, and it leaves no memory."""
    vehicle = lab.command('start', '--restart', '--set', 'steering.fault_reaction=false', '--out', 'run')
    until(lambda: (lab.path / 'run' / 'bag' / 'bag_0.mcap').exists(), 'the vehicle to be up')
    driver = lab.start(HELPER)
    assert driver.stdout is not None
    assert driver.stdout.readline() == 'left\n'
    (module,) = modules(lab)
    segments = segments_of(module)
    assert existing(segments)
    os.kill(module, signal.SIGKILL)
    until(lambda: modules(lab) not in ([], [module]), 'the module that takes its place')
    driver.send_signal(signal.SIGUSR1)
    out, _ = finish(driver)
    assert out == 'right\n'
    vehicle.send_signal(signal.SIGINT)
    out, _ = finish(vehicle)
    assert 'front_left/wheel_module died and was started again, 1 x' in out
    assert existing(segments) == []
    assert not [text for *_, text in diagnostics(lab.path / 'run' / 'bag') if 'publishers (' in text]


def modules(lab: Lab) -> list[int]:
    """Return the processes of the front left module."""
    found = []
    for number in lab.left():
        try:
            if b'__ns:=/front_left' in Path(f'/proc/{number}/cmdline').read_bytes():
                found.append(number)
        except OSError:
            continue
    return found


def test_only_processes_are_started_again(lab: Lab) -> None:
    _, errors = finish(lab.command('run', 'demo', '--restart', '--mode', 'offline'), 2)
    assert errors == (
        'error: --restart: starts processes again, and mode offline has none for its nodes; choose processes\n'
    )
