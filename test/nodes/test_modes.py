"""One scenario in three modes: in lock step they say the same, byte for byte, and so do two runs of one mode."""

import json
import signal
from collections import defaultdict
from pathlib import Path

import numpy as np
import pytest

from omni_vehicle_ros.bags import open_bag, read_messages
from omni_vehicle_ros.nodes.plant import NEWCOMER
from omni_vehicle_ros.thesis.bounds import SlipBound
from omni_vehicle_ros.wheels import WHEELS

from .conftest import Lab, finish, until

pytestmark = pytest.mark.graph


def contents(directory: Path) -> dict[str, list[tuple[int, bytes]]]:
    """Return time and bytes of every message of a run, by topic."""
    messages = defaultdict(list)
    for message in read_messages(directory / 'bag'):
        messages[message.topic].append((message.log_time, message.data))
    return dict(messages)


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
    assert len(expected['/front_left/trim']) == len(expected['/commanded_twist']) == 401
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
    """Two graphs in one namespace would drive each other's wheels: the newcomer ends and says why.

    For how long the first plant has been there is a matter of wall time, as the bag's file tells it without being read:
    on a busy machine the vehicle's own time falls behind, and reading all again and again holds it up even more.
    """
    first = lab.command('start', '--out', 'first')
    bag = lab.path / 'first' / 'bag' / 'bag_0.mcap'
    until(lambda: bag.exists() and bag.stat().st_size > 20_000, 'the first vehicle')
    begun = bag.stat().st_mtime
    until(lambda: bag.stat().st_mtime > begun + NEWCOMER, 'a first vehicle that is no newcomer')
    _, errors = finish(lab.command('start', '--out', 'second'), 2)
    assert 'another node publishes /joint_states' in errors
    assert first.poll() is None
    first.send_signal(signal.SIGINT)
    finish(first)


SLIP_CONTROL = """
duration: 5.0
side_slip_control: true
plant: {constant_speed: true, initial_speed: 4.1667}
commands:
  - {at: 0.0, icr: [0.0, 5.0], speed: 4.1667}
"""


def test_side_slip_control_is_stable_over_dds(lab: Lab) -> None:
    """Gains (5, 5, 0, 0), real actuators: the loop settles at angle = set-point - K slip, and slips less."""
    for name, gains in (('with', '[5.0, 5.0, 0.0, 0.0]'), ('without', '[0.0, 0.0, 0.0, 0.0]')):
        scenario = str(lab.scenario(SLIP_CONTROL))
        finish(lab.command('run', scenario, '--set', f'side_slip.proportional_gains={gains}', '--out', name))
    bag, other = open_bag(lab.path / 'with' / 'bag'), open_bag(lab.path / 'without' / 'bag')
    angle, slip = bag['joint_states'].position[-100:, :4], bag['tyres/side_slip'].position[-100:]
    set_point = [bag[f'{wheel}/command'].position[-1, 0] for wheel in WHEELS]
    gains = np.array([5.0, 5.0, 0.0, 0.0])
    assert np.ptp(angle, axis=0).max() < 1e-3
    assert angle[-1] == pytest.approx(set_point - gains * slip[-1], abs=1e-3)
    uncontrolled = other['tyres/side_slip'].position[-1]
    assert np.all(slip[-1, :2] < 0.75 * uncontrolled[:2])


ALLOCATION = """
duration: 4.0
side_slip_control: true
side_slip: {controller: allocation, allocation_traction: $traction}
values: {traction: true}
plant: {initial_speed: 4.1667}
commands:
  - {at: 0.0, icr: [0.0, 5.0], speed: 4.1667}
"""


@pytest.mark.parametrize('traction', [True, False])
def test_allocation_over_dds_reaches_the_bound_on_the_commanded_path(lab: Lab, traction: bool) -> None:
    """Real actuators, three degrees of freedom: the worst slip within 5 % of the least one, the radius within 2 %."""
    scenario, setting = str(lab.scenario(ALLOCATION)), f'traction={str(traction).lower()}'
    for mode in ('processes', 'offline'):
        finish(lab.command('run', scenario, '--set', setting, '--mode', mode, '--out', mode))
    assert contents(lab.path / 'processes') == contents(lab.path / 'offline')
    bag = open_bag(lab.path / 'processes' / 'bag')
    slip, speed = bag['tyres/side_slip'].position[-200:], np.hypot(bag['odom'].vx, bag['odom'].vy)[-200:]
    drives = 'left and right' if traction else 'alike'
    assert slip.max() < 1.05 * SlipBound(5.0, float(speed.mean()), drives).work().worst
    assert speed / bag['odom'].yaw_rate[-200:] == pytest.approx(5.0, rel=0.02)
    assert np.ptp(slip, axis=0).max() < 0.01 * slip.max()
    torque = np.array([bag[f'{wheel}/trim'].effort[-1, 1] for wheel in WHEELS])
    assert (np.abs(torque) > 10.0).all() if traction else not torque.any()
