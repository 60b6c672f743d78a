"""Maps of the steady side slip over turn radius and speed: Fig. 4.5-4.8 (thesis sec. 4.2)."""

from typing import NamedTuple

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import BoundaryNorm
from matplotlib.figure import Figure

from omni_vehicle_ros.analysis.signals import Array
from omni_vehicle_ros.analysis.style import GRID, INK, MUTED
from omni_vehicle_ros.thesis.chart import NO_TURN, RADIUS, SIDE_SLIP, SIZE
from omni_vehicle_ros.thesis.figure import Picture, ThesisFigure
from omni_vehicle_ros.thesis.steady import SlipMap, SlipMapTask
from omni_vehicle_ros.thesis.tasks import Results, km_per_h, run
from omni_vehicle_ros.thesis.words import number, wheel_words
from omni_vehicle_ros.wheels import WHEELS

RADII = tuple((np.concatenate((np.arange(200, 500, 10), np.arange(500, 1001, 25))) / 100.0).tolist())
SPEEDS = tuple(range(2, 21, 2))
MAP = SlipMapTask(run('turning_map'), RADII, tuple(map(km_per_h, SPEEDS)), mesh=20)
"""Radii [m] and speeds [km/h] of the maps."""

FAST_SPEEDS = tuple(range(1, 61))
FAST = SlipMapTask(
    run('turning_map'), tuple((np.arange(8, 41) / 4.0).tolist()), tuple(map(km_per_h, FAST_SPEEDS)), mesh=1
)
"""The same turns at speeds beyond those of the thesis [km/h]; the mesh is the end of each."""

_LABELLED = 5  # levels
_LEVELS = (0.0, 0.1, 0.2, 0.5, 1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 20.0)  # deg


def rises_with_speed(slips: Array) -> bool:
    """Tell whether slips, shape (radii, speeds), grow with the speed at every radius for as long as there are any."""
    steps = np.diff(slips, axis=1)
    return bool(np.all(steps[np.isfinite(steps)] > 0.0))


class Turnover(NamedTuple):
    """Where slips begin to fall with the speed: the smallest radius [m], the lowest speed [m/s], and whose it is."""

    radius: float
    speed: float
    wheel: int


def turnover(found: SlipMap) -> Turnover | None:
    """Return where the slips of a map begin to fall with the speed, None if they nowhere do."""
    falls = np.diff(found.side_slip, axis=1) <= 0.0
    if not np.any(falls):
        return None
    step, wheel, _ = np.argwhere(falls.transpose(1, 2, 0))[0].tolist()
    return Turnover(float(found.radius[np.any(falls, axis=(1, 2))].min()), float(found.speed[step]), wheel)


def falls_with_radius(slips: Array) -> bool:
    """Tell whether slips, shape (radii, speeds), shrink with the radius at every speed for as long as there are any."""
    steps = np.diff(slips, axis=0)
    return bool(np.all(steps[np.isfinite(steps)] < 0.0))


def _draw(found: SlipMap, slips: Array) -> Figure:
    figure = Figure(figsize=SIZE, layout='constrained')
    axes = figure.subplots()
    speed = 3.6 * found.mesh_speed
    radius = np.broadcast_to(found.radius[:, np.newaxis], speed.shape)
    colours = colormaps['YlGnBu']
    filled = axes.contourf(radius, speed, slips, _LEVELS, cmap=colours, norm=BoundaryNorm(_LEVELS, colours.N))
    lines = axes.contour(radius, speed, slips, _LEVELS[1:], colors=INK, linewidths=0.6)
    axes.clabel(lines, _LEVELS[1:_LABELLED], fmt=lambda level: f'{level:g}°', fontsize=7.5)
    bar = figure.colorbar(filled, ax=axes, spacing='uniform', ticks=_LEVELS, format='%g', pad=0.02)
    bar.set_label('side slip [°]')
    bar.outline.set_visible(False)
    limit = 3.6 * found.top_speed
    axes.fill_between(found.radius, limit, SPEEDS[-1], facecolor=GRID, hatch='///', edgecolor=MUTED, linewidth=0.0)
    axes.plot(found.radius, limit, color=INK, linewidth=1.2)
    axes.annotate(NO_TURN, (RADII[0] + 0.1, SPEEDS[-1] - 0.4), ha='left', va='top', backgroundcolor=GRID, fontsize=8.0)
    axes.set(xlim=(RADII[0], RADII[-1]), ylim=(SPEEDS[0], SPEEDS[-1]), xlabel=RADIUS, ylabel='speed [km/h]')
    axes.grid(visible=False)
    return figure


def _table(found: SlipMap, slips: Array) -> dict[str, Array]:
    columns = {f'{speed} km/h: {SIDE_SLIP}': slips[:, i] for i, speed in enumerate(SPEEDS)}
    lost = found.top_speed < found.speed[-1]
    limit = np.where(lost, 3.6 * found.top_speed, np.nan)
    return {RADIUS: np.array(RADII), 'limit speed [km/h]': limit, **columns}


def _sentence(found: SlipMap, slips: Array) -> str:
    row, column = np.unravel_index(int(np.nanargmax(slips)), slips.shape)
    speed = 'rises with the speed at every radius' if rises_with_speed(slips) else 'does not always rise with the speed'
    radius = 'falls' if falls_with_radius(slips) else 'does not always fall'
    return (
        f'The slip {speed} and {radius} with the radius; {number(float(slips[row, column]))}° at '
        f'{number(found.radius[row])} m and {SPEEDS[column]} km/h is the largest of the table. {gap(found)}'
    )


def gap(found: SlipMap) -> str:
    """Return where slow driving leads to no stable steady turn, in words."""
    lost = found.radius[np.isnan(found.side_slip[:, -1, 0])]
    if not len(lost):
        return ''
    return (
        f'At {number(found.radius[0])} m the steady turn that slow driving leads to is lost at '
        f'{number(3.6 * found.top_speed[0])} km/h; at {SPEEDS[-1]} km/h it is lost up to {number(lost[-1])} m.'
    )


def _map(name: str, wheel: int) -> ThesisFigure:
    def draw(results: Results) -> Picture:
        found = results[MAP]
        slips = np.degrees(found.side_slip[:, :, wheel])
        figure = _draw(found, np.degrees(found.mesh_slip[:, :, wheel]))
        return Picture(figure, _sentence(found, slips), _table(found, slips))

    caption = f'Steady side slip of the {wheel_words(WHEELS[wheel])} tyre over turn radius and speed'
    return ThesisFigure(name, caption, draw, (MAP,))


FIGURES = tuple(_map(f'4.{5 + wheel}', wheel) for wheel in range(4))
