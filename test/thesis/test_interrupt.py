"""However a reproduction ends before its time, one line says so, and no process and no empty directory is left."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

LIMIT = 60.0
WORKER = 'spawn_main'


def members(group: int, word: str = '') -> list[int]:
    """Return the processes of a group that run, with a word in their command line."""
    found = []
    for entry in Path('/proc').iterdir():
        try:
            state, group_id = (entry / 'stat').read_text().rsplit(')', 1)[1].split()[::2][:2]
            if state not in 'ZX' and int(group_id) == group and word in (entry / 'cmdline').read_text():
                found.append(int(entry.name))
        except (OSError, ValueError):
            continue
    return found


def loaded(number: int) -> bool:
    """Whether a process has loaded the compiler of the physics."""
    try:
        return 'llvmlite' in Path(f'/proc/{number}/maps').read_text()
    except OSError:
        return False


def until(condition, what: str) -> None:
    end = time.monotonic() + LIMIT
    while not condition():
        assert time.monotonic() < end, f'waited {LIMIT:g} s in vain for {what}'
        time.sleep(0.01)


@pytest.fixture
def process(tmp_path: Path) -> Iterator['subprocess.Popen[str]']:
    """Return the command at work, in a process group of its own."""
    arguments = ['-m', 'omni_vehicle_ros.executables', 'cli', 'thesis', '--chapter', '5', '--out', 'new/out']
    process = subprocess.Popen(
        [sys.executable, *arguments], cwd=tmp_path, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
        stderr=subprocess.PIPE, text=True, start_new_session=True,
    )
    yield process
    for number in members(process.pid):
        os.kill(number, signal.SIGKILL)
    process.communicate()


def last_line(process: 'subprocess.Popen[str]', code: int) -> str:
    """Wait for the end of a command and of all its processes; return the last line of its errors."""
    _, errors = process.communicate(timeout=LIMIT)
    assert process.returncode == code, errors
    assert 'Traceback' not in errors
    until(lambda: not members(process.pid), 'the end of all processes')
    return errors.splitlines()[-1]


@pytest.mark.parametrize('word', [WORKER, 'resource_tracker'])
def test_ctrl_c_while_workers_start(process: 'subprocess.Popen[str]', tmp_path: Path, word: str) -> None:
    """It comes, to all processes of the command, when the first worker is there, or just before."""
    until(lambda: members(process.pid, word), word)
    os.killpg(process.pid, signal.SIGINT)
    assert last_line(process, 128 + signal.SIGINT) == 'interrupted'
    assert not list(tmp_path.iterdir())


def test_kill_of_a_worker_ends_the_command(process: 'subprocess.Popen[str]', tmp_path: Path) -> None:
    until(lambda: members(process.pid, WORKER), 'a worker')
    os.kill(members(process.pid, WORKER)[0], signal.SIGKILL)
    assert 'error: a worker process ended before its time' in last_line(process, 2)
    assert not list(tmp_path.iterdir())


def test_workers_end_when_their_command_is_killed(process: 'subprocess.Popen[str]') -> None:
    until(lambda: any(map(loaded, members(process.pid, WORKER))), 'a worker with what it works with')
    process.kill()
    until(lambda: not members(process.pid), 'the end of all processes')
    assert 'Traceback' not in process.communicate()[1]
