"""The picture of a turn map: how much tyres slip in the steady turns of slow driving, and how disturbances decay.

Where slow driving leads to none, it shows whether another stable one lies on the curves that slow driving begins (see
`omni_vehicle_ros.model.other_turns`).
"""

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.colors import BoundaryNorm
from matplotlib.figure import Figure
from matplotlib.patheffects import AbstractPathEffect, withStroke

from omni_vehicle_ros.analysis.signals import Array
from omni_vehicle_ros.analysis.style import INK, MUTED, PAPER, house_style
from omni_vehicle_ros.analysis.turn_map import Column, TurnMap, field, worst_slip
from omni_vehicle_ros.model.turning import SteadyTurn

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.path import Path as MplPath

_LEVELS = 241
_SLIPS = (0.0, 0.5, 1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 10.0, 15.0, 20.0, 30.0)
_RATES = (0.0, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0)
_WIDER = (1.05, 1.1, 1.25, 1.5, 2.0, 3.0, 5.0)
_DAMPING = (0.5, 0.7, 0.9)
_NOTHING, _OTHER = '#eceff2', '#c9b8dd'
_DASHES, _DOTS, _BOTH, _LONG = (0, (5, 2)), (0, (1, 1.2)), (0, (5, 1.5, 1, 1.5)), (0, (8, 1.5))
_LIMITS: dict[str, Any] = {
    'fold': '-', 'skid': (0, (4, 1)), 'lift': (0, (1, 1)), 'divergence': (0, (6, 1, 1, 1)),
    'oscillation': (0, (2, 2)),
}  # fmt: skip
_THIN, _EDGE = 0.6, 0.8  # points
_CROWDED = 0.95  # of the speed of a fold, past which lines say nothing
_KMH = 3.6

Mesh = tuple[Array, Array, Array]  # radii, shape (n,), speeds, (m,), and values, (m, n)


def write_picture(found: TurnMap, path: Path) -> None:
    """Draw a turn map into a picture file; the suffix says of what kind."""
    with house_style():
        draw_map(found).savefig(path, dpi=160.0, facecolor=PAPER, bbox_inches='tight', pad_inches=0.1)


def draw_map(found: TurnMap) -> Figure:
    """Draw the worst slip, and beside it the decay rate, over radius and speed, with the limits on both."""
    figure = Figure(figsize=(12.0, 5.8), layout='constrained')
    left, right = figure.subplots(1, 2, sharex=True, sharey=True)
    title = f'Steady turns at constant speed: {found.request.title}'
    figure.suptitle(title, x=0.01, ha='left', fontsize=11.0, color=INK)
    _draw_slip(left, found)
    _draw_decay(right, found)
    for axes in (left, right):
        _draw_limits(axes, found)
        axes.set_xlabel('radius of the commanded turn [m]')
        axes.set_xlim(found.columns[0].radius, found.columns[-1].radius)
        axes.set_ylim(found.request.speeds[0], found.request.speeds[-1])
        axes.grid(False)
    left.set_ylabel('forward speed [m/s]')
    kmh = right.secondary_yaxis('right', functions=(lambda speed: speed * _KMH, lambda speed: speed / _KMH))
    kmh.set_ylabel('[km/h]')
    figure.legend(*left.get_legend_handles_labels(), loc='outside lower center', ncol=3)
    return figure


def _draw_slip(axes: 'Axes', found: TurnMap) -> None:
    slip = _mesh(found, lambda turn: math.degrees(worst_slip(turn)))
    _fill(axes, slip, _SLIPS, 'YlOrRd', 'worst side slip [°]')
    radii, speeds, path = _mesh(found, lambda turn: abs(turn.path_radius))
    _lines(axes, found, (radii, speeds, path / radii), _WIDER, '{:g} R')
    _draw(axes, found, [column.nonlinear for column in found.columns], _DOTS, 'a tyre leaves its linear region')
    _draw(axes, found, [column.sliding for column in found.columns], _BOTH, 'a tyre slides')
    _draw(axes, found, [column.limit.slide_speed for column in found.columns], _LONG, 'both tyres of an axle slide')
    axes.set_title('Worst side slip of the four tyres; thin lines: radius of the path')


def _draw_decay(axes: 'Axes', found: TurnMap) -> None:
    _fill(axes, _mesh(found, lambda turn: turn.decay_rate), _RATES, 'viridis', 'decay rate [1/s]')
    _lines(axes, found, _mesh(found, lambda turn: turn.damping_ratio or 0.0), _DAMPING, 'ζ {:g}')
    axes.set_title('Decay rate of a small disturbance; thin lines: damping ratio')


