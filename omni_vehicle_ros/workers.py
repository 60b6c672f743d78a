"""Work shared among as many processes as there are cores."""

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from itertools import islice
from multiprocessing import connection, resource_tracker
from multiprocessing.connection import Connection
from types import TracebackType
from typing import Any, TypeVar

from omni_vehicle_ros.ending import Uninterrupted, hold_signals, release_signals
from omni_vehicle_ros.errors import OmniVehicleError, RunError
from omni_vehicle_ros.model.warm import warm

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

    Parameters
    ----------
    prepare
        Called here first: compiles what they need, or each of them would where nobody has done it yet.
    """

    def __init__(self, prepare: Callable[[], None] = warm) -> None:
        prepare()
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

    def each(self, jobs: Mapping[K, tuple[Any, ...]], job: Callable[..., T], done: Done) -> dict[K, T]:
        """Call a function with each of several lists of arguments, and return what it returns by their keys.

        Raises
        ------
        OmniVehicleError
            The function raised it; or, as a `RunError`, a worker ended before its time.
        """
        found: dict[K, T] = {}
        for key, result in self.as_done(jobs.items(), job):
            found[key] = result
            done()
        return {key: found[key] for key in jobs}

    def as_done(
        self, jobs: Iterable[tuple[K, tuple[Any, ...]]], job: Callable[..., T]
    ) -> Iterator[tuple[K, T]]:
        """Do as `each`, with jobs that are asked for when a worker is free; yield each result as it comes."""
        if not self._pipes:
            self._start()
        waiting, idle = iter(jobs), list(self._pipes)
        busy: dict[Connection, K] = {}
        while True:
            for key, arguments in islice(waiting, len(idle)):
                pipe = idle.pop()
                _send(pipe, (job, arguments))
                busy[pipe] = key
            if not busy:
                return
            ready = connection.wait(list(busy))
            for pipe in [pipe for pipe in busy if pipe in ready]:
                idle.append(pipe)
                yield busy.pop(pipe), _receive(pipe)

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
