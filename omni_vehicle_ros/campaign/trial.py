"""One drive of a campaign as the user would make it: by the command, in a process of its own, with an end."""

import os
import shutil
import signal
import subprocess
import sys
import time
import uuid
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from threading import Event
from typing import NamedTuple

from omni_vehicle_ros.campaign.draw import Drive
from omni_vehicle_ros.network import network_environment
from omni_vehicle_ros.processes import BOOT
from omni_vehicle_ros.shared_memory import existing, remove, segments_of

TOKEN = 'OMNI_VEHICLE_TRIAL'
"""Environment variable that all processes of a trial inherit, by which those are found that are left."""

LIMIT = 300.0
"""Wall time after which a drive hangs [s]."""

LOOK_PERIOD = 0.2


class Trial(NamedTuple):
    """How a drive ended.

    Attributes
    ----------
    directory
        Of its results.
    code
        Exit code of the command; None: it came to no end in `LIMIT`.
    wall
        Time that it took [s].
    said
        On standard output and standard error, its nodes' included.
    left
        Process ids that were there after its end; they have been killed.
    segments
        Of the shared memory of its processes, those that were there after its end.
    """

    directory: Path
    code: int | None
    wall: float
    said: str
    left: list[int]
    segments: list[str]


def make_trial(drive: Drive, directory: Path, domain: int, stop: Event) -> Trial:
    """Make a drive, in a ROS domain and a namespace of its own.

    Parameters
    ----------
    drive
        What to drive.
    directory
        Of the campaign.
    domain
        Nobody else may be in it.
    stop
        Ends the drive before its time when it is set.
    """
    name = f'run_{drive.number:04}'
    file, output, results = (directory / f'{name}{end}' for end in ('.yaml', '.txt', ''))
    shutil.rmtree(results, ignore_errors=True)  # of a campaign that was cut off
    file.write_text(drive.scenario.as_yaml(), encoding='utf-8')
    arguments = ['run', str(file), '--mode', drive.mode, '--namespace', name, '--out', str(results)]
    token, begun = uuid.uuid4().hex, time.monotonic()
    environment = {**network_environment(), TOKEN: token, 'ROS_DOMAIN_ID': str(domain)}
    with output.open('wb') as said:
        process = subprocess.Popen(
            [sys.executable, '-c', BOOT, 'cli', *arguments],
            stdin=subprocess.DEVNULL, stdout=said, stderr=said, env=environment, start_new_session=True,
        )
        segments: set[str] = set()
        try:
            code = _code(process, stop, lambda: segments.update(*map(segments_of, running(token))))
        finally:
            left = end_all(token)
            process.wait()
            left_segments = existing(segments)
            remove(left_segments)
    logs = [path for folder in results.glob('log') for path in sorted(folder.iterdir())]
    text = ''.join(path.read_text(encoding='utf-8', errors='replace') for path in (output, *logs))
    wall = time.monotonic() - begun
    return Trial(results, code, wall, text, *((left, left_segments) if code is not None else ([], [])))


def _code(process: 'subprocess.Popen[bytes]', stop: Event, look: Callable[[], None]) -> int | None:
    """Wait for the end, and look round now and then."""
    until = time.monotonic() + LIMIT
    while not stop.is_set() and time.monotonic() < until:
        look()
        with suppress(subprocess.TimeoutExpired):
            return process.wait(LOOK_PERIOD)
    return None


def end_all(token: str) -> list[int]:
    """Kill all processes with a token, and return what they were."""
    found = running(token)
    for number in found:
        with suppress(ProcessLookupError):
            os.kill(number, signal.SIGKILL)
    while running(token):
        time.sleep(LOOK_PERIOD)
    return found


def running(token: str) -> list[int]:
    """Return the ids of the processes that inherited a token and still run, frozen ones included."""
    mark = f'{TOKEN}={token}'.encode()
    return [int(entry.name) for entry in Path('/proc').iterdir() if entry.name.isdigit() and _has(entry, mark)]


def _has(entry: Path, mark: bytes) -> bool:
    try:
        state = (entry / 'stat').read_text(encoding='ascii', errors='replace').rpartition(')')[2].split()[0]
        return state not in 'ZX' and mark in (entry / 'environ').read_bytes().split(b'\0')
    except OSError:
        return False