def _draw_limits(axes: 'Axes', found: TurnMap) -> None:
    radii, ends = [column.radius for column in found.columns], [column.end for column in found.columns]
    lifts = any(column.limit.cause == 'lift' for column in found.columns)
    lost = 'no stable steady turn on the curves that slow driving begins'
    band = axes.fill_between(
        radii, ends, found.request.speeds[-1],
        facecolor=_NOTHING, edgecolor=MUTED, hatch='////', linewidth=0.0, zorder=3,
        label=f'{lost}, or a wheel in the air' if lifts else lost,
    )  # fmt: skip
    _draw_others(axes, found, band.get_paths()[0])
    _draw(axes, found, [column.limit.grip_speed for column in found.columns], _DASHES, 'largest lateral acceleration')
    for cause in dict.fromkeys(column.limit.cause for column in found.columns if column.limit.cause):
        speeds = [column.limit.speed if column.limit.cause == cause else None for column in found.columns]
        _draw(axes, found, speeds, _LIMITS[cause], f'limit speed: {cause}', 2.4)


def _draw_others(axes: 'Axes', found: TurnMap, where: 'MplPath') -> None:
    """Colour the part of a path in which there is another stable turn."""
    if not any(turn and turn.stable for column in found.columns for turn in column.others):
        return
    there = np.array([_continued_down(column) for column in found.columns]).T
    radii = [column.radius for column in found.columns]
    filled = axes.contourf(radii, found.request.speeds, there, levels=(0.5, 1.5), colors=_OTHER, zorder=3.5)
    filled.set_clip_path(where, axes.transData)
    axes.fill([], [], facecolor=_OTHER, label='a stable one, but not the one that slow driving leads to')


def _continued_down(column: Column) -> list[float]:
    """Return 1 where there is another stable turn; where slow driving leads to one, what holds just above."""
    flags = [float(turn is not None and turn.stable) for turn in column.others]
    slow = sum(turn is not None for turn in column.turns)
    return [flags[slow] if slow < len(flags) else 1.0] * slow + flags[slow:]


def _draw(
    axes: 'Axes', found: TurnMap, speeds: Sequence[float | None], style: Any, label: str, width: float = 1.3
) -> None:
    known = [math.nan if speed is None else speed for speed in speeds]
    if all(map(math.isnan, known)):
        return
    radii = [column.radius for column in found.columns]
    (drawn,) = axes.plot(radii, known, color=INK, linestyle=style, linewidth=width, label=label, zorder=4)
    drawn.set_path_effects(_halo(width + _EDGE))
    there = np.isfinite([math.nan, *known, math.nan])
    alone = np.flatnonzero(there[1:-1] & ~there[:-2] & ~there[2:])
    if alone.size:  # a line needs two points
        drawn.set(marker='D', markersize=2.0 * width, markevery=alone.tolist())


def _halo(width: float) -> list[AbstractPathEffect]:
    """Return an edge of paper round what may lie on a dark colour."""
    return [withStroke(linewidth=width, foreground=PAPER)]


def _mesh(found: TurnMap, quantity: Callable[[SteadyTurn], float]) -> Mesh:
    speeds = np.linspace(found.request.speeds[0], found.request.speeds[-1], _LEVELS)
    return np.array([column.radius for column in found.columns]), speeds, field(found, quantity, speeds)


def _fill(axes: 'Axes', mesh: Mesh, levels: tuple[float, ...], colours: str, label: str) -> None:
    shades = BoundaryNorm(levels, 256, extend='both')
    filled = axes.contourf(*mesh, levels=levels, cmap=colours, norm=shades, extend='both')
    axes.figure.colorbar(filled, ax=axes, label=label, ticks=levels, pad=0.02, format='%g')


def _lines(axes: 'Axes', found: TurnMap, mesh: Mesh, levels: tuple[float, ...], words: str) -> None:
    radii, speeds, values = mesh
    ends = (column.end if column.end >= found.request.speeds[-1] else _CROWDED * column.end for column in found.columns)
    there = speeds[:, np.newaxis] <= list(ends)
    lines = axes.contour(radii, speeds, np.where(there, values, math.nan), levels=levels, colors=INK, linewidths=_THIN)
    lines.set_path_effects(_halo(_THIN + _EDGE))
    for text in axes.clabel(lines, fmt=words.format, fontsize=7.5):
        text.set_path_effects(_halo(2.0))
