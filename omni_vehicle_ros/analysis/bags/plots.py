"""The figures of a survey of one bag, or of several over one another."""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from matplotlib.figure import Figure

from omni_vehicle_ros.analysis.bags.grip import grip_plots
from omni_vehicle_ros.analysis.bags.marks import BAG_COLOURS, mark_events
from omni_vehicle_ros.analysis.bags.paths import path_plots
from omni_vehicle_ros.analysis.plots import HEIGHT, WIDTH, Plot, stacked_axes
from omni_vehicle_ros.analysis.stream.survey import Survey
from omni_vehicle_ros.analysis.style import ACCENT, INK, SECOND, WHEEL_COLOURS
from omni_vehicle_ros.parameters import VehicleParameters
from omni_vehicle_ros.wheels import WHEELS

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_DASHES = ('-', (0, (4, 2)), (0, (1, 1.5)), (0, (6, 2, 1, 2)))
_SERIES_COLOURS = (INK, SECOND, ACCENT, *WHEEL_COLOURS)
_FROM_ZERO = ('load', 'friction_use')
_LATE_TOPICS = 5
_DEGREES = math.degrees(1.0)


class Row(NamedTuple):
    """Axes of a figure: what is written beside it, a factor, and trace and label of each line."""

    label: str
    factor: float
    lines: tuple[tuple[str, str], ...]


class Chart(NamedTuple):
    """A figure over time, left out where none of its traces is there."""

    name: str
    title: str
    text: str
    rows: tuple[Row, ...]


CHARTS = (
    Chart('speed', 'Speed and yaw rate', 'Of the centre of gravity, against what is commanded.', (
        Row('speed [m/s]', 1.0, (
            ('speed', 'vx'), ('speed', 'vy'), ('commanded_twist', 'vx'), ('driver_speed', 'vx'), ('teleop', 'vx'),
            ('cmd_vel', 'vx'),
        )),
        Row('yaw rate [°/s]', _DEGREES, (
            ('yaw_rate', 'yaw_rate'), ('commanded_yaw_rate', 'yaw_rate'), ('teleop_yaw_rate', 'yaw_rate'),
            ('cmd_vel_yaw_rate', 'yaw_rate'),
        )),
    )),
    Chart('body', 'Acceleration and roll', 'What an accelerometer feels; positive roll leans to the right.', (
        Row('acceleration [m/s²]', 1.0, (('acceleration', 'ax'), ('acceleration', 'ay'))),
        Row('roll [°]', _DEGREES, (('roll', 'roll'),)),
    )),
    Chart('environment', 'Environment', 'Bank and wind are positive where they push to the left.', (
        Row('bank [°]', _DEGREES, (('bank', 'x'),)),
        Row('wind [m/s]', 1.0, (('wind', 'y'),)),
    )),
)


class WheelChart(NamedTuple):
    """A figure of a signal of the four wheels, and of its command."""

    name: str
    title: str
    text: str
    label: str
    factor: float
    trace: str
    command: str = ''


WHEEL_CHARTS = (
    WheelChart(
        'steer-angles', 'Steer angles', 'Dashed: what ICR steering asks, without the trim of the side-slip controller.',
        'steer angle [°]', _DEGREES, 'steer_angle', 'steer_command',
    ),
    WheelChart(
        'side-slip', 'Side slip of the tyres', 'Positive where it makes a force to the left.', 'side slip [°]',
        _DEGREES, 'side_slip',
    ),
    WheelChart(
        'friction-use', 'Friction use', 'Force in the road plane over friction times load.', 'friction use', 1.0,
        'friction_use',
    ),
    WheelChart('loads', 'Wheel loads', 'At 0 a wheel lifts off.', 'load [kN]', 1e-3, 'load'),
    WheelChart(
        'torques', 'Drive torques', 'Dashed: what ICR steering asks.', 'torque [N m]', 1.0, 'drive_torque',
        'torque_command',
    ),
    WheelChart('wheel-speeds', 'Wheel speeds', 'Of the wheels about their axles.', 'speed [rad/s]', 1.0, 'wheel_speed'),
)


