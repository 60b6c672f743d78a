"""Real graphs over Fast DDS: each test in a domain of its own, and nothing left running after it."""

import contextlib
import os
import signal
import subprocess
import sys
import time
import uuid
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from .domains import held_domain

TOKEN = 'OMNI_VEHICLE_TEST'
LIMIT = 120.0

SHORT = """
description: a short drive with everything in the loop
duration: 2.0
side_slip_control: true
plant: {initial_speed: 3.0}
commands:
  - {at: 0.0, icr: straight, speed: 3.0}
  - {at: 0.5, icr: [0.5, 12.0], speed: 4.0}
  - {at: 1.2, teleop: [2.0, 1.0, 0.2]}
  - {at: 1.3, cmd_vel: [2.0, 1.0, 0.2]}
  - {at: 1.9, cmd_vel: [2.0, 1.0, 0.2], emergency_stop: true}
environment:
  - {at: 1.0, bank: 0.02, wind: 3.0, friction: 0.7}
"""


class Lab:
    """Starts processes in one ROS domain and knows which of them are still there.

    Attributes
    ----------
    path
        A directory for files.
    environment
        Of all processes.
    """

    def __init__(self, path: Path, domain: int) -> None:
        self.path = path
        self.token = uuid.uuid4().hex
        self.environment = {
            **os.environ,
            'ROS_DOMAIN_ID': str(domain),
            'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST',
            TOKEN: self.token,
        }
        self.processes: list[subprocess.Popen[str]] = []

    def start(self, *arguments: str, environment: dict[str, str] | None = None) -> 'subprocess.Popen[str]':
        """Start a Python process with these arguments; its output is text in pipes."""
        process = subprocess.Popen(
            [sys.executable, *arguments],
            env={**self.environment, **(environment or {})},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            cwd=self.path,
        )
        self.processes.append(process)
        return process

    def command(self, *arguments: str) -> 'subprocess.Popen[str]':
        """Start the command ``omni_vehicle``."""
        return self.start('-m', 'omni_vehicle_ros.executables', 'cli', *arguments)

    def node(self, executable: str, *arguments: str, namespace: str = '') -> 'subprocess.Popen[str]':
        """Start one node."""
        remap = ['-r', f'__ns:=/{namespace}'] if namespace else []
        return self.start('-m', 'omni_vehicle_ros.executables', f'nodes.{executable}', '--ros-args', *arguments, *remap)

    def scenario(self, text: str = SHORT, name: str = 'short') -> Path:
        """Write a scenario file."""
        file = self.path / f'{name}.yaml'
        file.write_text(text)
        return file

    def left(self) -> list[int]:
        """Return the process ids of everything started here that still runs, children included."""
        mark = f'{TOKEN}={self.token}'.encode()
        return [int(entry.name) for entry in Path('/proc').iterdir() if entry.name.isdigit() and _has(entry, mark)]

    def clean(self) -> None:
        """Kill what is left."""
        for number in self.left():
            with contextlib.suppress(ProcessLookupError):
                os.kill(number, signal.SIGKILL)
        for process in self.processes:
            process.communicate()


def _has(entry: Path, mark: bytes) -> bool:
    try:
        running = (entry / 'stat').read_text().rsplit(')', 1)[1].split()[0] not in 'ZX'
        return running and mark in (entry / 'environ').read_bytes().split(b'\0')
    except OSError:
        return False


def finish(process: 'subprocess.Popen[str]', code: int = 0) -> tuple[str, str]:
    """Wait for a process, check its exit code, and return what it printed."""
    out, errors = process.communicate(timeout=LIMIT)
    assert process.returncode == code, f'exit {process.returncode}\n{out}\n{errors}'
    assert 'Traceback' not in out + errors
    return out, errors


def until(condition: Callable[[], bool], what: str, limit: float = LIMIT) -> None:
    """Wait for a condition that other processes bring about."""
    end = time.monotonic() + limit
    while not condition():
        assert time.monotonic() < end, f'waited {limit:g} s in vain for {what}'
        time.sleep(0.02)


@pytest.fixture
def lab(tmp_path: Path) -> Iterator[Lab]:
    """Return a place to start processes in; at the end none of them may be left."""
    with held_domain() as domain:
        lab = Lab(tmp_path, domain)
        yield lab
        left = lab.left()
        lab.clean()
    assert not left, f'processes left running: {left}'
