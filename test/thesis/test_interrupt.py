"""Ctrl-C, which the terminal sends to all processes of the command, ends all of them, at whatever time it comes."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

LIMIT = 60.0


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


def until(condition, what: str) -> None:
    end = time.monotonic() + LIMIT
    while not condition():
        assert time.monotonic() < end, f'waited {LIMIT:g} s in vain for {what}'
        time.sleep(0.01)


@pytest.mark.parametrize('word', ['spawn_main', 'resource_tracker'])
def test_ctrl_c_while_workers_start(tmp_path: Path, word: str) -> None:
    """It comes when the first of them is there, or just before; one line, and nothing is left running."""
    command = [sys.executable, '-m', 'omni_vehicle_ros.executables', 'cli', 'thesis', '--chapter', '5', '--out', 'out']
    process = subprocess.Popen(
        command, cwd=tmp_path, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        start_new_session=True,
    )
    try:
        until(lambda: members(process.pid, word), word)
        os.killpg(process.pid, signal.SIGINT)
        _, errors = process.communicate(timeout=LIMIT)
        assert process.returncode == 0
        assert errors.splitlines()[-1] == 'interrupted'
        assert 'Traceback' not in errors
        until(lambda: not members(process.pid), 'the end of all processes')
    finally:
        for number in members(process.pid):
            os.kill(number, signal.SIGKILL)
        process.communicate()
