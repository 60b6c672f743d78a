"""Where over radius and speed a vehicle has a steady turn, and by what margin it is stable: numbers and files."""

import csv
import math
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from omni_vehicle_ros.analysis.map_request import MapRequest
from omni_vehicle_ros.analysis.signals import Array
from omni_vehicle_ros.model.steady_turn import Branch, Limit, steady_turns
from omni_vehicle_ros.model.turning import SteadyTurn, speed_of
from omni_vehicle_ros.model.tyres.region import Region
from omni_vehicle_ros.wheels import WHEELS

POINT_COLUMNS = (
    'radius', 'speed', 'exists', 'stable', 'margin', 'decay_rate', 'damping_ratio',
    'eigenvalue_1_real', 'eigenvalue_1_imag', 'eigenvalue_2_real', 'eigenvalue_2_imag',
    'path_radius', 'lateral_acceleration',
    *(f'side_slip_{wheel}' for wheel in WHEELS), *(f'region_{wheel}' for wheel in WHEELS),
)  # fmt: skip
LIMIT_COLUMNS = (
    'radius', 'limit_speed', 'cause', 'grip_speed', 'nonlinear_speed', 'sliding_speed', 'path_radius',
    'lateral_acceleration',
)  # fmt: skip
TAIL = (0.12, 0.09, 0.06, 0.04, 0.02, 0.01, 0.005)  # steps
HALVINGS = 10  # of a step between two speeds, to find where a tyre changes its region

Cell = float | str | None
Known = tuple[float, SteadyTurn]


class Column(NamedTuple):
    """The steady turns of one radius [m]: the turn at every speed of the map, None where there is none.

    ``limit`` up to the largest speed of the map; ``edge``: the turn at the limit, None if there is no limit; ``end``:
    speed up to which there are steady turns [m/s]; ``tail``: more turns towards it, with their speeds; ``nonlinear``,
    ``sliding``: speed from which on a tyre is past its linear region, and slides [m/s], None if none does.
    """

    radius: float
    turns: tuple[SteadyTurn | None, ...]
    limit: Limit
    edge: SteadyTurn | None
    end: float
    tail: tuple[Known, ...]
    nonlinear: float | None
    sliding: float | None


class TurnMap(NamedTuple):
    """The steady turns that were asked for, radius by radius."""

    request: MapRequest
    columns: tuple[Column, ...]


def turn_map(request: MapRequest, progress: Callable[[float], None] = lambda done: None) -> TurnMap:
    """Find the steady turns of a vehicle over radius and speed.

    Parameters
    ----------
    request
        Where to look.
    progress
        Called with the number of radii that are done.
    """
    vehicle, road, speeds, columns = request.vehicle, request.environment, request.speeds, []
    for number, radius in enumerate(request.radii):
        progress(number)
        columns.append(_column(steady_turns(vehicle, radius, road, speeds[-1]), speeds))
    progress(len(request.radii))
    return TurnMap(request, tuple(columns))


def _column(branch: Branch, speeds: Sequence[float]) -> Column:
    limit, end = branch.limit, min(branch.end, speeds[-1])
    if limit.speed is not None and limit.speed > speeds[-1]:
        limit = limit._replace(speed=None, cause=None)
    turns = tuple(branch.turn(speed) for speed in speeds)
    tail = _tail(branch, max((speed for speed in speeds if speed < end), default=0.0), end)
    known = [*((speed, turn) for speed, turn in zip(speeds, turns, strict=True) if turn), *tail]
    return Column(
        radius=branch.turning.radius,
        turns=turns,
        limit=limit,
        edge=None if limit.speed is None else branch.turn(limit.speed),
        end=end,
        tail=tail,
        nonlinear=_first(branch, known, Region.NONLINEAR),
        sliding=_first(branch, known, Region.SLIDING),
    )


def _tail(branch: Branch, start: float, end: float) -> tuple[Known, ...]:
    """Return turns between two speeds by steps along the branch from its end: at a fold all bends sharply."""
    if not branch.points:
        return ()
    last = branch.points[-1]
    points = (*(branch.turning.curve.stepped(last, -step) for step in TAIL), last)
    known = [(speed_of(point), branch.turning.turn(point)) for point in points if point is not None]
    return tuple((speed, turn) for speed, turn in known if start < speed <= end)


