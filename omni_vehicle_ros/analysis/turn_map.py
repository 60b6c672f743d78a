"""Where over radius and speed a vehicle has a steady turn, whether slow driving leads to it, and by what margin."""

import csv
import functools
import math
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from omni_vehicle_ros.analysis.map_request import MapRequest
from omni_vehicle_ros.analysis.signals import Array
from omni_vehicle_ros.model.other_turns import TurnCurve, past_fold, tightened
from omni_vehicle_ros.model.steady_turn import Branch, Limit, steady_turns
from omni_vehicle_ros.model.turning import SteadyTurn, speed_of
from omni_vehicle_ros.model.tyres.region import Region
from omni_vehicle_ros.wheels import WHEELS

POINT_COLUMNS = (
    'radius', 'speed', 'exists', 'slow_driving', 'stable', 'margin', 'decay_rate', 'damping_ratio',
    'eigenvalue_1_real', 'eigenvalue_1_imag', 'eigenvalue_2_real', 'eigenvalue_2_imag',
    'path_radius', 'lateral_acceleration',
    *(f'side_slip_{wheel}' for wheel in WHEELS), *(f'region_{wheel}' for wheel in WHEELS),
)  # fmt: skip
LIMIT_COLUMNS = (
    'radius', 'limit_speed', 'cause', 'path_radius', 'lateral_acceleration', 'grip_speed', 'nonlinear_speed',
    'sliding_speed', 'axle_sliding_speed',
)  # fmt: skip
TAIL = (0.12, 0.09, 0.06, 0.04, 0.02, 0.01, 0.005)  # steps
HALVINGS = 10  # of a step between two speeds, to find where a tyre changes its region

Cell = float | str | None
Known = tuple[float, SteadyTurn]


class Column(NamedTuple):
    """The steady turns of one radius [m]: at every speed of the map the one that slow driving leads to, or None.

    ``others``: where there is none, another one, a stable one if there is, or None if none lies on the curves that
    are followed (see `omni_vehicle_ros.model.other_turns`); of two alike the one with less slip. ``limit`` up to the
    largest speed of the map; ``edge``: the turn at the limit, None if there is no limit; ``end``: the limit, or that
    largest speed [m/s]; ``tail``: more turns towards it, with their speeds; ``nonlinear``, ``sliding``: speed from
    which on a tyre is past its linear region, and slides [m/s], None if none does up to the end.
    """

    radius: float
    turns: tuple[SteadyTurn | None, ...]
    others: tuple[SteadyTurn | None, ...]
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
    straight = steady_turns(vehicle, math.inf, road, speeds[-1])

    @functools.cache
    def tightening(speed: float) -> TurnCurve:
        return tightened(straight, speed, request.radii[0])

    for number, radius in enumerate(request.radii):
        progress(number)
        columns.append(_column(steady_turns(vehicle, radius, road, speeds[-1]), speeds, tightening))
    progress(len(request.radii))
    return TurnMap(request, tuple(columns))


def _column(branch: Branch, speeds: Sequence[float], tightening: Callable[[float], TurnCurve]) -> Column:
    limit = branch.limit
    if limit.speed is not None and limit.speed > speeds[-1]:
        limit = limit._replace(speed=None, cause=None)
    end = speeds[-1] if limit.speed is None else limit.speed
    edge = None if limit.speed is None else branch.turn(limit.speed)
    turns = tuple(branch.turn(speed) if speed <= end else None for speed in speeds)
    tail = _tail(branch, max((speed for speed in speeds if speed < end), default=0.0), end)
    if edge and not tail:
        tail = ((end, edge),)
    known = [*((speed, turn) for speed, turn in zip(speeds, turns, strict=True) if turn), *tail]
    return Column(
        radius=branch.turning.radius,
        turns=turns,
        others=tuple(_others(branch, end, speeds, tightening)),
        limit=limit,
        edge=edge,
        end=end,
        tail=tail,
        nonlinear=_first(branch, known, Region.NONLINEAR),
        sliding=_first(branch, known, Region.SLIDING),
    )


def _others(
    branch: Branch, end: float, speeds: Sequence[float], tightening: Callable[[float], TurnCurve]
) -> Iterator[SteadyTurn | None]:
    """Yield for every speed the best of the turns that slow driving does not lead to, None where it leads to one."""
    rest = past_fold(branch, speeds[-1])
    for speed in speeds:
        found = [] if speed <= end else _past_the_limit(branch, rest, tightening(speed), speed)
        yield min(found, key=lambda turn: (not turn.stable, worst_slip(turn)), default=None)


def _past_the_limit(branch: Branch, rest: TurnCurve, tightening: TurnCurve, speed: float) -> list[SteadyTurn]:
    """Return the turns of a speed [m/s]; where the branch goes on without a fold, it may be stable again farther on."""
    beyond = branch.turn(speed)
    others = [*rest.turns(speed), *tightening.turns(branch.turning.radius)]
    return others if beyond is None else [beyond, *others]


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

    In ``map.csv``, ``exists`` says whether a steady turn lies on the curves that slow driving begins, ``slow_driving``
    whether it is the one that a vehicle comes to that speeds up with its wheels held, as it does up to the limit speed
    and not beyond, and ``stable`` whether the turn of this row is stable, as those of slow driving are. The margin is
    the share of the limit speed that is left, negative past it. A cell is empty where there is no such number: no
    steady turn, no limit up to the largest speed, a damping ratio of a saddle. `SteadyTurn` and `Limit` say what the
    others are. In ``limit.csv`` path and acceleration are those at the limit; ``sliding_speed`` is that from which on
    one tyre slides, ``axle_sliding_speed`` that from which on both of an axle do.
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
        for speed, slow, other in zip(found.request.speeds, column.turns, column.others, strict=True):
            turn, margin = slow or other, column.limit.margin(speed)
            flags = map(_word, (turn is not None, slow is not None, turn is not None and turn.stable))
            start: list[Cell] = [column.radius, speed, *flags, margin]
            yield start + (_turn_cells(turn) if turn else [None] * (len(POINT_COLUMNS) - len(start)))


def _turn_cells(turn: SteadyTurn) -> list[Cell]:
    first, second = turn.eigenvalues
    return [
        turn.decay_rate, turn.damping_ratio, first.real, first.imag, second.real, second.imag,
        turn.path_radius, turn.lateral_acceleration,
        *turn.side_slip, *(place.name.lower() for place in turn.region),
    ]  # fmt: skip


def _limit_row(column: Column) -> list[Cell]:
    edge, (speed, cause, grip_speed, slide_speed) = column.edge, column.limit
    path = (edge.path_radius, edge.lateral_acceleration) if edge else (None, None)
    return [column.radius, speed, cause, *path, grip_speed, column.nonlinear, column.sliding, slide_speed]


def _word(flag: bool) -> str:
    return str(flag).lower()


def field(found: TurnMap, quantity: Callable[[SteadyTurn], float], speeds: Array) -> Array:
    """Return a quantity of the turns of slow driving, for a drawing; beyond the last one it stays as it was there.

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
