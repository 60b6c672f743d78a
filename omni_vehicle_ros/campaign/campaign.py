"""A campaign from the first drive to the last: trials side by side, verdicts, tables."""

import queue
import shutil
import time
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from contextlib import contextmanager
from pathlib import Path
from threading import Event

from omni_vehicle_ros.campaign.draw import Drive, draw
from omni_vehicle_ros.campaign.judge import Verdict, judge
from omni_vehicle_ros.campaign.store import Campaign, Request, read_before
from omni_vehicle_ros.campaign.tables import write_tables
from omni_vehicle_ros.campaign.trial import make_trial

POLL = 0.2


def run_campaign(request: Request, directory: Path, progress: Callable[[int], None]) -> list[Verdict]:
    """Make all drives of a campaign that are not in a directory yet; leave tables, and what did not pass.

    Parameters
    ----------
    request
        What is asked for.
    directory
        Where to; new, or with drives of this campaign.
    progress
        Called with how many drives are over.

    Raises
    ------
    RunError
        The directory holds something else.
    """
    drives = draw(request.runs, request.seed, request.mode)
    before = read_before(directory, request, drives)
    verdicts = {verdict.drive.number: verdict for verdict in before.verdicts}
    domains: queue.SimpleQueue[int] = queue.SimpleQueue()
    for job in range(request.jobs):
        domains.put(request.domain + job)
    begun = time.monotonic() - before.wall
    directory.mkdir(parents=True, exist_ok=True)
    progress(len(verdicts))
    with _each([drive for drive in drives if drive.number not in verdicts], directory, domains, request.jobs) as found:
        for verdict in found:
            verdicts[verdict.drive.number] = verdict
            progress(len(verdicts))
            write_tables(Campaign(request, time.monotonic() - begun, _in_order(verdicts)), directory)
    return _in_order(verdicts)


def _in_order(verdicts: Mapping[int, Verdict]) -> list[Verdict]:
    return [verdict for _, verdict in sorted(verdicts.items())]


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
