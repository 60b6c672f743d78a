"""One scenario in three modes: in lock step they say the same, byte for byte, and so do two runs of one mode."""

import json
import signal
from collections import defaultdict
from pathlib import Path

import pytest

from omni_vehicle_ros.bags import read_messages

from .conftest import Lab, finish, until

pytestmark = pytest.mark.graph


def contents(directory: Path) -> dict[str, list[tuple[int, bytes]]]:
    """Return time and bytes of every message of a run, by topic."""
    messages = defaultdict(list)
    for message in read_messages(directory / 'bag'):
        messages[message.topic].append((message.log_time, message.data))
    return dict(messages)


def last_time(directory: Path) -> float:
    """Return the time of the last message in a bag that is still being written [s]."""
    return max((message.log_time for message in read_messages(directory / 'bag')), default=0) * 1e-9


def run(lab: Lab, mode: str, name: str) -> Path:
    """Run the short scenario; return its directory."""
    out, _ = finish(lab.command('run', str(lab.scenario()), '--mode', mode, '--out', name))
    assert ' 0 lost' in out
    return lab.path / name


def test_modes_agree_and_a_run_repeats_itself(lab: Lab) -> None:
    """Processes, twice, one process, and plain Python give the same bytes on every topic."""
    runs = [
        run(lab, 'offline', 'offline'),
        run(lab, 'one-process', 'one'),
        run(lab, 'processes', 'a'),
        run(lab, 'processes', 'b'),
    ]
    expected = contents(runs[0])
    assert len(expected['/odom']) == 401
    assert len(expected['/front_left/steer_trim']) == 401
    for directory in runs[1:]:
        found = contents(directory)
        assert found.keys() == expected.keys()
        for topic, messages in expected.items():
            assert found[topic] == messages, f'{topic} in {directory.name}'
    metrics = [json.loads((directory / 'metrics.json').read_text()) for directory in runs]
    assert all(one == metrics[0] for one in metrics)


def test_two_vehicles_drive_side_by_side(lab: Lab) -> None:
    """Two namespaces, one owner of /clock: both runs are complete and neither hears the other."""
    alone = run(lab, 'offline', 'alone')
    scenario = str(lab.scenario())
    first = lab.command('run', scenario, '--namespace', 'one', '--out', 'one')
    second = lab.command('run', scenario, '--namespace', 'two', '--no-clock', '--out', 'two')
    finish(first)
    finish(second)
    expected = contents(alone)
    one, two = contents(lab.path / 'one'), contents(lab.path / 'two')
    for topic in ('/odom', '/front_left/state', '/rear_right/command'):
        assert one[f'/one{topic}'] == two[f'/two{topic}'] == expected[topic]
    assert len(one['/clock']) == 401
    assert '/clock' not in two


def test_a_second_vehicle_of_the_same_name_gives_way(lab: Lab) -> None:
    """Two graphs in one namespace would drive each other's wheels: the newcomer ends and says why."""
    first = lab.command('start', '--out', 'first')
    until(lambda: (lab.path / 'first' / 'bag' / 'bag_0.mcap').exists(), 'the first vehicle')
    until(lambda: last_time(lab.path / 'first') > 6.0, 'more than the five seconds of a newcomer')
    _, errors = finish(lab.command('start', '--out', 'second'), 2)
    assert 'another node publishes /joint_states' in errors
    assert first.poll() is None
    first.send_signal(signal.SIGINT)
    finish(first)
