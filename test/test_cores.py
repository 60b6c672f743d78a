"""Cores that vehicles claim: each its own, as long as there are any."""

import os
import subprocess
import sys

import pytest

from omni_vehicle_ros.cores import CORE, Core

pytestmark = pytest.mark.skipif(
    not hasattr(os, 'sched_getaffinity') or len(os.sched_getaffinity(0)) < 2, reason='needs two cores'
)


def test_each_has_its_own_and_leaves_it_to_others():
    cores = [Core() for _ in range(len(os.sched_getaffinity(0)) + 1)]
    try:
        for core in cores:
            core.claim()
        numbers = [core.number for core in cores]
        mine = [number for number in numbers if number is not None]
        assert len(set(mine)) == len(mine)
        assert numbers[-1] is None
        allowed = os.sched_getaffinity(0)
        assert all(core.neighbour in allowed and core.neighbour != core.number for core in cores if core.number in mine)
        if mine:  # else other vehicles on this machine have them all
            cores[0].let_go()
            cores[-1].claim()
            assert cores[-1].number == numbers[0]
    finally:
        for core in cores:
            core.let_go()


def test_threads_stay_on_the_core_that_is_named():
    program = (
        'import os, threading; from omni_vehicle_ros.cores import stay_on_core\n'
        'event = threading.Event(); thread = threading.Thread(target=event.wait); thread.start(); stay_on_core()\n'
        'print([sorted(os.sched_getaffinity(int(one))) for one in os.listdir("/proc/self/task")]); event.set()'
    )
    last = max(os.sched_getaffinity(0))
    for value, expected in ((str(last), [last]), ('', sorted(os.sched_getaffinity(0))), ('9999', None)):
        said = subprocess.run(
            [sys.executable, '-c', program], env={**os.environ, CORE: value}, check=True, capture_output=True, text=True
        ).stdout.strip()
        assert said == str([expected or sorted(os.sched_getaffinity(0))] * 2)
