"""Work shared among as many processes as there are cores."""

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from multiprocessing import connection, resource_tracker
from multiprocessing.connection import Connection
from types import TracebackType
from typing import Any, TypeVar

from omni_vehicle_ros.ending import Uninterrupted, hold_signals, release_signals
from omni_vehicle_ros.errors import OmniVehicleError, RunError
from omni_vehicle_ros.model.warm import warm
from omni_vehicle_ros.thesis.tasks import Results, Task

K = TypeVar('K')
T = TypeVar('T')

Done = Callable[[], None]


def cores() -> int:
    """Return how many cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, 'sched_getaffinity') else os.cpu_count() or 1


class Workers:
    """Processes for a ``with`` block, each with a pipe of its own; they end with the block, or with this process.

    Nothing is shared that one of them could take with it: a pool of the standard library can wait for ever on a queue
    whose reader was killed (github.com/python/cpython/issues/94777, not mended in Python 3.10).
    """

    def __init__(self) -> None:
        warm()  # or each of them would compile the physics where nobody has done it yet
        self._processes: list[multiprocessing.process.BaseProcess] = []
        self._pipes: list[Connection] = []

    def __enter__(self) -> 'Workers':
        """Start nothing yet."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """End the workers by force: what they have not sent by now is not wanted."""
        for process in self._processes:
            process.kill()
        for process in self._processes:
            process.join()

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
        return Results(self.each({task: (task,) for task in tasks}, _work, done))

    def each(self, jobs: Mapping[K, tuple[Any, ...]], job: Callable[..., T], done: Done) -> dict[K, T]:
        """Call a function with each of several lists of arguments, and return what it returns by their keys.

        Raises
        ------
        OmniVehicleError
            The function raised it; or, as a `RunError`, a worker ended before its time.
        """
        if not self._pipes:
            self._start()
        waiting, idle = list(jobs.items())[::-1], list(self._pipes)
        busy: dict[Connection, K] = {}
        found: dict[K, T] = {}
        while waiting or busy:
            while waiting and idle:
                key, arguments = waiting.pop()
                pipe = idle.pop()
                _send(pipe, (job, arguments))
                busy[pipe] = key
            ready = connection.wait(list(busy))
            for pipe in [pipe for pipe in busy if pipe in ready]:
                found[busy.pop(pipe)] = _receive(pipe)
                idle.append(pipe)
                done()
        return {key: found[key] for key in jobs}

    def _start(self) -> None:
        spawn = multiprocessing.get_context('spawn')
        with _uninterrupted_start():
            for _ in range(cores()):
                here, there = spawn.Pipe()
                process = spawn.Process(target=_serve, args=(there,), daemon=True)
                process.start()
                there.close()
                self._processes.append(process)
                self._pipes.append(here)


def _send(pipe: Connection, job: Any) -> None:
    try:
        pipe.send(job)
    except OSError:
        raise _worker_lost() from None


def _receive(pipe: Connection) -> Any:
    try:
        answer = pipe.recv()
    except (EOFError, OSError):
        raise _worker_lost() from None
    if isinstance(answer, OmniVehicleError):
        raise answer
    return answer


def _worker_lost() -> RunError:
    return RunError('a worker process ended before its time: it was killed, or there is not memory enough')


def _work(task: Task[T]) -> T:
    return task.work()


def _serve(pipe: Connection) -> None:
    """Do what the parent sends, until it has gone; Ctrl-C is for the parent to answer."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    release_signals()
    threading.Thread(target=_end_with_the_parent, daemon=True).start()
    with suppress(EOFError, ConnectionError):
        while True:
            job, arguments = pipe.recv()
            try:
                answer = job(*arguments)
            except OmniVehicleError as error:
                answer = error
            pipe.send(answer)


def _end_with_the_parent() -> None:
    parent = multiprocessing.parent_process()
    assert parent is not None
    parent.join()
    os._exit(1)


@contextmanager
def _uninterrupted_start() -> Iterator[None]:
    """Start workers whole: Ctrl-C, which all processes get, must hit neither them before they are up nor their start.

    Workers inherit that signals are held. Here they still come, by way of other threads, and are kept for the end.
    """
    with Uninterrupted():
        resource_tracker.ensure_running()  # it would let the signals through on its own start
        hold_signals()
        try:
            yield
        finally:
            release_signals()
