"""A vehicle under floods of commands and garbage: it drives on, says which cycles it missed, and keeps none of it."""

import json
import re
import signal
import subprocess
from pathlib import Path

import pytest

from omni_vehicle_ros.bench.footprint import Footprint, footprint
from omni_vehicle_ros.bench.hosts.cases import circle
from omni_vehicle_ros.bench.hosts.vehicle import statuses
from omni_vehicle_ros.graph import node_parameters
from omni_vehicle_ros.interface import DRIVER, NODES
from omni_vehicle_ros.nodes.allocator import LARGE
from omni_vehicle_ros.nodes.plant import NEWCOMER
from omni_vehicle_ros.parameters import PacingParameters

from .conftest import Lab, finish, until

pytestmark = pytest.mark.graph

FLOODING = str(Path(__file__).with_name('flooding.py'))
ROLES = tuple(role for role in NODES if role != DRIVER)
PERIOD = 0.05
RATE, SECONDS = 10_000, 3.0
SAYS = 3.0
"""More than from one look at missed cycles to the next one [s]."""
MISSED = re.compile(r'(\d+) of \d+ cycles of .* were missed')


def test_a_flooded_vehicle_obeys_says_what_it_missed_and_keeps_nothing(lab: Lab) -> None:
    """The first flood fills queues and caches. What comes after that is what glibc keeps free for each thread."""
    vehicle = started(lab)
    flooder = lab.start('-W', 'ignore', FLOODING, 'siege', str(RATE), str(SECONDS))
    first = flooded(flooder, vehicle)
    flooder.send_signal(signal.SIGUSR1)
    second = flooded(flooder, vehicle)
    assert second.own - first.own < LARGE * second.threads
    flooder.kill()
    out, _ = finish(lab.start(FLOODING, 'drive', '60'))
    assert 'obeys' in out
    vehicle.terminate()
    out, _ = finish(vehicle)
    (figures,) = [json.loads(line.partition(' ')[2]) for line in out.splitlines() if line.startswith('punctual ')]
    counted, said = missed_cycles(lab.path / 'bag')
    assert counted <= said <= figures['missed']


def started(lab: Lab) -> 'subprocess.Popen[str]':
    """Return a recorded vehicle without a driver, in one process, when it suffers others in its namespace."""
    parameters = lab.path / 'parameters.yaml'
    pacing = PacingParameters(pacing='realtime', participants=ROLES)
    parameters.write_text(node_parameters(circle(PERIOD, 3600.0), lab.path, pacing), encoding='utf-8')
    words = '-m', 'omni_vehicle_ros.executables', 'nodes.vehicle', '--nodes', *ROLES
    vehicle = lab.start(*words, '--ros-args', '--params-file', str(parameters))
    until(lambda: any(stamp > NEWCOMER for stamp, _ in statuses(lab.path / 'bag')), 'the vehicle to drive')
    return vehicle


def flooded(flooder: 'subprocess.Popen[str]', vehicle: 'subprocess.Popen[str]') -> Footprint:
    """Wait until it has flooded; return what the vehicle holds."""
    assert flooder.stdout is not None
    words = flooder.stdout.readline().split()
    assert words[:1] == ['flooded'], flooder.communicate()[1]
    assert vehicle.poll() is None, vehicle.communicate()[1]
    assert int(words[1]) > 0.9 * RATE * SECONDS
    return footprint(vehicle.pid)


def missed_cycles(bag: Path) -> tuple[int, int]:
    """Return how many missed cycles the plant had counted some seconds before the end, and how many it has said."""
    found = list(statuses(bag))
    end = max(stamp for stamp, status in found if status.name == '/plant')
    early = [status for stamp, status in found if status.name == '/plant' and stamp < end - SAYS]
    texts = [MISSED.match(status.message) for _, status in found if status.name == '/plant: punctuality']
    counted = [int(value) for status in early for name, value in status.values if name == 'missed']
    return counted[-1], sum(int(text[1]) for text in texts if text)
