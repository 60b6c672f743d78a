"""The command ``repair``: what was saved and lost, or one line and exit code 2, and nothing half made."""

import subprocess
import sys
from pathlib import Path

import pytest

from omni_vehicle_ros import interface
from omni_vehicle_ros.bags import BagWriter, read_messages
from omni_vehicle_ros.messages import Clock, encode

COMMAND = (sys.executable, '-m', 'omni_vehicle_ros.executables', 'cli', 'repair')


def repair(path: Path, *arguments: str) -> 'subprocess.CompletedProcess[str]':
    return subprocess.run([*COMMAND, *arguments], cwd=path, capture_output=True, text=True, timeout=60, check=False)


@pytest.fixture
def bag(tmp_path: Path) -> Path:
    row = interface.topic('/clock')
    with BagWriter(tmp_path / 'bag') as writer:
        writer.add_topic(row.name, row.type, row.qos)
        for number in range(10):
            writer.write(row.name, encode(row.type, Clock(number)), number)
    return tmp_path / 'bag'


def test_a_bag_is_repaired_and_then_whole(bag: Path) -> None:
    path = bag / 'bag_0.mcap'
    content = path.read_bytes()
    path.write_bytes(content[:-9])
    done = repair(bag.parent, 'bag')
    assert done.returncode == 0
    lines = done.stdout.splitlines()
    assert lines[0].startswith('bag_0.mcap: 10 messages saved, ')
    assert lines[-1] == 'bag     bag_repaired'
    assert path.read_bytes() == content[:-9]
    assert len(list(read_messages(bag.parent / 'bag_repaired'))) == 10
    done = repair(bag.parent, 'bag_repaired')
    assert (done.returncode, done.stdout) == (0, 'the bag is whole: 10 messages in 1 file(s); nothing was written\n')
    assert sorted(each.name for each in bag.parent.iterdir()) == ['bag', 'bag_repaired']


@pytest.mark.parametrize(
    ('arguments', 'words'),
    [
        (('nothing',), 'nothing does not exist; name a bag directory'),
        (('text.mcap',), 'nothing can be saved of text.mcap'),
        (('bag', '--out', 'bag/new'), 'bag/new lies in the bag'),
        (('bag', '--out', 'text.mcap'), 'text.mcap exists; name a directory that does not'),
    ],
)
def test_what_is_wrong_is_one_line(bag: Path, arguments: tuple[str, ...], words: str) -> None:
    (bag.parent / 'text.mcap').write_text('no bag', encoding='utf-8')
    done = repair(bag.parent, *arguments)
    assert done.returncode == 2
    assert done.stderr.splitlines()[-1].startswith(f'error: {words}')
    assert 'Traceback' not in done.stderr
    assert not done.stdout
    assert sorted(each.name for each in bag.parent.iterdir()) == ['bag', 'text.mcap']
