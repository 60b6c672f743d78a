"""Work shared among as many processes as there are cores."""

import multiprocessing
import os
import signal
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from types import TracebackType
from typing import Any, TypeVar

from omni_vehicle_ros.errors import RunError
from omni_vehicle_ros.executables import ENDING
from omni_vehicle_ros.model.warm import warm
from omni_vehicle_ros.thesis.tasks import Results, Task

K = TypeVar('K')
T = TypeVar('T')

Done = Callable[[], None]


def cores() -> int:
    """Return how many cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, 'sched_getaffinity') else os.cpu_count() or 1


class Workers:
    """A pool of processes for a ``with`` block; an exception in it ends them without the work that waits."""

    def __init__(self) -> None:
        warm()  # or each of them would compile the physics where nobody has done it yet
        self._pool = ProcessPoolExecutor(cores(), multiprocessing.get_context('spawn'), _leave_signals_to_the_parent)

    def __enter__(self) -> 'Workers':
        """Give the workers."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """End the workers; what they are at is finished first."""
        self._pool.shutdown(cancel_futures=True)

    def results(self, tasks: Sequence[Task[Any]], done: Done) -> Results:
        """Do tasks.

        Parameters
        ----------
        tasks
            Each once.
        done
            Called after each.

        Raises
        ------
        RunError
            A worker ended before its time.
        """
        return Results(self._gathered({task: self._pool.submit(_work, task) for task in tasks}, done))

    def each(self, jobs: Mapping[K, tuple[Any, ...]], job: Callable[..., T], done: Done) -> dict[K, T]:
        """Call a function with each of several lists of arguments, and return what it returns by their keys."""
        return self._gathered({key: self._pool.submit(job, *arguments) for key, arguments in jobs.items()}, done)

    def _gathered(self, futures: Mapping[K, 'Future[T]'], done: Done) -> dict[K, T]:
        try:
            for _ in as_completed(futures.values()):
                done()
            return {key: future.result() for key, future in futures.items()}
        except BrokenProcessPool:
            raise RunError('a worker process ended before its time; is there memory enough?') from None


def _work(task: Task[T]) -> T:
    return task.work()


def _leave_signals_to_the_parent() -> None:
    for number in ENDING:
        signal.signal(number, signal.SIG_IGN)
