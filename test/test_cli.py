"""The command line: what is wrong is one line and exit code 2, and nothing is written; a signal is 128 + its number."""

import json
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import pytest

from omni_vehicle_ros.bags import read_messages
from omni_vehicle_ros.checks import check_commands
from omni_vehicle_ros.errors import RunError
from omni_vehicle_ros.results import new_directory
from omni_vehicle_ros.scenarios import Command, load_scenario, scenario_names

COMMAND = (sys.executable, '-m', 'omni_vehicle_ros.executables', 'cli')


def omni_vehicle(path: Path, *arguments: str) -> 'subprocess.CompletedProcess[str]':
    return subprocess.run([*COMMAND, *arguments], cwd=path, capture_output=True, text=True, timeout=120, check=False)


def interrupt(path: Path, number: signal.Signals, mark: str, size: int, *arguments: str) -> str:
    """Send a signal, twice, to a command once it has made a directory or a file of a size; return its last words."""
    command = subprocess.Popen(
        [*COMMAND, *arguments], cwd=path, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        text=True,
    )
    end = time.monotonic() + 60.0
    while not (path / mark).exists() or (path / mark).stat().st_size < size:
        assert command.poll() is None and time.monotonic() < end, f'no {mark}'
        time.sleep(0.01)
    command.send_signal(number)
    command.send_signal(number)
    _, errors = command.communicate(timeout=60.0)
    assert command.returncode == 128 + number, errors
    assert 'Traceback' not in errors
    return errors.splitlines()[-1]


@pytest.mark.parametrize(
    ('arguments', 'words'),
    [
        (('run', 'simple_turnin'), "did you mean 'simple_turning'"),
        (('run', 'bank'), "did you mean 'thesis/bank'"),
        (('run', 'missing.yaml'), 'missing.yaml'),
        (('run', 'bad.yaml'), 'line 1'),
        (('run', 'demo', '--set', 'speeed=3'), "did you mean 'speed'"),
        (('run', 'demo', '--set', 'speed'), 'speed'),
        (('run', 'demo', '--set', 'vehicle.mass=-1'), 'vehicle: mass: -1 is outside 1 .. 100000 kg'),
        (('run', 'demo', '--set', 'speed=nan'), 'speed'),
        (('run', 'simple_turning', '--set', 'radius=0'), 'simple_turning.yaml with radius=0: commands[0]: icr: [0, 0]'),
        (('run', 'simple_turning', '--set', 'radius=0.5'), 'commands[0]: driver/icr: ICR 0.500 m to the side is'),
        (('run', 'demo', '--mode', 'thread'), "'thread' is not one of processes, one-process, offline"),
        (('run', 'demo', '--pacing', 'slow'), "'slow' is not one of lockstep, realtime"),
        (('run', 'demo', '--mode', 'offline', '--pacing', 'realtime'), 'no wall clock'),
        (('run', 'demo', '--namespace', '2 cars'), "'2 cars'"),
        (('run', 'demo', '--out', 'there'), 'there: exists already'),
        (('run', 'demo', '--out', 'bad.yaml/run'), 'bad.yaml/run'),
        (('start', 'demo', '--out', 'there'), 'there: exists already'),
        (('analyse', 'no_bag'), 'no_bag does not exist'),
        (('analyse', 'bad.yaml', '--out', 'new/one'), 'bad.yaml is no bag'),
        (('analyse', 'there'), 'there is no bag'),
        (('analyse', 'bad.yaml', '--scenario', 'no_scenario'), 'no_scenario'),
        (('run', 'demo', '--commands', 'nothing', '--out', 'new'), 'nothing does not exist; name a bag directory'),
        (('replay', 'nothing'), 'nothing does not exist; name a bag directory'),
        (('replay', 'there'), 'there is no bag that can be read here'),
        (('replay', 'bad.yaml'), "bad.yaml is no bag that can be read here: Unrecognized storage format '.yaml'"),
        (('replay', 'there', '--rate', '0'), '--rate: 0 is outside 0.001 .. 1000'),
        (('replay', 'there', '--out', 'new'), '--out: goes with --commands-only'),
        (('replay', 'there', '--commands-only', '--out', 'new', '--loop'), '--out: goes with --commands-only'),
        (('replay', 'there', '--commands-only', '--out', 'new'), 'scenario.yaml does not exist'),
        (('replay', 'there', '--commands-only', '--clock'), '--clock: the vehicle that takes the commands has'),
        (('export', 'nothing', '--out', 'new'), 'nothing does not exist; name a bag directory'),
        (('export', 'there', '--out', 'new'), 'holds no MCAP file'),
        (('export', 'there', '--format', 'xls'), "'xls' is not one of parquet, csv"),
    ],
)
def test_what_is_wrong_is_one_line(tmp_path: Path, arguments: tuple[str, ...], words: str) -> None:
    (tmp_path / 'there').mkdir()
    (tmp_path / 'bad.yaml').write_text('duration: [')
    before = sorted(tmp_path.rglob('*'))
    result = omni_vehicle(tmp_path, *arguments)
    assert result.returncode == 2
    assert words in result.stderr
    assert 'Traceback' not in result.stderr
    assert len(result.stderr.strip().splitlines()) == 1
    assert sorted(tmp_path.rglob('*')) == before


