"""The figures of a report: what each signal did over time, and the path from above."""

from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from matplotlib.figure import Figure

from omni_vehicle_ros.analysis.path import plot_path
from omni_vehicle_ros.analysis.regions import regions, spans
from omni_vehicle_ros.analysis.signals import Array
from omni_vehicle_ros.analysis.sound import LARGEST
from omni_vehicle_ros.analysis.style import ACCENT, INK, MUTED, REGION_COLOURS, SECOND, WHEEL_COLOURS, line
from omni_vehicle_ros.analysis.topics import friction, has, truth
from omni_vehicle_ros.bags import Bag
from omni_vehicle_ros.model.tyres.region import Region
from omni_vehicle_ros.scenarios import Scenario
from omni_vehicle_ros.wheels import WHEELS, steer_joint

if TYPE_CHECKING:
    from matplotlib.axes import Axes

WIDTH = 5.6
HEIGHT = 3.7
LABELS = 1.2  # in, beside a path
_SMALLEST_RANGE = 0.4
_COMMAND = (0, (4, 2))
_AFTER_SLIP = 3


class Plot(NamedTuple):
    """A figure with its title and a sentence about what it shows."""

    name: str
    title: str
    text: str
    figure: Figure


def draw_plots(bag: Bag, scenario: Scenario) -> list[Plot]:
    """Draw all figures of a run: first the path from above, then the signals over time.

    Raises
    ------
    BagError
        A topic that the plant publishes is missing.
    """
    plots = [_path(bag, scenario)]
    for draw in (_speed, _side_slip, _steer_angles, _friction_use, _loads, _forces, _body):
        plots.append(draw(bag))
    plots.insert(_AFTER_SLIP, _regions(bag, scenario))
    if any(has(bag, topic) and len(read(bag)[0]) for topic, _, read in _ENVIRONMENT):
        plots.append(_environment(bag))
    for plot in plots[1:]:
        _tidy(plot.figure, [command.at for command in scenario.commands if command.at > 0.0])
    return plots


def _path(bag: Bag, scenario: Scenario) -> Plot:
    x, y = truth(bag, 'odom').x, truth(bag, 'odom').y
    margin = 2 * scenario.vehicle.wheelbase
    height = 7.6 * (np.ptp(y) + margin) / (np.ptp(x) + margin) + LABELS
    figure = Figure(figsize=(7.6, float(np.clip(height, 2.4, 8.0))))
    axes = figure.add_subplot()
    plot_path(bag, axes, scenario.vehicle)
    text = 'The vehicle, its steered wheels, and its centre of rotation (ICR) in the middle of its turns.'
    return Plot('path', 'Path from above', text, figure)


def stacked_axes(*labels: str) -> tuple[Figure, list['Axes']]:
    """Return a figure with axes over one time, one below the other, by the labels of their values."""
    figure = Figure(figsize=(WIDTH, HEIGHT), layout='constrained')
    grid = figure.subplots(len(labels), 1, sharex=True, squeeze=False)
    rows = [row[0] for row in grid]
    for axes, label in zip(rows, labels, strict=True):
        axes.set_ylabel(label)
    rows[-1].set_xlabel('time [s]')
    figure.align_ylabels(rows)
    return figure, rows


def _each_wheel(axes: 'Axes', time: Array, signals: Array) -> None:
    """Draw a signal of the four wheels, shape (n, 4); rear below front."""
    for i in (2, 3, 0, 1):
        line(axes, time, signals[:, i], WHEEL_COLOURS[i])
    axes.set_xlim(time[0], time[-1])


def _tidy(figure: Figure, times: list[float]) -> None:
    """Mark the times of the commands, and show what is next to nothing as nothing."""
    for axes in figure.axes:
        low, high = axes.get_ylim()
        if high - low < _SMALLEST_RANGE:
            middle = 0.5 * (low + high)
            axes.set_ylim(middle - 0.5 * _SMALLEST_RANGE, middle + 0.5 * _SMALLEST_RANGE)
        for time in times:
            axes.axvline(time, color=MUTED, linewidth=0.6, linestyle=(0, (1, 2)), zorder=0)


