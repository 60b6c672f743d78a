"""Every scenario that is shipped runs in all three modes, and all modes say the same."""

import pytest

from omni_vehicle_ros.run import run_scenario
from omni_vehicle_ros.scenarios import load_scenario, scenario_names

from .conftest import Lab, finish
from .test_modes import contents

pytestmark = [pytest.mark.graph, pytest.mark.slow]


# Scenarios of faults begin alike; test_faults has what comes later.
NAMES = [name for name in scenario_names() if not name.startswith('faults/') or name == 'faults/steering_stuck']


@pytest.mark.parametrize('name', NAMES)
def test_the_first_moments_in_three_modes(lab: Lab, name: str) -> None:
    """A tenth of a second of it, with the values of the file: offline, in one process, and in many."""
    short = 'duration=0.1'
    run_scenario(load_scenario(name, [short]), lab.path / 'offline', mode='offline')
    expected = contents(lab.path / 'offline')
    assert len(expected['/odom']) == 21
    for mode in ('one-process', 'processes'):
        out, _ = finish(lab.command('run', name, '--set', short, '--mode', mode, '--out', mode))
        assert ' 0 lost' in out
        assert contents(lab.path / mode) == expected
