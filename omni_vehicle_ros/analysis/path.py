"""The path seen from above, with the vehicle and its wheels drawn along it."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from matplotlib.patches import FancyBboxPatch, Polygon, Rectangle
from matplotlib.transforms import Affine2D, Transform

from omni_vehicle_ros.analysis.signals import Array
from omni_vehicle_ros.analysis.style import ACCENT, INK, MUTED, WHEEL_COLOURS
from omni_vehicle_ros.analysis.topics import Topics, truth
from omni_vehicle_ros.parameters import VehicleParameters

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_OVERHANG = 0.6
_WHEEL_WIDTH = 0.36
_BODY = '#eef2f6'
_GAP = 1.25
_MOST = 18
_FARTHEST_ICR = 20.0
_TIME_ROOM = 22.0  # pt, what a time takes beside the path


class _Sight(NamedTuple):
    """The vehicle at one time: pose [m, m, rad], twist [m/s, m/s, rad/s] and steer angles [rad], if known."""

    time: float
    x: float
    y: float
    heading: float
    vx: float
    vy: float
    yaw_rate: float
    steer_angles: tuple[float, ...]


def plot_path(bag: Topics, axes: 'Axes', vehicle: VehicleParameters | None = None) -> None:
    """Draw the path of the centre of gravity from above, and the vehicle and its steered wheels along it.

    In the middle of its turns thin lines join the wheels with its instantaneous centre of rotation.

    Parameters
    ----------
    bag
        A bag with odom; without joint_states the wheels are left out.
    axes
        Where to draw; its aspect becomes equal [m].
    vehicle
        Its dimensions; the thesis's if not given.
    """
    vehicle = vehicle or VehicleParameters()
    odom = truth(bag, 'odom')
    axes.plot(odom.x, odom.y, color=INK, linewidth=1.0, zorder=2)
    sights = [_sight(bag, index) for index in snapshots(odom.x, odom.y, vehicle)]
    turning = [sight for sight in sights if sight.steer_angles and _icr_distance(sight) < _FARTHEST_ICR]
    if turning:
        _draw_icr(axes, turning[len(turning) // 2], vehicle)
    for sight in sights:
        _draw_vehicle(axes, sight, vehicle)
        _write_time(axes, sight, vehicle)
    _fit(axes)
    axes.set_aspect('equal', adjustable='box')
    axes.set_xlabel('x [m]')
    axes.set_ylabel('y [m]')


def _fit(axes: 'Axes') -> None:
    """Set the limits so that x and y have one scale, and all that is drawn lies within them, the times included."""
    shown, size = axes.dataLim, np.array(axes.get_window_extent().size) * 72.0 / axes.figure.dpi
    scale = np.max(shown.size / (size - 2.0 * _TIME_ROOM))  # m/pt
    middle = 0.5 * np.add(shown.min, shown.max)
    low, high = middle - 0.5 * scale * size, middle + 0.5 * scale * size
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))


def snapshots(x: Array, y: Array, vehicle: VehicleParameters) -> list[int]:
    """Return the samples at which to draw the vehicle: the first, the last, and some in between.

    They lie more than a vehicle's length apart, so that no drawing hides another; there are 20 at most.
    """
    moved = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(x), np.diff(y)))])
    gap = max(_GAP * (vehicle.wheelbase + 2 * _OVERHANG), moved[-1] / _MOST)
    chosen = [0]
    for index in range(1, len(x)):
        if moved[index] - moved[chosen[-1]] >= gap:
            chosen.append(index)
    last = len(x) - 1
    clear = [index for index in chosen if np.hypot(x[index] - x[last], y[index] - y[last]) > 0.8 * gap]
    return [*_first_at_each_place(clear, x, y, 0.8 * gap), last]


def _first_at_each_place(chosen: list[int], x: Array, y: Array, gap: float) -> list[int]:
    """Leave out where the vehicle comes by again."""
    kept: list[int] = []
    for index in chosen:
        if all(np.hypot(x[index] - x[other], y[index] - y[other]) > gap for other in kept):
            kept.append(index)
    return kept


def _sight(bag: Topics, index: int) -> _Sight:
    odom = truth(bag, 'odom')
    return _Sight(
        float(odom.stamp[index]), float(odom.x[index]), float(odom.y[index]), float(odom.heading[index]),
        float(odom.vx[index]), float(odom.vy[index]), float(odom.yaw_rate[index]),
        _steer_angles(bag, float(odom.stamp[index])) if 'joint_states' in bag else (),
    )


def _steer_angles(bag: Topics, time: float) -> tuple[float, ...]:
    joints = truth(bag, 'joint_states')
    row = min(int(np.searchsorted(joints.stamp, time - 1e-9)), len(joints.stamp) - 1)
    return tuple(joints.position[row, :4].tolist())


def _icr_distance(sight: _Sight) -> float:
    speed = float(np.hypot(sight.vx, sight.vy))
    return speed / abs(sight.yaw_rate) if abs(sight.yaw_rate) > 1e-3 and speed > 0.2 else np.inf


def _draw_icr(axes: 'Axes', sight: _Sight, vehicle: VehicleParameters) -> None:
    frame = Affine2D().rotate(sight.heading).translate(sight.x, sight.y)
    icr = frame.transform((-sight.vy / sight.yaw_rate, sight.vx / sight.yaw_rate))
    for x, y in zip(vehicle.wheel_x, vehicle.wheel_y, strict=True):
        wheel = frame.transform((x, y))
        axes.plot(*zip(wheel, icr, strict=True), color=ACCENT, linewidth=0.7, linestyle=(0, (4, 3)), zorder=1)
    axes.plot(*icr, marker='o', markersize=4, color=ACCENT, zorder=3)
    away = icr - np.array((sight.x, sight.y))
    offset = 14.0 * away / np.hypot(*away)
    axes.annotate(
        'ICR', tuple(icr), tuple(offset), textcoords='offset points', ha='center', va='center', color=ACCENT, zorder=3
    )


def _write_time(axes: 'Axes', sight: _Sight, vehicle: VehicleParameters) -> None:
    frame = Affine2D().rotate(sight.heading).translate(sight.x, sight.y)
    beside = 0.5 * max(vehicle.front_track, vehicle.rear_track) + 0.35
    outside = -1.0 if sight.yaw_rate >= 0.0 else 1.0
    direction = Affine2D().rotate(sight.heading).transform((0.0, outside))
    axes.annotate(
        f'{sight.time:.0f} s', tuple(frame.transform((0.0, outside * beside))), tuple(9.0 * direction),
        textcoords='offset points', ha='center', va='center', color=MUTED, fontsize=8.0, zorder=3,
    )


def _draw_vehicle(axes: 'Axes', sight: _Sight, vehicle: VehicleParameters) -> None:
    frame = Affine2D().rotate(sight.heading).translate(sight.x, sight.y) + axes.transData
    front, rear = vehicle.cg_to_front_axle, -vehicle.cg_to_rear_axle
    width = max(vehicle.front_track, vehicle.rear_track)
    corner, length = (rear - _OVERHANG, -0.5 * width), front - rear + 2 * _OVERHANG
    body = FancyBboxPatch(
        corner, length, width, boxstyle='round,pad=0.0,rounding_size=0.4', transform=frame,
        facecolor=_BODY, edgecolor=MUTED, linewidth=0.8, alpha=0.85, zorder=4,
    )
    axes.add_patch(body)
    nose = front + _OVERHANG
    low, high = nose - 1.25, nose - 0.75
    screen = [(high, -0.4 * width), (high, 0.4 * width), (low, 0.33 * width), (low, -0.33 * width)]
    axes.add_patch(Polygon(screen, transform=frame, facecolor='#cbd2d9', edgecolor='none', zorder=5))
    if sight.steer_angles:
        _draw_wheels(axes, sight, vehicle, frame)


def _draw_wheels(axes: 'Axes', sight: _Sight, vehicle: VehicleParameters, frame: Transform) -> None:
    radius = vehicle.wheel_radius
    for x, y, angle, colour in zip(vehicle.wheel_x, vehicle.wheel_y, sight.steer_angles, WHEEL_COLOURS, strict=True):
        place = Affine2D().rotate(angle).translate(x, y) + frame
        corner = (-radius, -0.5 * _WHEEL_WIDTH)
        axes.add_patch(Rectangle(corner, 2 * radius, _WHEEL_WIDTH, transform=place, facecolor=colour, zorder=6))