def _speed(bag: Bag) -> Plot:
    odom = truth(bag, 'odom')
    figure, (speed, yaw) = stacked_axes('speed [m/s]', 'yaw rate [°/s]')
    line(speed, odom.stamp, odom.vx, INK, 'forward')
    line(speed, odom.stamp, odom.vy, SECOND, 'lateral')
    if has(bag, 'driver/speed'):
        said = bag['driver/speed']
        asked = _possible(said.stamp, said.vx)
        speed.step(*asked, where='post', color=ACCENT, linestyle=_COMMAND, linewidth=1.0, label='driver')
    line(yaw, odom.stamp, np.degrees(odom.yaw_rate), INK)
    speed.set_xlim(odom.stamp[0], odom.stamp[-1])
    speed.legend(loc='lower right', bbox_to_anchor=(1.0, 1.0), ncol=3)
    return Plot('speed', 'Speed and yaw rate', 'Of the centre of gravity, in the frame of the vehicle.', figure)


def _side_slip(bag: Bag) -> Plot:
    slip = truth(bag, 'tyres/side_slip')
    figure, (axes,) = stacked_axes('side slip [°]')
    _each_wheel(axes, slip.stamp, np.degrees(slip.position))
    return Plot('side-slip', 'Side slip of the tyres', 'Positive where it makes a force to the left.', figure)


def _regions(bag: Bag, scenario: Scenario) -> Plot:
    """Draw a strip for each wheel, in the colour of the region that its tyre works in."""
    found = regions(bag, scenario.vehicle)
    figure, (axes,) = stacked_axes('')
    for region, colour in zip(Region, REGION_COLOURS, strict=True):
        for i in range(4):
            stretches = [(begin, end - begin) for begin, end in spans(found, i, region)]
            axes.broken_barh(stretches, (3 - i - 0.36, 0.72), color=colour, linewidth=0.0)
        axes.barh(-1.0, 0.0, color=colour, label=region.name.lower())
    axes.set_yticks(range(4), [wheel.replace('_', ' ') for wheel in reversed(WHEELS)])
    axes.set_ylim(-0.6, 3.6)
    axes.set_xlim(found.stamp[0], found.stamp[-1])
    axes.grid(False)
    axes.legend(loc='lower right', bbox_to_anchor=(1.0, 1.0), ncol=3)
    text = 'Sliding: more side slip makes no more side force.'
    return Plot('regions', 'Regions of the tyres', text, figure)


def _steer_angles(bag: Bag) -> Plot:
    joints = truth(bag, 'joint_states')
    figure = Figure(figsize=(WIDTH, HEIGHT), layout='constrained')
    grid = figure.subplots(2, 2, sharex=True, sharey=True)
    for i, (axes, wheel) in enumerate(zip(grid.flat, WHEELS, strict=True)):
        line(axes, joints.stamp, np.degrees(joints.position[:, i]), WHEEL_COLOURS[i])
        if has(bag, f'{wheel}/command') and steer_joint(wheel) in bag[f'{wheel}/command'].names:
            command = bag[f'{wheel}/command']
            asked = np.degrees(command.position[:, command.names.index(steer_joint(wheel))])
            line(axes, *_possible(command.stamp, asked), INK, linestyle=_COMMAND, linewidth=0.9)
        axes.set_title(wheel.replace('_', ' '), color=WHEEL_COLOURS[i], fontsize=8.5)
    grid[0, 0].set_xlim(joints.stamp[0], joints.stamp[-1])
    figure.supylabel('steer angle [°]', fontsize=9.0, color=INK)
    for axes in grid[1]:
        axes.set_xlabel('time [s]')
    text = 'Colour: what the wheel does. Dashed: what ICR steering asks, without the trim of the side-slip controller.'
    return Plot('steer-angles', 'Steer angles', text, figure)


