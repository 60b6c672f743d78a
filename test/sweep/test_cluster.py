"""A sweep on a Dask cluster is that on this machine, whoever is lost on the way."""

import os
import signal
from pathlib import Path

import pytest

from omni_vehicle_ros.errors import RunError
from omni_vehicle_ros.sweep.command import sweep
from omni_vehicle_ros.sweep.study import read_study
from omni_vehicle_ros.sweep.turns import chunk_table

distributed = pytest.importorskip('distributed')


@pytest.mark.filterwarnings('ignore')  # of Dask's own
def test_a_killed_worker_costs_nothing(tmp_path: Path) -> None:
    """Two worker processes, one of which is killed with chunks under way: each part is there once, to the byte."""
    study = read_study('simple_turning', ['radius=2:6:20', 'speed=1:4:30'], ['duration=1.5'])
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, host='127.0.0.1', protocol='tcp'
    ) as cluster:
        workers = [worker.pid for worker in cluster.workers.values()]
        told: list[float] = []

        def kill_one(turns: float) -> None:
            told.append(turns)
            if len(told) == 3:
                os.kill(workers[0], signal.SIGKILL)

        found = sweep(study, tmp_path / 'out', cluster.scheduler_address, kill_one)
    assert found.driven == study.turns == told[-1] == 600
    assert len(told) == study.chunks + 1, 'each chunk was done once'
    parts = {path.name: path.read_bytes() for path in (tmp_path / 'out' / 'turns').iterdir()}
    assert parts == {f'part-{n:06d}.parquet': chunk_table(study, n) for n in range(study.chunks)}


def test_a_scheduler_that_does_not_answer_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr('omni_vehicle_ros.sweep.work.PATIENCE', 0.5)
    with pytest.raises(RunError, match='no Dask scheduler answers there') as error:
        sweep(read_study('simple_turning', ['radius=2,3']), tmp_path / 'out', 'tcp://127.0.0.1:1')
    assert '\n' not in str(error.value)


@pytest.mark.filterwarnings('ignore')  # of Dask's own
def test_a_scheduler_without_workers_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr('omni_vehicle_ros.sweep.work.PATIENCE', 2.0)
    with (
        distributed.LocalCluster(n_workers=0, dashboard_address=None, host='127.0.0.1', protocol='tcp') as cluster,
        pytest.raises(RunError, match='it has no workers; start some'),
    ):
        sweep(read_study('simple_turning', ['radius=2,3']), tmp_path / 'out', cluster.scheduler_address)
