"""Turns that are settled before they begin, driven side by side."""

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from omni_vehicle_ros.analysis.signals import WINDOW as LAST_TIME
from omni_vehicle_ros.model.batch import packed_batch
from omni_vehicle_ros.model.batch_compiled import WIDTH
from omni_vehicle_ros.model.packing import STATE
from omni_vehicle_ros.model.state import Vector
from omni_vehicle_ros.sweep.open_loop import OpenLoop
from omni_vehicle_ros.sweep.watch import LEAST_LOAD, ROWS, SIGNALS, WINDOW, watch_kernel

_ANGLES, _GAINS, _ROAD, _RATES = STATE, STATE + 8, STATE + 12, STATE + 18
_REQUEST = STATE + 22


class Driven(NamedTuple):
    """What came of turns.

    Attributes
    ----------
    rows
        All that `watch` keeps, shape (rows, n).
    samples
        How many there are in the last second; 0: the turns are shorter than that.
    """

    rows: Vector
    samples: int


def kind(turn: OpenLoop) -> tuple[object, ...]:
    """Return what turns must have in common that are driven together."""
    model = turn.constants
    tables = tuple(model.airflow_angles), tuple(model.side_force_coefficients)
    return (
        turn.cycles, turn.steps, turn.size, turn.constant_speed, model.tyre_model, model.friction_circle, *tables
    )


def drive(turns: Sequence[OpenLoop]) -> Driven:
    """Drive turns of one `kind`; each comes out as it would alone."""
    request, found = _start(turns)
    model = packed_batch([turn.constants for turn in _padded(turns)])
    one, shared = turns[0], np.ascontiguousarray(model[:, 0])
    window = _last_cycles(one)

    def go(cycles: int, steps: int, at_the_end: bool) -> None:
        watch_kernel(
            request, model, shared, cycles, steps, one.size, one.constant_speed, at_the_end, 0, request.shape[1],
            WIDTH, found,
        )  # fmt: skip
        request[:STATE] = found[:STATE]

    go(1, 0, False)  # a look at the vehicles as they begin
    begin, acting = one.cycles - window, _acting(turns)
    for first, last in pairwise(sorted({*acting, begin, one.cycles})):
        for column, numbers in acting.get(first, ()):
            request[_ANGLES:_GAINS, column] = numbers[:8]
            request[_ROAD:_RATES, column] = numbers[8:]
        go(last - first, one.steps, first >= begin)
    return Driven(found[:, : len(turns)], window)


def _padded(turns: Sequence[OpenLoop]) -> list[OpenLoop]:
    """Return the turns, with the last one again up to a whole number of blocks."""
    return [*turns, *[turns[-1]] * (-len(turns) % WIDTH)]


def _start(turns: Sequence[OpenLoop]) -> tuple[Vector, Vector]:
    """Return the request for vehicles that roll straight on, and the rows that nothing has been seen for."""
    all_turns = _padded(turns)
    request = np.zeros((_REQUEST, len(all_turns)))
    request[0] = [turn.speed for turn in all_turns]
    request[_GAINS : _GAINS + 4] = np.transpose([turn.slip_gain for turn in all_turns])
    request[_ROAD : _ROAD + 6] = np.transpose([(r.bank, r.wind, *r.friction) for r in (t.road for t in all_turns)])
    found = np.zeros((ROWS, len(all_turns)))
    found[LEAST_LOAD : LEAST_LOAD + 4] = np.inf
    found[WINDOW::3], found[WINDOW + 1 :: 3] = np.inf, -np.inf
    return request, found


def _acting(turns: Sequence[OpenLoop]) -> dict[int, list[tuple[int, tuple[float, ...]]]]:
    """Return in which cycle what begins to act on which vehicle."""
    found: dict[int, list[tuple[int, tuple[float, ...]]]] = {}
    for column, turn in enumerate(_padded(turns)):
        for acting in turn.acting:
            found.setdefault(acting.cycle, []).append((column, acting.numbers))
    return found


def _last_cycles(turn: OpenLoop) -> int:
    """Return how many samples there are in the last second of a turn, or 0; see `analysis.signals.last_window`."""
    per_second = LAST_TIME / (turn.steps * turn.size)
    samples = int(per_second * (1.0 + 1e-9)) + 1
    return samples if turn.cycles - 1 >= per_second * (1.0 - 1e-9) else 0


def signal(found: Driven, name: str) -> tuple[Vector, Vector, Vector]:
    """Return the smallest value, the largest and the mean of one of `SIGNALS` in the last second, shape (n,)."""
    row = WINDOW + 3 * SIGNALS.index(name)
    low, high, total = found.rows[row : row + 3]
    return low, high, total / max(found.samples, 1)
