"""Which nodes may be on another machine, as the environment has it."""

import pytest

from omni_vehicle_ros.nodes.ports import on_this_machine

NAMES = 'ROS_AUTOMATIC_DISCOVERY_RANGE', 'ROS_STATIC_PEERS', 'ROS_DISCOVERY_SERVER'


@pytest.mark.parametrize(('values', 'here'), [
    (('LOCALHOST', None, None), True), (('SUBNET', None, None), False), ((None, None, None), False),
    (('LOCALHOST', '10.0.0.1;10.0.0.2', None), False), (('LOCALHOST', None, '10.0.0.1:11811'), False),
])  # fmt: skip
def test_all_are_here_only_if_nothing_leads_elsewhere(monkeypatch, values, here):
    for name, value in zip(NAMES, values, strict=True):
        monkeypatch.delenv(name, raising=False)
        if value is not None:
            monkeypatch.setenv(name, value)
    assert on_this_machine() is here
