from collections.abc import Callable
from pathlib import Path

import pytest

SMALL = """
values: {radius: 5.0, speed: 4.0}
duration: 2.0
plant: {initial_speed: $speed}
commands:
  - {at: 0.0, icr: [0.0, $radius], speed: $speed}
  - {at: 1.0, icr: straight, traction: -500}
  - {at: 1.5, silent: true}
environment:
  - {at: 1.0, friction: 0.5}
"""


@pytest.fixture
def scenario_file(tmp_path: Path) -> Callable[..., str]:
    """Write a scenario file; returns its path."""

    def write(text: str = SMALL) -> str:
        path = tmp_path / 'small.yaml'
        path.write_text(text, encoding='utf-8')
        return str(path)

    return write
