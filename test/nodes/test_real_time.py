"""A run in real time says how punctual it was and what it took."""

import json

import pytest

from omni_vehicle_ros.interface import NODES

from .conftest import Lab, finish

pytestmark = pytest.mark.graph

DRIVE = """
duration: 2.0
side_slip_control: true
commands:
  - {at: 0.0, icr: straight, speed: 2.0}
"""


def test_punctuality_cpu_time_and_memory_are_in_metrics_and_report(lab: Lab) -> None:
    """One answer of each of four modules a cycle; a process takes less than two cores; the report says so."""
    scenario = str(lab.scenario(DRIVE))
    finish(lab.command('run', scenario, '--pacing', 'realtime', '--out', 'run'))
    found = json.loads((lab.path / 'run' / 'metrics.json').read_text())['real_time']
    assert found['period'] == 0.005
    assert 0 <= found['missed'] <= found['cycles'] > 0
    assert 0.0 < found['answer']['p50'] <= found['answer']['p99'] <= found['answer']['largest']
    assert set(found['cpu']) == set(found['memory']) == set(NODES)
    assert all(0.0 <= share < 2.0 for share in found['cpu'].values())
    assert all(20e6 < size < 500e6 for size in found['memory'].values())
    page = (lab.path / 'run' / 'report.html').read_text()
    assert f'of {found["cycles"]} cycles of 5 ms were missed' in page


def test_lock_step_has_no_wall_clock_to_tell_of(lab: Lab) -> None:
    """The metrics of a lock-step run depend on nothing but the scenario."""
    finish(lab.command('run', str(lab.scenario(DRIVE)), '--mode', 'one-process', '--out', 'run'))
    assert 'real_time' not in json.loads((lab.path / 'run' / 'metrics.json').read_text())
