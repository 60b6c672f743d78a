"""Workers: every result under its key, errors of the user's doing passed on, and no wait for a dead one."""

import math
import multiprocessing
import signal

import pytest

from omni_vehicle_ros.errors import RunError, ScenarioError
from omni_vehicle_ros.scenarios import load_scenario
from omni_vehicle_ros.workers import Workers


def test_each_result_has_its_key() -> None:
    """Whichever worker did it, in the order of the jobs; arguments may be far larger than a pipe holds."""
    count: list[int] = []
    with Workers() as workers:
        roots = workers.each({number: (number,) for number in range(50)}, math.sqrt, lambda: count.append(1))
        sizes = workers.each({size: (bytes(size),) for size in (5_000_000, 3, 4_000_000)}, len, lambda: None)
    assert list(roots.items()) == [(number, math.sqrt(number)) for number in range(50)]
    assert len(count) == 50
    assert list(sizes.items()) == [(size, size) for size in (5_000_000, 3, 4_000_000)]
    assert not multiprocessing.active_children()


def test_an_error_of_the_user_is_passed_on() -> None:
    with pytest.raises(ScenarioError, match='nowhere'), Workers() as workers:
        workers.each({0: ('nowhere',)}, load_scenario, lambda: None)
    assert not multiprocessing.active_children()


@pytest.mark.parametrize('number', [signal.SIGKILL, signal.SIGTERM])
def test_a_killed_worker_is_not_waited_for(number: signal.Signals) -> None:
    """Nor are those that work on, and those jobs that wait."""
    with pytest.raises(RunError, match='ended before its time'), Workers() as workers:
        workers.each({key: (number,) for key in range(100)}, signal.raise_signal, lambda: None)
    assert not multiprocessing.active_children()
