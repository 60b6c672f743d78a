"""A campaign from the first drive to the last: trials side by side, verdicts, tables."""

import queue
import shutil
import time
from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from contextlib import contextmanager
from pathlib import Path
from threading import Event
from typing import NamedTuple

from omni_vehicle_ros.campaign.draw import Drive, draw
from omni_vehicle_ros.campaign.judge import Verdict, judge
from omni_vehicle_ros.campaign.tables import write_tables
from omni_vehicle_ros.campaign.trial import make_trial
from omni_vehicle_ros.run import new_directory

POLL = 0.2


class Request(NamedTuple):
    """What a campaign is asked for.

    Attributes
    ----------
    runs, seed, mode
        As of `omni_vehicle_ros.campaign.draw.draw`.
    jobs
        How many drives at a time.
    domain
        The first of as many ROS domains as there are jobs.
    """

    runs: int
    seed: int
    mode: str
    jobs: int
    domain: int


def run_campaign(request: Request, directory: Path, progress: Callable[[int], None]) -> list[Verdict]:
    """Make all drives of a campaign; leave tables, and the results of drives that did not pass.

    Parameters
    ----------
    request
        What is asked for.
    directory
        Where to; must not exist.
    progress
        Called with how many drives are over.

    Raises
    ------
    RunError
        The directory exists already.
    """
    drives = draw(request.runs, request.seed, request.mode)
    domains: queue.SimpleQueue[int] = queue.SimpleQueue()
    for job in range(request.jobs):
        domains.put(request.domain + job)
    begun = time.monotonic()
    verdicts: list[Verdict] = []
    with new_directory(directory):
        progress(0)
        with _each(drives, directory, domains, request.jobs) as futures:
            for verdict in futures:
                verdicts.append(verdict)
                progress(len(verdicts))
                ordered = sorted(verdicts, key=lambda one: one.drive.number)
                wall = time.monotonic() - begun
                write_tables(ordered, request.seed, request.mode, wall, request.runs, directory)
    return sorted(verdicts, key=lambda one: one.drive.number)


@contextmanager
def _each(
    drives: list[Drive], directory: Path, domains: 'queue.SimpleQueue[int]', jobs: int
) -> Iterator[Iterator[Verdict]]:
    """Give the verdicts as they come; on an interruption, end those under way and begin no more."""
    stop = Event()
    with ThreadPoolExecutor(jobs) as pool:
        pending = {pool.submit(_judged, drive, directory, domains, stop) for drive in drives}
        try:
            yield _as_done(pending)
        finally:
            stop.set()
            pool.shutdown(wait=True, cancel_futures=True)


def _as_done(pending: set[Future[Verdict]]) -> Iterator[Verdict]:
    while pending:
        done, pending = wait(pending, POLL, FIRST_COMPLETED)
        for future in done:
            yield future.result()


def _judged(drive: Drive, directory: Path, domains: 'queue.SimpleQueue[int]', stop: Event) -> Verdict:
    domain = domains.get()
    try:
        trial = make_trial(drive, directory, domain, stop)
    finally:
        domains.put(domain)
    verdict = judge(drive, trial)
    if verdict.passed:
        for end in ('.yaml', '.txt'):
            trial.directory.with_suffix(end).unlink()
        shutil.rmtree(trial.directory)
    return verdict
