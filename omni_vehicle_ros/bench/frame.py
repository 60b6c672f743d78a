"""What all benchmarks share: works timed in turn, lines that stand beside a bare limit, and how to print them.

A machine may be slow, or shared with others: no figure means much but beside a bare limit that was measured in the
same run. So works take turns, round by round, CPU time counts, and a fixed piece of work tells of the machine itself.
"""

import importlib
import os
import platform
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from statistics import median
from typing import Any, NamedTuple

import numpy as np

ROUNDS = 5
SORTS, SORTED = 100, 20_000
"""The fixed piece of work: how often it sorts how many numbers."""
CALIBRATION = 'calibration'

Progress = Callable[[float], None]
"""Told the share that is done, 0 to 1."""


class Time(NamedTuple):
    """How long a work took [s]."""

    wall: float
    cpu: float


class Goal(NamedTuple):
    """What the ratio of our figure to the bare limit's should be; see `at_most` and `at_least`."""

    word: str
    ratio: float

    def met(self, ratio: float) -> bool:
        """Return whether a ratio is as good."""
        return ratio <= self.ratio if self.word == 'at most' else ratio >= self.ratio


def at_most(ratio: float) -> Goal:
    """Return a goal for times: not above ``ratio``."""
    return Goal('at most', ratio)


def at_least(ratio: float) -> Goal:
    """Return a goal for rates: not below ``ratio``."""
    return Goal('at least', ratio)


class Line(NamedTuple):
    """One figure beside its bare limit.

    Attributes
    ----------
    name
        What was measured.
    unit
        Of both figures.
    ours, limit
        Our figure and that of the bare limit; None where it could not be measured, and then `note` says why.
    against
        What the bare limit is.
    goal
        For `ratio`, if there is one.
    note
        What a reader must know to read the line.
    """

    name: str
    unit: str
    ours: float | None
    limit: float | None = None
    against: str = ''
    goal: Goal | None = None
    note: str = ''

    @property
    def ratio(self) -> float | None:
        """Our figure over that of the bare limit."""
        return None if self.ours is None or not self.limit else self.ours / self.limit

    @property
    def met(self) -> bool | None:
        """Whether the goal is met; None where there is no goal or no ratio."""
        return None if self.goal is None or self.ratio is None else self.goal.met(self.ratio)

    @property
    def text(self) -> str:
        """What to print."""
        parts = [f'{self.name}: {"not measured" if self.ours is None else f"{number(self.ours)} {self.unit}"}']
        if self.against:
            parts.append(f'{self.against} {"not measured" if self.limit is None else number(self.limit)}')
        if self.ratio is not None:
            parts.append(f'ratio {number(self.ratio)}')
        if self.goal is not None:
            verdict = {True: ': met', False: ': MISSED', None: ''}[self.met]
            parts.append(f'goal {self.goal.word} {self.goal.ratio:g}{verdict}')
        return ', '.join(parts) + (f' ({self.note})' if self.note else '')

    def as_json(self) -> dict[str, Any]:
        """Return it as JSON has it."""
        goal = None if self.goal is None else f'{self.goal.word} {self.goal.ratio:g}'
        return {**self._asdict(), 'ratio': self.ratio, 'goal': goal, 'met': self.met}


class Result(NamedTuple):
    """What a benchmark found; ``calibration`` is that of `interleaved`, ``notes`` hold for all lines."""

    lines: tuple[Line, ...]
    calibration: Time
    notes: tuple[str, ...] = ()

    @property
    def text(self) -> tuple[str, ...]:
        """What to print, line by line."""
        wall, cpu = self.calibration
        machine = f'calibration: {wall * 1e3:.1f} ms wall, {cpu * 1e3:.1f} ms CPU, wall/CPU {wall / cpu:.2f}'
        return (*self.notes, *(line.text for line in self.lines), machine)

    def as_json(self) -> dict[str, Any]:
        """Return it as JSON has it."""
        wall, cpu = self.calibration
        return {
            'lines': [line.as_json() for line in self.lines],
            'calibration': {'wall': wall, 'cpu': cpu, 'wall_per_cpu': wall / cpu},
            'notes': list(self.notes),
        }


def number(value: float) -> str:
    """Return a number with three digits or more, in groups of thousands."""
    return f'{value:,.0f}' if abs(value) >= 1000.0 else f'{value:.3g}'


def timed(work: Callable[[], Time | object]) -> Time:
    """Run a work and return its time; one that returns a `Time` has measured itself, such as of other processes."""
    wall, cpu = time.perf_counter(), time.process_time()
    found = work()
    return found if isinstance(found, Time) else Time(time.perf_counter() - wall, time.process_time() - cpu)


def interleaved(
    works: Mapping[str, Callable[[], Time | object]], progress: Progress, rounds: int = ROUNDS
) -> dict[str, Time]:
    """Run all works in turn, round by round, and return the medians of their times, and of `CALIBRATION`.

    Parameters
    ----------
    works
        By name.
    progress
        Told the share that is done.
    rounds
        After one whose times don't count, in which what is compiled is loaded.
    """
    all_works = {**works, CALIBRATION: calibrate}
    times: dict[str, list[Time]] = {name: [] for name in all_works}
    for done in range(rounds + 1):
        progress(done / (rounds + 1))
        for name, work in all_works.items():
            times[name].append(timed(work))
    progress(1.0)
    return {name: Time(*map(median, zip(*found[1:], strict=True))) for name, found in times.items()}


def calibrate() -> None:
    """Do the fixed piece of work: wall above CPU time means a machine that is shared."""
    numbers = np.random.default_rng(0).random(SORTED)
    for _ in range(SORTS):
        np.sort(numbers)


def run_bench(name: str, progress: Progress) -> Result:
    """Run one of `omni_vehicle_ros.bench.BENCHES`."""
    result: Result = importlib.import_module(f'omni_vehicle_ros.bench.{name}').bench(progress)
    return result


def machine() -> dict[str, Any]:
    """Return what this machine calls itself."""
    model = platform.processor()
    information = Path('/proc/cpuinfo')
    if information.exists():
        lines = information.read_text(encoding='utf-8', errors='replace').splitlines()
        model = next((line.partition(':')[2].strip() for line in lines if line.startswith('model name')), model)
    return {
        'processor': model, 'cores': os.cpu_count(), 'system': platform.platform(), 'python': platform.python_version(),
    }
