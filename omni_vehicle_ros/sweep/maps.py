"""The pictures of a sweep: maps over its first two axes, or lines over its only one."""

from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from omni_vehicle_ros.analysis.style import ACCENT, INK, MUTED, PAPER, house_style
from omni_vehicle_ros.model.state import Vector
from omni_vehicle_ros.sweep.axes import Axis
from omni_vehicle_ros.sweep.cells import QUANTITIES, Cells, Quantity

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_SHADES = {
    'settled': 'BuGn', 'side_slip': 'YlOrRd', 'path_radius': 'viridis', 'lateral_acceleration': 'viridis',
    'friction_use': 'YlOrRd', 'load': 'viridis',
}  # fmt: skip
_SLIPS = (0.0, 0.5, 1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 10.0, 15.0, 20.0, 30.0)
_USES = (0.0, 0.2, 0.4, 0.6, 0.7, 0.8, 0.9, 0.95, 1.0)
_SHARES = (0.0, 10.0, 25.0, 50.0, 75.0, 90.0, 100.0)
_TICKS = {'side_slip': _SLIPS, 'friction_use': _USES, 'settled': _SHARES}
_STEPS = 10
_NOTHING, _NEXT_TO_NOTHING = '#eceff2', 1e-9


def write_pictures(found: Cells, title: str, directory: Path) -> tuple[Path, ...]:
    """Draw what came of a sweep as SVG and as PNG; nothing if no axis of it has numbers."""
    if not found.axes:
        return ()
    with house_style():
        figure = draw(found, title)
        paths = tuple(directory / f'map.{suffix}' for suffix in ('svg', 'png'))
        for path in paths:
            metadata = {'Date': None} if path.suffix == '.svg' else None
            figure.savefig(path, dpi=160.0, facecolor=PAPER, bbox_inches='tight', pad_inches=0.1, metadata=metadata)
    return paths


def draw(found: Cells, title: str) -> Figure:
    """Draw all quantities over the first axes of a sweep."""
    figure = Figure(figsize=(14.0, 8.4), layout='constrained')
    figure.suptitle(title, x=0.01, ha='left', fontsize=11.0, color=INK)
    panels = figure.subplots(2, 3, sharex=True)
    for axes, (name, quantity) in zip(panels.flat, QUANTITIES.items(), strict=True):
        axes.set_title(quantity.title + (', where settled' if quantity.settled else ''))
        if len(found.axes) == 1:
            _line(axes, found, name, quantity)
        else:
            _map(axes, found, name, quantity)
    for axes in panels[-1]:
        axes.set_xlabel(label(found.axes[0].axis))
    return figure


def label(axis: Axis) -> str:
    """Return what stands beside an axis: name and unit."""
    name = axis.name.rpartition('.')[2].replace('_', ' ')
    return f'{name} [{axis.unit}]' if axis.unit else name


def _line(axes: 'Axes', found: Cells, name: str, quantity: Quantity) -> None:
    """Draw the mean of the turns of a cell, and from the lowest to the highest of them."""
    x, low, high = found.axes[0].middles, found.low[name], found.high[name]
    if name == 'settled':
        axes.set_ylim(0.0, 105.0)
    else:
        axes.fill_between(x, low, high, facecolor=ACCENT, alpha=0.2, linewidth=0.0)
        _tell_of_nothing(axes, high)
    axes.plot(x, found.mean[name], color=ACCENT, marker='o' if len(x) <= _STEPS else None, markersize=3.0)
    axes.set_ylabel(f'[{quantity.unit}]')


def _tell_of_nothing(axes: 'Axes', values: Vector) -> None:
    """Say where there is no number, and let rounding not look like something."""
    known = values[np.isfinite(values)]
    if not known.size:
        axes.text(0.5, 0.5, 'none', transform=axes.transAxes, ha='center', va='center', color=MUTED)
        axes.set_yticks([])
    elif np.max(known) < _NEXT_TO_NOTHING:
        axes.set_ylim(-0.05, 1.0)


def _map(axes: 'Axes', found: Cells, name: str, quantity: Quantity) -> None:
    x, y = found.axes
    values = found.mean[name]
    levels = _levels(name, values)
    norm = BoundaryNorm(levels, 256, extend=_extent(name, levels[0]))
    cells = np.ma.masked_invalid(values)
    drawn = axes.pcolormesh(x.edges, y.edges, cells, norm=norm, cmap=_SHADES[name], rasterized=True, linewidth=0.0)
    axes.figure.colorbar(drawn, ax=axes, label=f'[{quantity.unit}]', ticks=levels, pad=0.02, format='%g')
    empty = np.where(found.counts == 0.0, 0.0, np.nan)
    axes.pcolormesh(x.edges, y.edges, np.ma.masked_invalid(empty), cmap=ListedColormap([PAPER]), rasterized=True)
    axes.patch.set(facecolor=_NOTHING, hatch='////', edgecolor=MUTED, linewidth=0.0)
    axes.set_ylabel(label(y.axis))
    axes.grid(False)


def _extent(name: str, lowest: float) -> Literal['neither', 'max', 'both']:
    """Return beyond which ends of a scale there may be values: sizes and shares begin at 0."""
    return 'neither' if name == 'settled' else 'max' if lowest == 0.0 else 'both'


def _levels(name: str, values: Vector) -> tuple[float, ...]:
    if name in _TICKS:
        return _TICKS[name]
    known = values[np.isfinite(values)]
    low, high = np.quantile(known, (0.02, 0.98)) if len(known) else (0.0, 1.0)
    return tuple(MaxNLocator(_STEPS, steps=[1, 2, 2.5, 5, 10]).tick_values(low, high))
