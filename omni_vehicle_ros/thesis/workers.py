"""Work shared among as many processes as there are cores."""

import multiprocessing
import os
import signal
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing import resource_tracker
from types import TracebackType
from typing import Any, TypeVar

from omni_vehicle_ros.errors import RunError
from omni_vehicle_ros.executables import ENDING, hold_signals, release_signals
from omni_vehicle_ros.model.warm import warm
from omni_vehicle_ros.thesis.tasks import Results, Task

K = TypeVar('K')
T = TypeVar('T')

Done = Callable[[], None]


def cores() -> int:
    """Return how many cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, 'sched_getaffinity') else os.cpu_count() or 1


class Workers:
    """A pool of processes for a ``with`` block; an exception in it ends them at once."""

    def __init__(self) -> None:
        warm()  # or each of them would compile the physics where nobody has done it yet
        self._pool = ProcessPoolExecutor(cores(), multiprocessing.get_context('spawn'), _leave_ctrl_c_to_the_parent)

    def __enter__(self) -> 'Workers':
        """Give the workers."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """End the workers, by force if there is an exception."""
        if error is not None:
            # One that was ended half way may hold a lock that the others wait for: none of them can be asked to end.
            for worker in multiprocessing.active_children():
                worker.kill()
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
        with _uninterrupted_start():
            futures = {task: self._pool.submit(_work, task) for task in tasks}
        return Results(self._gathered(futures, done))

    def each(self, jobs: Mapping[K, tuple[Any, ...]], job: Callable[..., T], done: Done) -> dict[K, T]:
        """Call a function with each of several lists of arguments, and return what it returns by their keys."""
        with _uninterrupted_start():
            futures = {key: self._pool.submit(job, *arguments) for key, arguments in jobs.items()}
        return self._gathered(futures, done)

    def _gathered(self, futures: Mapping[K, 'Future[T]'], done: Done) -> dict[K, T]:
        try:
            for _ in as_completed(futures.values()):
                done()
            return {key: future.result() for key, future in futures.items()}
        except BrokenProcessPool:
            raise RunError('a worker process ended before its time; is there memory enough?') from None


def _work(task: Task[T]) -> T:
    return task.work()


@contextmanager
def _uninterrupted_start() -> Iterator[None]:
    """Start workers whole: Ctrl-C, which all processes get, must hit neither them before they are up nor their start.

    Workers inherit that signals are held. Here they still come, by way of other threads, and are kept for the end.
    """
    came: list[int] = []
    before = {number: signal.signal(number, lambda number, _: came.append(number)) for number in ENDING}
    resource_tracker.ensure_running()  # it would let the signals through on its own start
    hold_signals()
    try:
        yield
    finally:
        release_signals()
        for number, handler in before.items():
            signal.signal(number, handler)
        if came:
            signal.raise_signal(came[0])


def _leave_ctrl_c_to_the_parent() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    release_signals()