def draw_surveys(surveys: Sequence[Survey], names: Sequence[str], vehicles: Sequence[VehicleParameters]) -> list[Plot]:
    """Draw the figures of bags; several lie over one another, each in a colour of its own.

    Parameters
    ----------
    surveys, names, vehicles
        The bags, what they are called, and the vehicles in them, for the drawing from above.
    """
    plots = path_plots(surveys, names, vehicles)
    time = [_chart(chart, surveys) for chart in CHARTS] + [_wheels(chart, surveys) for chart in WHEEL_CHARTS]
    time += [*_joints(surveys), _periods(surveys), _latency(surveys)]
    for plot in time:
        if plot is not None:
            mark_events(plot.figure, surveys)
            plots.append(plot)
    return [*plots, *grip_plots(surveys)]


def _there(surveys: Sequence[Survey], trace: str) -> bool:
    return any(trace in survey.signals and survey.signals[trace].statistics.count.any() for survey in surveys)


def _draw(
    axes: 'Axes', survey: Survey, trace: str, label: str, factor: float, colour: str, style: object, words: str
) -> bool:
    """Draw one signal of a survey; return whether it is there."""
    found = survey.signals.get(trace)
    if found is None or label not in found.trace.labels or not found.statistics.count[found.trace.labels.index(label)]:
        return False
    time, values = found.envelope.line(found.trace.labels.index(label), survey.span[0])
    said = found.trace.name in ('driver_speed', 'teleop', 'cmd_vel', 'bank', 'wind', 'friction')
    if said:  # holds until the next word
        end = (survey.span[1] - survey.span[0]) * 1e-9
        time, values = np.append(time, max(end, time[-1])), np.append(values, values[-1])
    axes.plot(
        time, factor * values, color=colour, linestyle=style, label=words, linewidth=1.0,
        drawstyle='steps-post' if said else 'default',
    )
    return True


def _chart(chart: Chart, surveys: Sequence[Survey]) -> Plot | None:
    rows = [row for row in chart.rows if any(_there(surveys, trace) for trace, _ in row.lines)]
    if not rows:
        return None
    figure, grid = stacked_axes(*(row.label for row in rows))
    for axes, row in zip(grid, rows, strict=True):
        for number, survey in enumerate(surveys):
            for place, (trace, label) in enumerate(row.lines):
                colour = BAG_COLOURS[number] if len(surveys) > 1 else _SERIES_COLOURS[place]
                style = _DASHES[min(place, 3)] if len(surveys) > 1 or place > 1 else '-'
                _draw(axes, survey, trace, label, row.factor, colour, style, _words(trace, label))
        if len(surveys) == 1 and len(axes.lines) > 1:
            axes.legend(loc='lower right', bbox_to_anchor=(1.0, 1.0), ncol=3, fontsize=7.5)
    styled = chart.name == 'speed' and len(surveys) > 1
    styles = ' Solid: ahead; dashed: to the left; dotted: commanded.' if styled else ''
    return Plot(chart.name, chart.title, chart.text + styles, figure)


def _words(trace: str, label: str) -> str:
    said = {'vx': f'{trace} ahead', 'vy': f'{trace} left', 'ax': 'ahead', 'ay': 'left'}
    return said.get(label, trace).replace('_', ' ')


