"""Reproduces figures and judges claims: computes what they need, once each, draws, and writes the pages."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from omni_vehicle_ros.results import new_directory
from omni_vehicle_ros.thesis import limits
from omni_vehicle_ros.thesis.claims import CLAIMS
from omni_vehicle_ros.thesis.figure import ThesisFigure
from omni_vehicle_ros.thesis.files import Shown, draw
from omni_vehicle_ros.thesis.pages import Judged, claims_data, claims_page, index_page, judge
from omni_vehicle_ros.thesis.registry import FIGURES, chosen
from omni_vehicle_ros.thesis.tasks import Results, Task, work_on
from omni_vehicle_ros.workers import Workers

PICTURES = 'figures'

Progress = Callable[[int], None]
Tasks = tuple[Task[Any], ...]


class Reproduction:
    """Figures to draw and, if they are all, claims to judge.

    Parameters
    ----------
    figure, chapter
        Number of the figure, or of the chapter whose figures are drawn; all and the claims if neither is given.

    Raises
    ------
    RunError
        There is no such figure or chapter, or both are given.
    """

    def __init__(self, figure: str | None = None, chapter: str | None = None) -> None:
        self._figures = chosen(figure, chapter)
        self._claims = figure is None and chapter is None
        needs = [task for entry in self._figures for task in entry.needs]
        self._tasks: Tasks = tuple(dict.fromkeys((*needs, *(claim_tasks() if self._claims else ()))))

    @property
    def jobs(self) -> int:
        """How many things there are to do."""
        return len(self._tasks) + len(self._figures)

    def write(self, directory: Path, progress: Progress = lambda done: None) -> None:
        """Do all.

        Parameters
        ----------
        directory
            Where ``index.html``, ``figures/`` and, with all figures, ``claims.md`` and ``claims.json`` go; must not
            exist.
        progress
            Called with the number of jobs that are done.

        Raises
        ------
        RunError
            The directory exists, or a worker process ended before its time.
        """
        counter = _Counter(progress)
        pictures = directory / PICTURES
        with new_directory(directory), new_directory(pictures), Workers() as workers:
            found = work_on(workers, self._tasks, counter)
            jobs = {entry.number: (entry.number, _part(found, entry), pictures) for entry in self._figures}
            shown = workers.each(jobs, _draw, counter)
            judged = judge(found) if self._claims else None
            (directory / 'index.html').write_text(index_page(shown, judged), encoding='utf-8')
            if judged is not None:
                (directory / 'claims.md').write_text(claims_page(judged), encoding='utf-8')
                (directory / 'claims.json').write_text(claims_data(judged), encoding='utf-8')


class _Counter:
    """Counts what is done."""

    def __init__(self, progress: Progress) -> None:
        self._progress, self._done = progress, 0

    def __call__(self) -> None:
        self._done += 1
        self._progress(self._done)


def claim_tasks() -> Tasks:
    """Return what the claims and the limits need."""
    return tuple(dict.fromkeys((*(task for claim in CLAIMS for task in claim.needs), *limits.TASKS)))


def judge_claims() -> Judged:
    """Judge the claims without any figure."""
    with Workers() as workers:
        return judge(work_on(workers, claim_tasks()))


def _part(found: Results, figure: ThesisFigure) -> Results:
    return Results({task: found[task] for task in figure.needs})


def _draw(number: str, results: Results, directory: Path) -> Shown:
    return draw(FIGURES[number], results, directory)
