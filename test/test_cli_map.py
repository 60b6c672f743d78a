"""The command ``omni_vehicle map``: what it leaves, and how it refuses."""

import csv
import subprocess
import sys
from pathlib import Path

import pytest

from omni_vehicle_ros.model.dynamics import Environment
from omni_vehicle_ros.model.steady_turn import limit_speed
from omni_vehicle_ros.parameters import VehicleParameters

PNG = b'\x89PNG\r\n\x1a\n'


def draw_map(path: Path, *arguments: str) -> 'subprocess.CompletedProcess[str]':
    command = [sys.executable, '-m', 'omni_vehicle_ros.executables', 'cli', 'map', *arguments]
    return subprocess.run(command, cwd=path, capture_output=True, text=True, timeout=120, check=False)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / 'there').mkdir()
    (tmp_path / 'car.yaml').write_text('/**:\n  ros__parameters: {mass: 1500.0, friction: [0.6, 0.6, 0.6, 0.6]}\n')
    return tmp_path


def test_a_map_is_drawn_and_its_numbers_lie_beside_it(folder: Path) -> None:
    result = draw_map(folder, '--vehicle', 'car.yaml', '--radius', '2:3', '--speed', '4:6', '--out', 'map')
    assert result.returncode == 0, result.stderr
    assert (folder / 'map' / 'map.png').read_bytes().startswith(PNG)
    with (folder / 'map' / 'limit.csv').open(newline='') as file:
        limits = list(csv.DictReader(file))
    with (folder / 'map' / 'map.csv').open(newline='') as file:
        points = list(csv.DictReader(file))
    assert len(points) == len(limits) ** 2
    heavy, road = VehicleParameters(mass=1500.0), Environment(friction=(0.6,) * 4)
    for row in (limits[0], limits[-1]):
        expected = limit_speed(heavy, float(row['radius']), road)
        assert float(row['limit_speed']) == pytest.approx(expected.speed, abs=1e-4)
    assert 'car, friction 0.6: limit speed' in result.stdout
    assert f'{float(limits[0]["limit_speed"]):.3f}' in result.stdout
    assert 'map/map.png' in result.stdout
    assert '61 of 61' in result.stderr


@pytest.mark.parametrize(
    ('arguments', 'words'),
    [
        (('--vehicle', 'nowhere.yaml'), 'nowhere.yaml: No such file'),
        (('--set', 'mass=-1'), 'mass: -1 is outside'),
        (('--friction', '3'), 'friction: 3.0 is outside 0.01 .. 2'),
        (('--radius', '20:2'), "--radius: '20:2' must be two numbers above 0"),
        (('--radius', '0.5:5'), 'radius: 0.5 m must be beyond half of the track, 0.718 m'),
        (('--speed', '1:1e6'), '--speed: 1e+06 m/s is above 100 m/s, the most that a map goes to; give LOW:HIGH'),
        (('--radius', '2:1e6'), '--radius: 1e+06 m is above 10000 m, the most that a map goes to'),
        (('--set', 'friction=0.5'), 'give --friction'),
        (('--out', 'there'), 'there: exists already'),
    ],
)
def test_what_is_wrong_is_one_line(folder: Path, arguments: tuple[str, ...], words: str) -> None:
    before = sorted(folder.rglob('*'))
    result = draw_map(folder, *arguments)
    assert result.returncode == 2
    assert words in result.stderr
    assert 'Traceback' not in result.stderr
    assert len(result.stderr.strip().splitlines()) == 1
    assert sorted(folder.rglob('*')) == before
