"""Signals at any moment: no trace, nothing left behind, and what was recorded stays readable.

A signal is how a node and ``omni_vehicle start`` end: exit 0. A run that it ends says so by its exit code.
"""

import itertools
import os
import signal
from pathlib import Path

import pytest

from omni_vehicle_ros.bags import open_bag, read_messages

from .conftest import Lab, finish, until

pytestmark = pytest.mark.graph

LONG = """
duration: 600.0
side_slip_control: true
commands:
  - {at: 0.0, icr: [0.0, 20.0], speed: 3.0}
"""

NODES = ('plant', 'icr_steering', 'side_slip_controller', 'driver', 'wheel_module', 'recorder', 'vehicle')


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize('executable', NODES)
def test_a_node_alone_ends_cleanly(lab: Lab, executable: str, number: signal.Signals) -> None:
    """Each executable, up and without the others, ends at once; a second signal changes nothing."""
    arguments = ['-p', f'directory:={lab.path / "bag"}'] if executable == 'recorder' else []
    node = lab.node(executable, *arguments, namespace='front_left' if executable == 'wheel_module' else '')
    until(lambda: _connected(node.pid), f'{executable} to be up')
    node.send_signal(number)
    node.send_signal(number)
    finish(node)


def _connected(pid: int) -> bool:
    """Whether a process has opened the shared memory of Fast DDS: its context is there, its nodes are being made."""
    with open(f'/proc/{pid}/maps', encoding='utf-8') as maps:
        return 'fastrtps' in maps.read()


@pytest.mark.parametrize('moment', range(4))
def test_a_signal_during_a_start_leaves_no_trace(lab: Lab, moment: int) -> None:
    """The command stops its nodes whether they have only just been made or run for a while."""
    command = lab.command('run', str(lab.scenario(LONG)), '--out', 'run')
    log = lab.path / 'run' / 'log'
    marks = ('scenario.yaml', 'parameters.yaml', 'log/plant.log', 'bag')
    until(lambda: (lab.path / 'run' / marks[moment]).exists(), marks[moment])
    command.send_signal(signal.SIGINT)
    _, errors = finish(command, 128 + signal.SIGINT)
    assert 'interrupted' in errors
    for file in log.glob('*.log'):
        assert 'Traceback' not in file.read_text()
    assert not lab.left()


def test_a_second_signal_keeps_the_recording(lab: Lab) -> None:
    """What was recorded before is complete in the bag; the first one counts."""
    command = lab.command('run', str(lab.scenario(LONG)), '--out', 'run')
    bag = lab.path / 'run' / 'bag' / 'bag_0.mcap'
    until(lambda: bag.exists() and bag.stat().st_size > 200_000, 'a second or two of recording')
    command.send_signal(signal.SIGINT)
    command.send_signal(signal.SIGTERM)
    finish(command, 128 + signal.SIGINT)
    assert len(open_bag(bag.parent)['odom'].vx) > 100


def test_a_start_may_end_before_the_vehicle_is_up(lab: Lab) -> None:
    """Nodes that still load end at once."""
    vehicle = lab.command('start', '--out', 'run')
    until(lambda: (lab.path / 'run' / 'log' / 'plant.log').exists(), 'the first node')
    vehicle.send_signal(signal.SIGINT)
    _, errors = finish(vehicle)
    assert errors == 'stopped before the vehicle was up: there is nothing to analyse\n'


def test_nodes_end_when_their_command_is_killed(lab: Lab) -> None:
    """After kill -9 of the command all nodes end by themselves and the bag is closed."""
    command = lab.command('run', str(lab.scenario(LONG)), '--out', 'run')
    bag = lab.path / 'run' / 'bag' / 'bag_0.mcap'
    until(lambda: bag.exists() and bag.stat().st_size > 200_000, 'a second or two of recording')
    os.kill(command.pid, signal.SIGKILL)
    until(lambda: not lab.left(), 'the nodes to end', 30.0)
    stream = read_messages(bag.parent)
    assert sum(1 for _ in stream) > 1000
    assert stream.complete


def test_killed_recorder_keeps_all_but_the_last_moment(lab: Lab) -> None:
    """After kill -9 the file has no end, but holds nearly all that the plant had published."""
    command = lab.command('run', str(lab.scenario(LONG)), '--out', 'run')
    directory = lab.path / 'run' / 'bag'
    until(
        lambda: (directory / 'bag_0.mcap').exists() and (directory / 'bag_0.mcap').stat().st_size > 400_000,
        'some recording',
    )
    before = max(message.log_time for message in read_messages(directory) if message.topic == '/joint_states')
    recorder = [pid for pid in lab.left() if b'nodes.recorder' in Path(f'/proc/{pid}/cmdline').read_bytes()]
    os.kill(recorder[0], signal.SIGKILL)
    _, errors = finish(command, 2)
    assert 'recorder ended with code -9' in errors
    stream = read_messages(directory)
    times = [message.log_time for message in stream if message.topic == '/joint_states']
    assert times[-1] >= before
    assert not stream.complete
    gaps = {later - earlier for earlier, later in itertools.pairwise(times)}
    assert gaps == {5_000_000}


def test_run_goes_on_without_a_dead_module(lab: Lab) -> None:
    """Its wheel goes passive; bag, metrics and report are there in the end, and the command says which node died."""
    command = lab.command('run', str(lab.scenario(LONG)), '--set', 'duration=4', '--out', 'run')
    bag = lab.path / 'run' / 'bag' / 'bag_0.mcap'
    until(lambda: bag.exists() and bag.stat().st_size > 20_000, 'the first cycles')
    module = next(pid for pid in lab.left() if b'__ns:=/rear_left' in Path(f'/proc/{pid}/cmdline').read_bytes())
    os.kill(module, signal.SIGKILL)
    _, errors = finish(command, 2)
    assert 'rear_left/wheel_module ended with code -9' in errors
    assert open_bag(bag.parent)['odom'].stamp[-1] == 4.0
    assert (lab.path / 'run' / 'report.html').exists()
