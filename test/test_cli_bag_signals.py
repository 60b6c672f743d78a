"""Repair, analyse and export that a signal ends: one line, the exit code of the signal, and nothing half made."""

import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from mcap.writer import CompressionType, Writer

from omni_vehicle_ros import interface
from omni_vehicle_ros.messages import Clock, encode

COMMAND = (sys.executable, '-m', 'omni_vehicle_ros.executables', 'cli')
MESSAGES = 300_000
"""So many that no command is done before the signal comes, when it has begun to write."""
LIMIT = 60.0  # s


@pytest.fixture(scope='module')
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a directory with a bag that is cut off."""
    directory = tmp_path_factory.mktemp('signals')
    row = interface.topic('/clock')
    with (directory / 'cut.mcap').open('wb') as file:
        writer = Writer(file, chunk_size=2**20, compression=CompressionType.LZ4)
        writer.start('ros2')
        schema = writer.register_schema(row.type, 'ros2msg', b'')
        channel = writer.register_channel(row.name, 'cdr', schema)
        for number in range(MESSAGES):
            writer.add_message(channel, number, encode(row.type, Clock(number)), number)
        file.truncate(file.tell() - 9)
    return directory


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize('command', ['repair', 'analyse', 'export --format csv'])
def test_a_signal_leaves_nothing_half_made(place: Path, command: str, number: signal.Signals) -> None:
    before = (place / 'cut.mcap').stat()
    process = subprocess.Popen(
        [*COMMAND, *command.split(), 'cut.mcap', '--out', 'new/out'], cwd=place, stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )
    try:
        end = time.monotonic() + LIMIT
        while not (place / 'new' / 'out').exists():
            assert process.poll() is None
            assert time.monotonic() < end
            time.sleep(0.005)
        process.send_signal(number)
        output, errors = process.communicate(timeout=LIMIT)
    finally:
        process.kill()
        process.communicate()
    assert process.returncode == 128 + number, errors
    assert errors.splitlines()[-1] == 'interrupted'
    assert 'Traceback' not in errors
    assert 'cut.mcap:' not in output
    assert [each.name for each in place.iterdir()] == ['cut.mcap']
    after = (place / 'cut.mcap').stat()
    assert (after.st_mtime_ns, after.st_size) == (before.st_mtime_ns, before.st_size)


SWALLOWED = """
import os, signal, sys, time
from omni_vehicle_ros.cli import command_line

class Destroyed:
    def __del__(self):
        os.kill(os.getpid(), signal.SIGTERM)
        time.sleep(0.1)

def swallow():
    Destroyed()
    time.sleep(60)

command_line.COMMANDS['swallow'] = swallow
sys.argv[1:] = ['swallow']
command_line.main()
"""


def test_a_signal_in_a_destructor_ends_a_command_too() -> None:
    done = subprocess.run([sys.executable, '-c', SWALLOWED], capture_output=True, text=True, timeout=LIMIT, check=False)
    assert (done.returncode, done.stderr) == (143, 'interrupted\n')
