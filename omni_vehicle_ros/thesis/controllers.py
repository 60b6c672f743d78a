"""Beyond chapter 5: the controllers on the same manoeuvres, and side slip against path."""

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from matplotlib.figure import Figure

from omni_vehicle_ros.analysis.signals import Array
from omni_vehicle_ros.analysis.style import ACCENT, INK, MUTED, SECOND, WHEEL_COLOURS
from omni_vehicle_ros.thesis.bounds import TRACTION, SlipBound
from omni_vehicle_ros.thesis.figure import Picture, Section, ThesisFigure
from omni_vehicle_ros.thesis.manoeuvres import CONTROLLERS, MANOEUVRES, Judgement, Trial
from omni_vehicle_ros.thesis.tasks import Results
from omni_vehicle_ros.thesis.trade_off import RADIUS, SPEED, GainCurve
from omni_vehicle_ros.thesis.words import degrees, number, percent

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COLOURS = (MUTED, *WHEEL_COLOURS, ACCENT, INK)
_MARKERS = ('o', 's', 's', '^', 'v', 'D', 'D')
_TURN = MANOEUVRES[0]
_CURVES = (
    (GainCurve((1.0, 1.0, 0.0, 0.0)), 'exact, gains (K, K, 0, 0)'),
    (GainCurve((1.0, 0.2, 0.0, 0.0)), 'exact, gains (K, K/5, 0, 0)'),
)
_STEERING, _ALL = (SlipBound(RADIUS, SPEED, traction) for traction in TRACTION[:2])
_BOUNDS = (_STEERING, 'bound: steering alone'), (_ALL, 'bound: left/right traction')
_TRIALS = tuple(Trial(manoeuvre, controller) for manoeuvre in MANOEUVRES for controller in CONTROLLERS)
_THESIS_GAIN = 5.0
_ERROR, _SLIP = 'path radius above the commanded one', 'worst side slip'

# What a bar shows: its name with unit, and the factor from SI.
_MEASURES = (
    ('worst slip [deg]', 'worst_slip', 180.0 / np.pi),
    ('path error [m]', 'path_error', 1.0),
    ('steering effort [deg/s]', 'steering_effort', 180.0 / np.pi),
    ('friction use [1]', 'friction_use', 1.0),
)
_MORE = (('mean slip [deg]', 'mean_slip', 180.0 / np.pi), ('radius [m]', 'radius', 1.0))


class _Point(NamedTuple):
    """A point of the trade-off: whose, the largest gain if it has any, radius above the commanded [%], slip [deg]."""

    name: str
    gain: float
    error: float
    slip: float


def draw_controllers(results: Results) -> Picture:
    """Draw all measures of all controllers on all manoeuvres."""
    table = controller_table(results)
    figure = Figure(figsize=(7.6, 6.4), layout='constrained')
    # A legend of the figure would move to the edge of the saved picture, over the caption below the figure.
    page = figure.add_subfigure(figure.add_gridspec()[0])
    grid = page.subplots(len(_MEASURES), len(MANOEUVRES), sharey='row', squeeze=False)
    for column, manoeuvre in enumerate(MANOEUVRES):
        found = [results[Trial(manoeuvre, controller)] for controller in CONTROLLERS]
        grid[0, column].set_title(manoeuvre.name, loc='center')
        for row, (name, field, factor) in enumerate(_MEASURES):
            _bars(grid[row, column], [factor * getattr(judgement, field) for judgement in found])
            grid[row, 0].set_ylabel(name.replace('[deg', '[°').replace(' [', '\n['))
    handles = grid[0, 0].patches
    names = [controller.name for controller in CONTROLLERS]
    page.legend(handles, names, loc='outside lower center', ncol=4)
    return Picture(figure, _controllers_sentence(results), table)


def _bars(axes: 'Axes', heights: list[float]) -> None:
    axes.bar(range(len(heights)), heights, color=COLOURS, width=0.8)
    axes.set_xticks([])
    axes.set_axisbelow(True)
    axes.grid(visible=False, axis='x')


def controller_table(results: Results) -> dict[str, Array]:
    """Return one row a manoeuvre and controller, as columns."""
    table: dict[str, Array] = {
        'manoeuvre': np.array([trial.manoeuvre.name for trial in _TRIALS]),
        'controller': np.array([trial.controller.name for trial in _TRIALS]),
    }
    for name, field, factor in _MEASURES + _MORE:
        table[name] = np.array([factor * getattr(results[trial], field) for trial in _TRIALS])
    return table


def _controllers_sentence(results: Results) -> str:
    turn = {controller.name: results[Trial(_TURN, controller)] for controller in CONTROLLERS}
    best = min(turn, key=lambda name: turn[name].worst_slip + abs(turn[name].radius - RADIUS))
    none = turn['none']
    return (
        f'In the turn of {number(RADIUS)} m, without control the worst slip is {degrees(none.worst_slip)} on a radius '
        f'of {number(none.radius)} m; the least slip close to the path has {best}: '
        f'{degrees(turn[best].worst_slip)} on {number(turn[best].radius)} m.'
    )


