"""The command line: what is wrong is one line and exit code 2, and nothing is written."""

import json
import subprocess
import sys
from pathlib import Path

import pytest


def omni_vehicle(path: Path, *arguments: str) -> 'subprocess.CompletedProcess[str]':
    command = [sys.executable, '-m', 'omni_vehicle_ros.executables', 'cli', *arguments]
    return subprocess.run(command, cwd=path, capture_output=True, text=True, timeout=120, check=False)


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
        (('run', 'demo', '--mode', 'thread'), "'thread' is not one of processes, one-process, offline"),
        (('run', 'demo', '--pacing', 'slow'), "'slow' is not one of lockstep, realtime"),
        (('run', 'demo', '--mode', 'offline', '--pacing', 'realtime'), 'no wall clock'),
        (('run', 'demo', '--namespace', '2 cars'), "'2 cars'"),
        (('run', 'demo', '--out', 'there'), 'there: exists already'),
        (('run', 'demo', '--out', 'bad.yaml/run'), 'bad.yaml/run'),
        (('start', 'demo', '--out', 'there'), 'there: exists already'),
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
    assert {'simple_turning', 'thesis/bank'} <= {line.split(' ')[0] for line in listed.splitlines()}
    assert '--set' in omni_vehicle(tmp_path, 'run', '--help').stdout
    assert omni_vehicle(tmp_path, '--version').stdout.strip() == '0.1.0'
