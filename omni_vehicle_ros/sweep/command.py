"""What ``omni_vehicle sweep`` does."""

import time
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from typing import NamedTuple

from omni_vehicle_ros.errors import RunError
from omni_vehicle_ros.sweep.parts import Parts
from omni_vehicle_ros.sweep.study import Study
from omni_vehicle_ros.sweep.turns import turn
from omni_vehicle_ros.sweep.work import on_cluster, on_this_machine

PAGE = 'index.html'

Progress = Callable[[float], None]


class Swept(NamedTuple):
    """What a sweep left.

    Attributes
    ----------
    table, page
        Directory of the parquet files, and the page about them.
    driven
        Turns that were driven now: the others were there.
    wall
        How long these took [s].
    """

    table: Path
    page: Path
    driven: int
    wall: float


def sweep(
    study: Study, directory: Path, scheduler: str | None = None, progress: Progress = lambda turns: None
) -> Swept:
    """Drive all turns of a study that are not in a directory yet, then draw them all.

    Parameters
    ----------
    study
        What is asked for.
    directory
        Gets ``sweep.json``, ``turns/``, ``map.svg``, ``map.png`` and ``index.html``; new, or with parts of this study.
    scheduler
        Address of the Dask scheduler whose workers drive; this machine's cores if None.
    progress
        Called with the number of turns that are done.

    Raises
    ------
    OmniVehicleError
        The directory holds something else, a turn can't be, a worker was lost, or the system refuses to write.
    """
    for point in study.corners:
        turn(study, point)
    parts = Parts(directory, study)
    missing = parts.missing
    driven = sum(len(study.numbers(number)) for number in missing)
    done, begin = study.turns - driven, time.monotonic()
    progress(done)
    if missing:
        work = on_cluster(study, missing, scheduler) if scheduler else on_this_machine(study, missing)
        with closing(work):
            for number, data in work:
                parts.write(number, data)
                done += len(study.numbers(number))
                progress(done)
    wall = time.monotonic() - begin
    return Swept(parts.table, _draw(study, directory, parts.table), driven, wall)


def _draw(study: Study, directory: Path, table: Path) -> Path:
    # Drawing takes a second to import: a sweep that can't begin should not pay for it.
    from omni_vehicle_ros.sweep.cells import cells
    from omni_vehicle_ros.sweep.maps import write_pictures
    from omni_vehicle_ros.sweep.page import render

    found = cells(study, table)
    title = f'{study.name}: {study.turns:,} turns'
    page = directory / PAGE
    try:
        pictures = write_pictures(found, title, directory)
        page.write_text(render(study, found, study.summary, pictures), encoding='utf-8')
    except OSError as error:
        raise RunError(f'{directory}: {error.strerror}') from None
    return page
