"""A sweep that is cut short goes on where it stopped, and ends with the same table; nothing else is written over."""

import io
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from pyarrow import dataset, parquet

from omni_vehicle_ros.errors import OmniVehicleError, RunError
from omni_vehicle_ros.sweep.cells import cells
from omni_vehicle_ros.sweep.command import sweep
from omni_vehicle_ros.sweep.parts import Parts
from omni_vehicle_ros.sweep.study import read_study
from omni_vehicle_ros.sweep.turns import chunk_table

VARY = ('radius=2:6:20', 'speed=1:4:20')
SETTINGS = ('duration=3',)
ARGUMENTS = ('simple_turning', '--vary', VARY[0], '--vary', VARY[1], '--set', *SETTINGS)
LIMIT = 60.0


def one_by_one(study, chunks):
    return ((number, chunk_table(study, number)) for number in chunks)


@pytest.fixture(autouse=True, scope='module')
def here():
    """Do chunks in this process, where it does not matter who does them: workers take seconds to start."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr('omni_vehicle_ros.sweep.command.on_this_machine', one_by_one)
        yield


@pytest.fixture(scope='module')
def whole(tmp_path_factory, here):
    """Return the directory of a sweep that nobody disturbed."""
    directory = tmp_path_factory.mktemp('sweep') / 'whole'
    sweep(read_study('simple_turning', VARY, SETTINGS), directory)
    return directory


def parts(directory: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in (directory / 'turns').iterdir()}


def start(directory: Path) -> 'subprocess.Popen[str]':
    command = [sys.executable, '-m', 'omni_vehicle_ros.executables', 'cli', 'sweep', *ARGUMENTS]
    return subprocess.Popen(
        [*command, '--out', str(directory)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        start_new_session=True,
    )


def running(group: int) -> list[int]:
    """Return the processes of a group that run."""
    found = []
    for entry in Path('/proc').iterdir():
        try:
            state, group_id = (entry / 'stat').read_text().rsplit(')', 1)[1].split()[::2][:2]
            if state not in 'ZX' and int(group_id) == group:
                found.append(int(entry.name))
        except (OSError, ValueError):
            continue
    return found


def until(condition, what: str) -> None:
    end = time.monotonic() + LIMIT
    while not condition():
        assert time.monotonic() < end, f'waited {LIMIT:g} s in vain for {what}'
        time.sleep(0.01)


def test_the_table_has_every_turn_once(whole):
    table = dataset.dataset(whole / 'turns').to_table().sort_by('turn')
    assert table['turn'].to_pylist() == list(range(400))
    assert len({*zip(table['radius'].to_pylist(), table['speed'].to_pylist(), strict=True)}) == 400
    assert (whole / 'index.html').exists() and (whole / 'map.svg').exists()


@pytest.mark.parametrize('number', [signal.SIGKILL, signal.SIGTERM])
def test_a_sweep_that_was_ended_goes_on(tmp_path, number, whole):
    """No part is lost, none is done twice, no process is left, and the table is that of a sweep in one go."""
    study = read_study('simple_turning', VARY, SETTINGS)
    process = start(tmp_path / 'cut')
    until(lambda: list((tmp_path / 'cut').glob('turns/part-*')), 'the first part')
    (process.kill if number == signal.SIGKILL else lambda: os.kill(process.pid, number))()
    _, errors = process.communicate(timeout=LIMIT)
    assert process.returncode == (-number if number == signal.SIGKILL else 128 + number), errors
    assert 'Traceback' not in errors
    until(lambda: not running(process.pid), 'the end of all processes')
    before = parts(tmp_path / 'cut')
    there = [name for name in before if name.startswith('part-')]
    assert 0 < len(there) < study.chunks
    stamps = {name: (tmp_path / 'cut' / 'turns' / name).stat().st_mtime_ns for name in there}
    done = []
    found = sweep(study, tmp_path / 'cut', progress=done.append)
    assert found.driven == study.turns - sum(len(study.numbers(int(name[5:11]))) for name in there)
    assert done[0] == study.turns - found.driven and done[-1] == study.turns
    assert stamps == {name: (tmp_path / 'cut' / 'turns' / name).stat().st_mtime_ns for name in there}
    assert parts(tmp_path / 'cut') == parts(whole)


def test_the_same_sweep_again_does_nothing(whole):
    before = parts(whole)
    found = sweep(read_study('simple_turning', VARY, SETTINGS), whole)
    assert found.driven == 0 and parts(whole) == before


@pytest.mark.parametrize(
    ('vary', 'settings', 'words'),
    [
        ([VARY[0], 'speed=1:4:21'], SETTINGS, '--vary'),
        (VARY, ['duration=1.4'], '--set'),
    ],
)
def test_another_sweep_is_refused_with_the_difference(whole, vary, settings, words):
    before = parts(whole)
    with pytest.raises(RunError, match=f'holds another sweep: its {words}'):
        sweep(read_study('simple_turning', vary, settings), whole)
    assert parts(whole) == before


def test_a_directory_of_something_else_is_refused(tmp_path):
    (tmp_path / 'letter').write_text('dear')
    with pytest.raises(RunError, match='holds something, but no sweep'):
        sweep(read_study('simple_turning', ['radius=2,3']), tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ['letter']


def test_what_can_not_be_leaves_no_directory(tmp_path):
    turn = 'simple_turning'
    for scenario, vary in (('demo', 'mass=1300,1400'), (turn, 'mass=100,1300'), (turn, 'radius=0,1')):
        with pytest.raises(OmniVehicleError):
            sweep(read_study(scenario, [vary]), tmp_path / 'new')
    assert not list(tmp_path.iterdir())


def test_half_a_part_is_no_part(tmp_path):
    study = read_study('simple_turning', ['radius=2:6:200'], ['duration=0.1'])
    parts_ = Parts(tmp_path, study)
    parts_.write(2, chunk_table(study, 2))
    (tmp_path / 'turns' / '.part-1').write_bytes(b'PAR1')
    again = Parts(tmp_path, study)
    assert again.missing == (0, 1, 3) and [path.name for path in again.table.iterdir()] == ['part-000002.parquet']


def test_cells_are_the_means_of_their_turns(tmp_path):
    study = read_study('simple_turning', ['radius=2:6:5', 'speed=1:6:6', 'mass=1200,1500'], ['duration=1.2'])
    table = parquet.read_table(io.BytesIO(chunk_table(study, 0)))
    (tmp_path / 'turns').mkdir()
    parquet.write_table(table, tmp_path / 'turns' / 'part.parquet')
    found, columns = cells(study, tmp_path / 'turns'), {name: table[name].to_numpy() for name in table.column_names}
    use = np.max([column for name, column in columns.items() if name.startswith('friction_use')], axis=0)
    there = (columns['radius'] == 3.0) & (columns['speed'] == 4.0)
    assert found.mean['friction_use'][3, 1] == pytest.approx(np.mean(use[there]))
    assert found.counts.tolist() == [[2.0] * 5] * 6
    assert np.mean(found.mean['settled']) == pytest.approx(100.0 * np.mean(columns['settled']))
    assert found.flags['left_linear'] == np.count_nonzero(columns['left_linear'])
