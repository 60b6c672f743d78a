"""Studies of a scenario, small enough for a test."""

from pathlib import Path

import pytest

from omni_vehicle_ros.sweep.study import read_study

TURN = 'simple_turning'


@pytest.fixture
def study():
    """Return a grid of short turns in a few chunks."""
    return read_study(TURN, ['radius=2:6:13', 'speed=1:4:16'], ['duration=1.2'])


def parts(directory: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in (directory / 'turns').iterdir()}
