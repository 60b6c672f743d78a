"""What came of the turns of a sweep, cell by cell over its first axes, in bounded memory."""

import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from pyarrow import dataset

from omni_vehicle_ros.model.state import Vector
from omni_vehicle_ros.sweep.axes import Axis
from omni_vehicle_ros.sweep.study import Study
from omni_vehicle_ros.wheels import WHEELS

MOST_BINS, SAMPLES = 40, 25
"""Cells along an axis that is drawn from a distribution, at most, and samples in a cell that make one worth while."""
TAIL = 0.005
"""Share of the draws that lie beyond the first edge, and beyond the last; they count in these two cells."""


class Quantity(NamedTuple):
    """A number for each turn, made from its columns.

    Attributes
    ----------
    title, unit
        What it is.
    columns
        What `value` takes, one array each.
    value
        Makes it.
    settled
        Whether it means something only where a turn has settled.
    """

    title: str
    unit: str
    columns: tuple[str, ...]
    value: Callable[..., Any]
    settled: bool = False


def _wheels(name: str) -> tuple[str, ...]:
    return tuple(f'{name}_{wheel}' for wheel in WHEELS)


def _largest(*values: Vector) -> Vector:
    found: Vector = np.max(np.abs(values), axis=0)
    return found


QUANTITIES = {
    'settled': Quantity('Turns that settle', '%', ('settled',), lambda flag: 100.0 * flag),
    'side_slip': Quantity(
        'Worst side slip of the four tyres', '°', _wheels('side_slip'), lambda *slip: np.degrees(_largest(*slip)), True
    ),
    'path_radius': Quantity('Radius of the path', 'm', ('path_radius',), np.abs, True),
    'lateral_acceleration': Quantity('Lateral acceleration', 'm/s²', ('lateral_acceleration',), np.abs, True),
    'friction_use': Quantity('Largest use of friction', '1', _wheels('friction_use_peak'), _largest),
    'load': Quantity(
        'Smallest vertical load', 'kN', _wheels('load_minimum'), lambda *load: 1e-3 * np.min(load, axis=0)
    ),
}


class Edges(NamedTuple):
    """Cells along an axis: their middles, and the edges between and around them."""

    axis: Axis
    middles: Vector
    edges: Vector

    def place(self, values: Vector) -> npt.NDArray[np.int64]:
        """Return in which cell values lie; those beyond the ends in the first and the last."""
        return np.clip(np.searchsorted(self.edges, values, side='right') - 1, 0, len(self.middles) - 1)


class Cells(NamedTuple):
    """What came of the turns in each cell.

    Attributes
    ----------
    axes
        One or two; rows of what follows belong to the last one.
    counts
        Turns, shape (m, n) or (n,).
    mean, low, high
        Of each of `QUANTITIES`, NaN where there is none.
    flags
        How many turns have each flag.
    """

    axes: tuple[Edges, ...]
    counts: Vector
    mean: Mapping[str, Vector]
    low: Mapping[str, Vector]
    high: Mapping[str, Vector]
    flags: Mapping[str, int]


def cells(study: Study, table: Path) -> Cells:
    """Read the table of a study once, and return what came of its turns.

    Over any further axes and over samples, all turns of a cell count alike.
    """
    shown = [axis for axis in study.axes if axis.distribution or _numeric(axis)][:2]
    drawn = sum(axis.distribution is not None for axis in shown)
    bins = min(MOST_BINS, max(2, int((study.samples / SAMPLES) ** (1.0 / max(drawn, 1)))))
    axes = tuple(_edges(axis, bins) for axis in shown)
    shape = tuple(len(edges.middles) for edges in axes[::-1])
    size = math.prod(shape)
    counts = np.zeros(size)
    sums, used = ({name: np.zeros(size) for name in QUANTITIES} for _ in range(2))
    low, high = ({name: np.full(size, end) for name in QUANTITIES} for end in (np.inf, -np.inf))
    flags = dict.fromkeys(('settled', 'left_linear', 'lifted', 'spun'), 0)
    wanted = {*flags, *(edges.axis.name for edges in axes), *(c for q in QUANTITIES.values() for c in q.columns)}
    for batch in dataset.dataset(table).to_batches(columns=sorted(wanted)):
        columns = {name: batch.column(name).to_numpy(zero_copy_only=False) for name in wanted}
        places = [edges.place(columns[edges.axis.name].astype(float)) for edges in axes[::-1]]
        cell = np.ravel_multi_index(places, shape) if axes else np.zeros(batch.num_rows, dtype=int)
        counts += np.bincount(cell, minlength=size)
        for name, quantity in QUANTITIES.items():
            value = np.asarray(quantity.value(*(columns[column].astype(float) for column in quantity.columns)))
            there = np.isfinite(value) & (columns['settled'].astype(bool) | (not quantity.settled))
            sums[name] += np.bincount(cell[there], value[there], minlength=size)
            used[name] += np.bincount(cell[there], minlength=size)
            np.minimum.at(low[name], cell[there], value[there])
            np.maximum.at(high[name], cell[there], value[there])
        for flag in flags:
            flags[flag] += int(np.count_nonzero(columns[flag]))
    with np.errstate(invalid='ignore', divide='ignore'):
        mean = {name: (sums[name] / used[name]).reshape(shape) for name in QUANTITIES}
    for end in (low, high):
        end.update({name: np.where(used[name] > 0, end[name], np.nan).reshape(shape) for name in QUANTITIES})
    return Cells(axes, counts.reshape(shape), mean, low, high, flags)


def _numeric(axis: Axis) -> bool:
    return len(axis.values) > 1 and all(type(value) in (int, float) for value in axis.values)


def _edges(axis: Axis, bins: int) -> Edges:
    """Return the cells of an axis: about each value, or with equal shares of a distribution."""
    if axis.distribution is not None:
        edges = axis.distribution.quantiles(np.linspace(TAIL, 1.0 - TAIL, bins + 1))
        return Edges(axis, 0.5 * (edges[:-1] + edges[1:]), edges)
    middles = np.array(sorted(axis.values), dtype=float)
    between = 0.5 * (middles[:-1] + middles[1:])
    first, last = 2.0 * middles[0] - between[0], 2.0 * middles[-1] - between[-1]
    return Edges(axis, middles, np.array([first, *between, last]))