def _friction_use(bag: Bag) -> Plot:
    slip = truth(bag, 'tyres/side_slip')
    figure, (axes,) = stacked_axes('friction use')
    _each_wheel(axes, slip.stamp, slip.effort)
    axes.axhline(1.0, color=MUTED, linewidth=0.8)
    axes.set_ylim(0.0, 1.08)
    text = 'Force in the road plane over friction times load; at 1 the tyre has no more to give.'
    return Plot('friction-use', 'Friction use', text, figure)


def _loads(bag: Bag) -> Plot:
    force = bag['tyres/force']
    figure, (axes,) = stacked_axes('load [kN]')
    _each_wheel(axes, force.stamp, force.forces[:, :, 2] / 1e3)
    axes.set_ylim(bottom=0.0)
    return Plot('loads', 'Wheel loads', 'At 0 a wheel lifts off.', figure)


def _forces(bag: Bag) -> Plot:
    force = bag['tyres/force']
    figure, (lateral, traction) = stacked_axes('lateral [kN]', 'traction [kN]')
    _each_wheel(lateral, force.stamp, force.forces[:, :, 1] / 1e3)
    _each_wheel(traction, force.stamp, force.forces[:, :, 0] / 1e3)
    return Plot('forces', 'Tyre forces', 'In the frame of each wheel: to the left, and along it.', figure)


def _body(bag: Bag) -> Plot:
    imu = truth(bag, 'imu')
    figure, (acceleration, roll) = stacked_axes('acceleration [m/s²]', 'roll [°]')
    line(acceleration, imu.stamp, imu.ax, ACCENT, 'forward')
    line(acceleration, imu.stamp, imu.ay, INK, 'lateral')
    acceleration.legend(loc='lower right', bbox_to_anchor=(1.0, 1.0), ncol=2)
    line(roll, imu.stamp, np.degrees(imu.roll), INK)
    acceleration.set_xlim(imu.stamp[0], imu.stamp[-1])
    text = 'What an accelerometer in the plane of the road feels; positive roll leans to the right.'
    return Plot('body', 'Acceleration and roll', text, figure)


def _bank(bag: Bag) -> tuple[Array, Array]:
    return _possible(bag['environment/bank'].stamp, np.degrees(bag['environment/bank'].x))


def _wind(bag: Bag) -> tuple[Array, Array]:
    return _possible(bag['environment/wind'].stamp, bag['environment/wind'].y)


def _possible(time: Array, signal: Array) -> tuple[Array, Array]:
    """Return what can have acted: anyone may say anything, and the plant takes no notice of what it can't follow."""
    possible = np.abs(signal) <= LARGEST
    return time[possible], signal[possible]


_ENVIRONMENT: tuple[tuple[str, str, Callable[[Bag], tuple[Array, Array]]], ...] = (
    ('environment/bank', 'bank [°]', _bank),
    ('environment/wind', 'wind [m/s]', _wind),
    ('environment/friction', 'friction', friction),
)


def _environment(bag: Bag) -> Plot:
    end = truth(bag, 'odom').stamp[-1]
    said = [(label, *read(bag)) for topic, label, read in _ENVIRONMENT if has(bag, topic)]
    there = [row for row in said if len(row[1])]
    figure, grid = stacked_axes(*(label for label, _, _ in there))
    for axes, (_, time, signal) in zip(grid, there, strict=True):
        colours = WHEEL_COLOURS if signal.ndim > 1 else (INK,)
        for column, colour in zip(np.atleast_2d(signal.T), colours, strict=True):
            axes.step(np.append(time, end), np.append(column, column[-1]), where='post', color=colour)
        low, high = min(0.0, float(np.min(signal))), max(0.0, float(np.max(signal)))
        room = 0.15 * (high - low) or 1.0
        axes.set_ylim(low - room if low < 0.0 or high == 0.0 else 0.0, high + room)
    grid[0].set_xlim(0.0, end)
    return Plot('environment', 'Environment', 'Bank and wind are positive where they push to the left.', figure)
