"""A vehicle under floods: it stays what it was, obeys afterwards, and holds no more memory than it must."""

import signal
from pathlib import Path

import pytest

from omni_vehicle_ros.bench.footprint import footprint

from .conftest import Lab, finish, until

pytestmark = pytest.mark.graph

FLOODING = str(Path(__file__).with_name('flooding.py'))
FLOODS = ('commands', '10000', '1'), ('garbage', '1'), ('huge', '1')
MOST = 100e6
"""What a process may hold more after messages of 10 MB than before: a few of them on their way [byte]."""


def test_after_floods_the_vehicle_obeys(lab: Lab) -> None:
    vehicle = lab.command('start', '--out', 'run')
    until(lambda: (lab.path / 'run' / 'bag' / 'bag_0.mcap').exists(), 'the vehicle to be up')
    nodes = [number for number in lab.left() if number != vehicle.pid]
    before = [footprint(number) for number in nodes]
    floods = [lab.start('-W', 'ignore', FLOODING, *words) for words in FLOODS]
    for flood in floods:
        out, _ = finish(flood)
        assert int(out.split()[-2]) > 0
    out, _ = finish(lab.start('-W', 'ignore', FLOODING, 'drive', '30'))
    assert 'obeys' in out
    for number, held in zip(nodes, before, strict=True):
        now = footprint(number)
        assert now.own < held.own + MOST
        assert now.threads <= held.threads + 1
    vehicle.send_signal(signal.SIGINT)
    _, errors = vehicle.communicate(timeout=60)
    # What others said where the plant speaks is in the bag, too; then there is a line instead of a report.
    assert vehicle.returncode in (0, 2)
    assert 'Traceback' not in errors + ''.join(log.read_text() for log in (lab.path / 'run' / 'log').iterdir())