def draw_trade_off(results: Results) -> Picture:
    """Draw the worst slip over the error of the path radius, of gains and of controllers, with the bounds."""
    rows = _trade_off_rows(results)
    figure = Figure(figsize=(7.0, 4.6), layout='constrained')
    axes = figure.add_subplot()
    for (_, name), colour in zip(_CURVES, WHEEL_COLOURS, strict=False):
        _draw_curve(axes, [row for row in rows if row.name == name], colour)
    for _, name in _BOUNDS:
        _draw_bound(axes, next(row for row in rows if row.name == name))
    for controller, colour, marker in zip(CONTROLLERS, COLOURS, _MARKERS, strict=True):
        row = next(row for row in rows if row.name == controller.name)
        axes.plot(row.error, row.slip, marker, color=colour, label=row.name, markeredgecolor=INK, markeredgewidth=0.5)
    axes.axvline(0.0, color=MUTED, linewidth=0.7)
    axes.set(xlabel=f'{_ERROR} [%]', ylabel=f'{_SLIP} [°]')
    axes.set_ylim(bottom=0.0)
    axes.legend(loc='center left', bbox_to_anchor=(1.0, 0.5))
    return Picture(figure, _trade_off_sentence(results), _trade_off_table(rows))


def _draw_curve(axes: 'Axes', rows: list[_Point], colour: str) -> None:
    axes.plot([row.error for row in rows], [row.slip for row in rows], color=colour, label=rows[0].name)
    thesis = next(row for row in rows if row.gain == _THESIS_GAIN)
    place = thesis.error, thesis.slip
    axes.plot(*place, 'o', color=colour, markersize=7.0)
    words = f'thesis, K = {number(_THESIS_GAIN)}'
    axes.annotate(words, place, (6.0, 5.0), textcoords='offset points', fontsize=8.0, color=colour)


def _draw_bound(axes: 'Axes', row: _Point) -> None:
    axes.axhline(row.slip, color=SECOND, linewidth=0.9, linestyle=(0, (4, 2)))
    axes.annotate(
        row.name,
        (1.0, row.slip),
        (-3.0, 3.0),
        xycoords=axes.get_yaxis_transform(),
        textcoords='offset points',
        ha='right',
        fontsize=8.0,
        color=SECOND,
    )


def _trade_off_rows(results: Results) -> list[_Point]:
    """Return all points that are drawn: of the curves, of the bounds, which lie on the path, and of the controllers."""
    curves = [
        _Point(name, gain, 100.0 * error, math.degrees(slip))
        for curve, name in _CURVES
        for gain, error, slip in results[curve].tolist()
    ]
    bounds = [_Point(name, math.nan, 0.0, math.degrees(results[task].worst)) for task, name in _BOUNDS]
    turns = [(controller.name, results[Trial(_TURN, controller)]) for controller in CONTROLLERS]
    points = [
        _Point(name, math.nan, 100.0 * (found.radius / RADIUS - 1.0), math.degrees(found.worst_slip))
        for name, found in turns
    ]
    return [*curves, *bounds, *points]


def _trade_off_table(rows: list[_Point]) -> dict[str, Array]:
    names, *columns = map(np.array, zip(*rows, strict=True))
    heads = ('largest gain K [1]', f'{_ERROR} [%]', f'{_SLIP} [deg]')
    return {'what': names, **dict(zip(heads, columns, strict=True))}


def _trade_off_sentence(results: Results) -> str:
    steering, every = (results[Trial(_TURN, controller)] for controller in CONTROLLERS[-2:])
    parts = []
    for curve, name in _CURVES:
        gain, error, slip = results[curve].T
        five = int(np.flatnonzero(gain == _THESIS_GAIN)[0])
        off = percent(error[five])
        gains = f'{name.removeprefix("exact, ")} with K = {number(_THESIS_GAIN)}'
        parts.append(f'{gains}: {degrees(slip[five])}, {off} off the radius')
    return (
        f'The gains of the thesis trade path for slip: {"; ".join(parts)}. The least worst slip on the path is '
        f'{degrees(results[_STEERING].worst)} by steering alone and {degrees(results[_ALL].worst)} with left/right '
        f'traction; allocation reaches {degrees(steering.worst_slip)} and {degrees(every.worst_slip)}, '
        f'{_off(steering)} and {_off(every)} off the radius.'
    )


def _off(judgement: Judgement) -> str:
    return percent(round(judgement.radius / RADIUS - 1.0, 4))


SECTION = Section(
    '5', 'beyond', 'Beyond the thesis: controllers compared',
    (
        ThesisFigure('controllers', 'The controllers on the same manoeuvres', draw_controllers, _TRIALS),
        ThesisFigure(
            'trade_off', 'Side slip against path: gains of the thesis, controllers and bounds', draw_trade_off,
            (*(curve for curve, _ in _CURVES), _STEERING, _ALL, *_TRIALS[: len(CONTROLLERS)]),
        ),
    ),
)
