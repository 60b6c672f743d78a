"""Every scenario that is shipped runs in all three modes, and all modes say the same."""

import pytest

from omni_vehicle_ros.scenarios import scenario_names

from .conftest import Lab, finish
from .test_modes import contents

pytestmark = [pytest.mark.graph, pytest.mark.slow]


@pytest.mark.parametrize('name', scenario_names())
def test_the_first_moments_in_three_modes(lab: Lab, name: str) -> None:
    """A tenth of a second of it, with the values of the file: offline, in one process, and in many."""
    found = {}
    for mode in ('offline', 'one-process', 'processes'):
        out, _ = finish(lab.command('run', name, '--set', 'duration=0.1', '--mode', mode, '--out', mode))
        assert ' 0 lost' in out
        found[mode] = contents(lab.path / mode)
    assert len(found['offline']['/odom']) == 21
    assert found['one-process'] == found['offline']
    assert found['processes'] == found['offline']
