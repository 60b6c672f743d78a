"""What a person sees in the terminal: a progress bar, and a short table of results."""

import math
from collections.abc import Mapping
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Column, Table
from rich.text import Text

from omni_vehicle_ros.analysis.troubles import troubles
from omni_vehicle_ros.bags import open_bag
from omni_vehicle_ros.run import RunResult
from omni_vehicle_ros.scenarios import Scenario
from omni_vehicle_ros.wheels import WHEELS

if TYPE_CHECKING:
    from omni_vehicle_ros.analysis.turn_map import TurnMap

SHOWN = 6
LIMITS_SHOWN = 12
KMH = 3.6


class ProgressBar:
    """Shows how far something is, such as a run in simulated time.

    Parameters
    ----------
    name
        What it is.
    total
        How far it is in the end.
    unit
        Of that.
    """

    def __init__(self, name: str, total: float, unit: str = 's') -> None:
        form = ':.1f' if unit in ('s', 'MB') else ''
        number = f'{{task.completed{form}}} of {{task.total{form}}}'
        columns = (
            TextColumn('{task.description}', markup=False),
            BarColumn(),
            TextColumn(f'{number} {unit}'),
            TimeElapsedColumn(),
        )
        self._progress = Progress(*columns, console=Console(stderr=True))
        self._task = self._progress.add_task(name, total=total)

    def __enter__(self) -> 'ProgressBar':
        """Show nothing yet: a run that can't begin ends with one line."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Leave the bar as it is."""
        if self._progress.live.is_started:
            self._progress.stop()

    def advance(self, completed: float) -> None:
        """Move the bar, in the unit of the total; the first call shows it."""
        if not self._progress.live.is_started:
            self._progress.start()
        self._progress.update(self._task, completed=completed)


def results_table(scenario: Scenario, result: RunResult) -> None:
    """Print the results of a run, with the paths of its bag and its report."""
    metrics = result.metrics
    table = Table('', *(wheel.replace('_', ' ') for wheel in WHEELS), title=Text(f'{scenario.name}: side slip'))
    rows = (
        ('steady state [deg]', 'steady_state', math.degrees(1.0)),
        ('peak [deg]', 'peak', math.degrees(1.0)),
        ('overshoot [%]', 'overshoot', 100.0),
        ('settling time [s]', 'settling_time', 1.0),
    )
    for title, key, factor in rows:
        table.add_row(Text(title), *(_number(metrics['side_slip'][wheel][key], factor) for wheel in WHEELS))
    console = Console(soft_wrap=True)
    console.print(table)
    x, y, heading = metrics['path']['final']
    speed, radius, yaw_rate = metrics['speed'], metrics['path']['radius'], metrics['yaw_rate']['steady_state']
    for line in (
        f'end at x {x:.2f} m, y {y:.2f} m, heading {math.degrees(heading):.1f} deg; path radius {_number(radius)} m',
        f'speed {_number(speed["initial"])} -> {_number(speed["final"])} m/s; yaw rate {_number(yaw_rate)} rad/s',
        *_unsteady(metrics['steady']),
        f'{result.messages} messages, {result.lost} lost; '
        f'{result.rate:.1f} x real time after {result.start:.1f} s to start',
        *restart_lines(result.restarts),
        *complaints(result.directory),
        f'bag     {result.directory / "bag"}',
        f'report  {result.directory / "report.html"}',
    ):
        console.print(line, highlight=False, markup=False)


def limit_table(found: 'TurnMap') -> None:
    """Print the limit speeds of a turn map, for some of its radii."""
    heads = (
        'radius [m]', 'limit [m/s]', 'limit [km/h]', 'lost by', 'path there [m]', 'runs wide from [m/s]',
        'an axle slides from [m/s]',
    )  # fmt: skip
    table = Table(*(Column(Text(head)) for head in heads), title=Text(f'{found.request.title}: limit speed'))
    top = found.request.speeds[-1]
    for column in found.columns[:: max(1, (len(found.columns) - 1) // LIMITS_SHOWN)]:
        speed, cause, grip_speed, slide_speed = column.limit
        limit = (f'above {top:g}', '-') if speed is None else (f'{speed:.3f}', f'{speed * KMH:.2f}')
        last = column.turns[-1] if speed is None else column.edge
        path = last.path_radius if last else None
        marks = map(_number, (path, grip_speed, slide_speed))
        table.add_row(_number(column.radius), *limit, cause or '-', *marks)
    Console(soft_wrap=True).print(table)


def restart_lines(restarts: Mapping[str, int]) -> list[str]:
    """Return which nodes were started again, and how often."""
    return [f'{role} died and was started again, {count} x' for role, count in restarts.items()]


def complaints(directory: Path) -> list[str]:
    """Return what the nodes complained about in a run, the first few."""
    found = troubles(open_bag(directory / 'bag'))
    more = [f'... and {len(found) - SHOWN} more on /diagnostics'] if len(found) > SHOWN else []
    lines = [f'{trouble.time:8.3f} s  {trouble.node}: {trouble.message}' for trouble in found[:SHOWN]]
    return [*lines, *more]


def _unsteady(steady: Mapping[str, Any]) -> list[str]:
    """Return why there is no steady state, and up to which speed there would be one, if that is known."""
    if steady['reached']:
        return []
    limit = steady['limit_speed']
    known = '' if limit is None else f'; limit speed of this turn {limit:.3f} m/s ({steady["limit_cause"]})'
    return [f'no steady state at the end: {steady["reason"]}{known}']


def _number(value: Any, factor: float = 1.0) -> str:
    return '-' if value is None else f'{value * factor:.3g}'