def test_offline_run_leaves_bag_metrics_and_report(tmp_path: Path) -> None:
    """R = 5 m at 15 km/h: the radius is a little wider than commanded, the speed is held exactly."""
    result = omni_vehicle(
        tmp_path,
        'run',
        'simple_turning',
        '--set',
        'radius=-5',
        '--set',
        'duration=3',
        '--mode',
        'offline',
        '--out',
        'run',
    )
    assert result.returncode == 0, result.stderr
    assert 'run/report.html' in result.stdout
    metrics = json.loads((tmp_path / 'run' / 'metrics.json').read_text())
    assert metrics['speed']['ratio'] == 1.0
    assert metrics['path']['radius'] == pytest.approx(-5.24, abs=0.02)
    slips = [
        metrics['side_slip'][wheel]['steady_state']
        for wheel in ('front_left', 'front_right', 'rear_left', 'rear_right')
    ]
    # A right turn: the right wheels are on the inside; every tyre pushes to the right.
    assert all(slip < 0.0 for slip in slips)
    assert slips[1] < slips[0]
    assert (tmp_path / 'run' / 'report.html').stat().st_size > 50_000
    assert (tmp_path / 'run' / 'bag' / 'metadata.yaml').exists()


def test_help_and_scenarios(tmp_path: Path) -> None:
    listed = omni_vehicle(tmp_path, 'scenarios').stdout
    lines = [line for line in listed.splitlines() if line and not line.startswith('files: ')]
    assert [line.split()[0] for line in lines] == list(scenario_names())
    assert all(30 < len(line) <= 100 for line in lines)
    assert '--set' in omni_vehicle(tmp_path, 'run', '--help').stdout
    assert omni_vehicle(tmp_path, '--version').stdout.strip() == '0.1.0'


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM])
def test_an_interrupted_map_leaves_nothing(tmp_path: Path, number: signal.Signals) -> None:
    """Its directory and the one above were made by it, and hold nothing yet."""
    assert interrupt(tmp_path, number, 'new/map', 0, 'map', '--out', 'new/map') == 'interrupted'
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM])
def test_an_interrupted_offline_run_leaves_its_bag(tmp_path: Path, number: signal.Signals) -> None:
    """The bag is closed: what was recorded before can be read, and the last line says where and how much it is."""
    settings = ('--set', 'duration=600', '--mode', 'offline', '--out', 'run')
    words = interrupt(tmp_path, number, 'run/bag/bag_0.mcap', 100_000, 'run', 'simple_turning', *settings)
    assert not (tmp_path / 'run' / 'report.html').exists()
    stream = read_messages(tmp_path / 'run' / 'bag')
    times = [message.log_time for message in stream]
    assert max(times) < 600_000_000_000
    assert stream.complete
    assert words == f'interrupted; {len(times)} messages lie in run/bag'


@pytest.mark.parametrize('name', scenario_names())
def test_all_commands_of_the_scenarios_can_be_followed(name: str) -> None:
    check_commands(load_scenario(name))


def test_commands_that_no_wheel_reaches_are_refused() -> None:
    scenario = replace(load_scenario('demo'), commands=(Command(0.0), Command(1.0, cmd_vel=(0.0, 1.0, 0.0))))
    check_commands(scenario)
    with pytest.raises(RunError, match=r'demo: commands\[1\]: cmd_vel: .* beyond steer_limit, 1\.2 rad'):
        check_commands(replace(scenario, steering=replace(scenario.steering, steer_limit=1.2)))


def test_a_new_directory_is_taken_away_again_if_it_stays_empty(tmp_path: Path) -> None:
    """So are those above it that were made for it, up to the first that holds something; others never are."""
    (tmp_path / 'old').mkdir()
    with pytest.raises(ZeroDivisionError), new_directory(tmp_path / 'old' / 'a' / 'b'):
        _ = 1 / 0
    assert list(tmp_path.rglob('*')) == [tmp_path / 'old']
    with new_directory(tmp_path / 'c' / 'd' / 'e'):
        (tmp_path / 'c' / 'kept').touch()
    assert sorted(tmp_path.rglob('*')) == [tmp_path / name for name in ('c', 'c/kept', 'old')]
    with pytest.raises(RunError, match='exists already'), new_directory(tmp_path / 'old'):
        pass
    with pytest.raises(RunError, match='Not a directory'), new_directory(tmp_path / 'c' / 'kept' / 'f'):
        pass
    assert sorted(tmp_path.rglob('*')) == [tmp_path / name for name in ('c', 'c/kept', 'old')]