def _first(branch: Branch, known: Sequence[Known], place: Region) -> float | None:
    """Return the lowest speed at which a tyre works in a region or beyond it."""
    there = [number for number, (_, turn) in enumerate(known) if max(turn.region) >= place]
    if not there:
        return None
    low, high = known[max(0, there[0] - 1)][0], known[there[0]][0]
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        turn = branch.turn(middle)
        low, high = (low, middle) if turn is not None and max(turn.region) >= place else (middle, high)
    return high


def worst_slip(turn: SteadyTurn) -> float:
    """Return the largest side slip of the four tyres, without sign [rad]."""
    return max(map(abs, turn.side_slip))


def write_tables(found: TurnMap, directory: Path) -> None:
    """Write ``map.csv``, a row for every radius and speed, and ``limit.csv``, a row for every radius; SI, rad.

    A cell is empty where there is no such number: no steady turn, no limit up to the largest speed, a damping ratio
    of a saddle. The margin is the share of the limit speed that is left; `SteadyTurn` and `Limit` say what the others
    are. In ``limit.csv`` path and acceleration are those at the limit.
    """
    _write(directory / 'map.csv', POINT_COLUMNS, _point_rows(found))
    _write(directory / 'limit.csv', LIMIT_COLUMNS, map(_limit_row, found.columns))


def _write(path: Path, columns: Sequence[str], rows: Iterator[list[Cell]]) -> None:
    with path.open('w', encoding='utf-8', newline='') as file:
        writer = csv.writer(file, lineterminator='\n')
        writer.writerow(columns)
        for row in rows:
            writer.writerow('' if cell is None else cell if isinstance(cell, str) else f'{cell:.7g}' for cell in row)


def _point_rows(found: TurnMap) -> Iterator[list[Cell]]:
    for column in found.columns:
        for speed, turn in zip(found.request.speeds, column.turns, strict=True):
            margin = column.limit.margin(speed)
            start: list[Cell] = [column.radius, speed, _word(turn is not None), _word(_stable(turn)), margin]
            yield start + (_turn_cells(turn) if turn else [None] * (len(POINT_COLUMNS) - len(start)))


def _turn_cells(turn: SteadyTurn) -> list[Cell]:
    first, second = turn.eigenvalues
    return [
        turn.decay_rate, turn.damping_ratio, first.real, first.imag, second.real, second.imag,
        turn.path_radius, turn.lateral_acceleration,
        *turn.side_slip, *(place.name.lower() for place in turn.region),
    ]  # fmt: skip


def _limit_row(column: Column) -> list[Cell]:
    edge, (speed, cause, grip_speed) = column.edge, column.limit
    path = (edge.path_radius, edge.lateral_acceleration) if edge else (None, None)
    return [column.radius, speed, cause, grip_speed, column.nonlinear, column.sliding, *path]


def _stable(turn: SteadyTurn | None) -> bool:
    return turn is not None and turn.stable


def _word(flag: bool) -> str:
    return str(flag).lower()


def field(found: TurnMap, quantity: Callable[[SteadyTurn], float], speeds: Array) -> Array:
    """Return a quantity over radius and speed, for a drawing; beyond the last steady turn it stays as it was there.

    Parameters
    ----------
    found
        The map.
    quantity
        Takes a steady turn.
    speeds
        At which to return it, by linear interpolation [m/s], shape (m,).

    Returns
    -------
    ndarray
        Shape (m, radii); NaN for a radius without any steady turn.
    """
    columns = []
    for column in found.columns:
        there = [(speed, turn) for speed, turn in zip(found.request.speeds, column.turns, strict=True) if turn]
        known = [(speed, quantity(turn)) for speed, turn in (*there, *column.tail)]
        columns.append(np.interp(speeds, *np.array(known or [(0.0, math.nan)]).T))
    return np.array(columns).T