def _wheels(chart: WheelChart, surveys: Sequence[Survey]) -> Plot | None:
    if not _there(surveys, chart.trace):
        return None
    figure = Figure(figsize=(WIDTH, HEIGHT), layout='constrained')
    if len(surveys) == 1 and not chart.command:
        axes = figure.add_subplot()
        for i in (2, 3, 0, 1):
            _draw(axes, surveys[0], chart.trace, WHEELS[i], chart.factor, WHEEL_COLOURS[i], '-', WHEELS[i])
        axes.set_ylabel(chart.label)
        axes.set_xlabel('time [s]')
        if chart.trace in _FROM_ZERO:
            axes.set_ylim(bottom=0.0)
        return Plot(chart.name, chart.title, chart.text, figure)
    grid = figure.subplots(2, 2, sharex=True, sharey=True)
    for i, (axes, wheel) in enumerate(zip(grid.flat, WHEELS, strict=True)):
        for number, survey in enumerate(surveys):
            colour = WHEEL_COLOURS[i] if len(surveys) == 1 else BAG_COLOURS[number]
            _draw(axes, survey, chart.trace, wheel, chart.factor, colour, '-', wheel)
            shade = INK if len(surveys) == 1 else colour
            _draw(axes, survey, f'{chart.command}.{wheel}', wheel, chart.factor, shade, _DASHES[1], wheel)
        axes.set_title(wheel.replace('_', ' '), color=WHEEL_COLOURS[i] if len(surveys) == 1 else INK, fontsize=8.5)
    figure.supylabel(chart.label, fontsize=9.0, color=INK)
    for axes in grid[1]:
        axes.set_xlabel('time [s]')
    return Plot(chart.name, chart.title, chart.text, figure)


def _joints(surveys: Sequence[Survey]) -> list[Plot]:
    """Draw the joints of a vehicle that is not ours."""
    traces = [trace for trace in ('joint_position', 'joint_velocity') if _there(surveys, trace)]
    if not traces:
        return []
    labels = {'joint_position': 'position [rad]', 'joint_velocity': 'velocity [rad/s]'}
    figure, grid = stacked_axes(*(labels[trace] for trace in traces))
    for axes, trace in zip(grid, traces, strict=True):
        for number, survey in enumerate(surveys):
            names = survey.signals[trace].trace.labels if trace in survey.signals else ()
            for place, name in enumerate(names):
                colour = BAG_COLOURS[number] if len(surveys) > 1 else _SERIES_COLOURS[place % len(_SERIES_COLOURS)]
                _draw(axes, survey, trace, name, 1.0, colour, _DASHES[place // len(_SERIES_COLOURS)], name)
        if len(surveys) == 1:
            axes.legend(fontsize=7.0, ncol=2)
    return [Plot('joints', 'Joints', 'The first joints of joint_states, by their names.', figure)]


def _periods(surveys: Sequence[Survey]) -> Plot | None:
    figure, (axes,) = stacked_axes('period [ms]')
    for number, survey in enumerate(surveys):
        known = [survey.roles.topics.get(role, '') for role in ('odom', 'joint_states', 'imu')]
        for topic in [topic for topic in known if topic in survey.timing and survey.timing[topic].count > 1][:1]:
            time, period = survey.timing[topic].periods.line(0, survey.span[0])
            axes.plot(time, 1e3 * period, color=BAG_COLOURS[number], linewidth=1.0, label=topic)
    if not axes.lines:
        return None
    axes.set_ylim(bottom=0.0)
    axes.legend(loc='lower right', bbox_to_anchor=(1.0, 1.0))
    return Plot('periods', 'Period', 'From one stamp to the next.', figure)


def _latency(surveys: Sequence[Survey]) -> Plot | None:
    """Draw the latest of the topics; nothing if all are logged at their stamps."""
    figure, (axes,) = stacked_axes('latency [ms]')
    for number, survey in enumerate(surveys):
        late = [(entry.longest_latency, topic) for topic, entry in survey.timing.items() if entry.cyclic]
        for place, (longest, topic) in enumerate(sorted(late, reverse=True)[:_LATE_TOPICS]):
            if longest <= 0.0:
                continue
            time, latency = survey.timing[topic].latency.line(0, survey.span[0])
            colour = BAG_COLOURS[number] if len(surveys) > 1 else BAG_COLOURS[place]
            axes.plot(time, 1e3 * latency, color=colour, linewidth=1.0, label=topic)
    if not axes.lines:
        return None
    axes.legend(fontsize=7.0)
    return Plot('latency', 'Latency', 'Log time less stamp, of the topics with the longest.', figure)
