"""The path seen from above, with the vehicle and its wheels drawn along it."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from matplotlib.patches import FancyBboxPatch, Polygon, Rectangle
from matplotlib.transforms import Affine2D

from omni_vehicle_ros.analysis.signals import Array
from omni_vehicle_ros.analysis.style import ACCENT, INK, MUTED, WHEEL_COLOURS
from omni_vehicle_ros.bags import Bag
from omni_vehicle_ros.parameters import VehicleParameters

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_OVERHANG = 0.6
_WHEEL_WIDTH = 0.26
_BODY = '#eef2f6'
_GAP = 1.25
_MOST = 18
_TURN = np.radians(60.0)
_FARTHEST_ICR = 20.0


class _Sight(NamedTuple):
    """The vehicle at one time: pose [m, m, rad], twist [m/s, m/s, rad/s] and steer angles [rad]."""

    time: float
    x: float
    y: float
    heading: float
    vx: float
    vy: float
    yaw_rate: float
    steer_angles: tuple[float, ...]


def plot_path(bag: Bag, axes: 'Axes', vehicle: VehicleParameters | None = None) -> None:
    """Draw the path of the centre of gravity from above, and the vehicle and its steered wheels along it.

    Where it turns most, thin lines join the wheels with its instantaneous centre of rotation.

    Parameters
    ----------
    bag
        A bag with odom and joint_states.
    axes
        Where to draw; its aspect becomes equal [m].
    vehicle
        Its dimensions; the thesis's if not given.
    """
    vehicle = vehicle or VehicleParameters()
    odom = bag['odom']
    axes.plot(odom.x[::5], odom.y[::5], color=INK, linewidth=1.0, zorder=2)
    sights = [_sight(bag, index) for index in snapshots(odom.x, odom.y, odom.heading, vehicle)]
    turning = [sight for sight in sights if _icr_distance(sight) < _FARTHEST_ICR]
    if turning:
        _draw_icr(axes, min(turning, key=_icr_distance), vehicle)
    for sight in sights:
        _draw_vehicle(axes, sight, vehicle)
    for sight, text in ((sights[0], 'start'), (sights[-1], f'{sights[-1].time:.0f} s')):
        axes.annotate(
            text, (sight.x, sight.y), (0, -22), textcoords='offset points', ha='center', va='top', color=INK, zorder=9
        )
    axes.set_aspect('equal', adjustable='datalim')
    axes.margins(0.04)
    axes.set_xlabel('x [m]')
    axes.set_ylabel('y [m]')


def snapshots(x: Array, y: Array, heading: Array, vehicle: VehicleParameters) -> list[int]:
    """Return the samples at which to draw the vehicle: the first, the last, and some in between.

    They lie more than a vehicle's length apart, or a part of a turn on the spot; about 18 at most.
    """
    moved = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(x), np.diff(y)))])
    turned = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(np.unwrap(heading))))])
    gap = max(_GAP * (vehicle.wheelbase + 2 * _OVERHANG), moved[-1] / _MOST)
    chosen = [0]
    for index in range(1, len(x)):
        far = moved[index] - moved[chosen[-1]]
        if far >= gap or (far < 0.1 * gap and turned[index] - turned[chosen[-1]] >= _TURN):
            chosen.append(index)
    last = len(x) - 1
    if len(chosen) > 1 and moved[last] - moved[chosen[-1]] < 0.7 * gap:
        chosen.pop()
    return [*chosen, last]


def _sight(bag: Bag, index: int) -> _Sight:
    odom, joints = bag['odom'], bag['joint_states']
    row = min(int(np.searchsorted(joints.stamp, odom.stamp[index] - 1e-9)), len(joints.stamp) - 1)
    pose = (odom.x[index], odom.y[index], odom.heading[index], odom.vx[index], odom.vy[index], odom.yaw_rate[index])
    return _Sight(float(odom.stamp[index]), *map(float, pose), tuple(joints.position[row, :4].tolist()))


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
    axes.annotate('ICR', tuple(icr), (6, 4), textcoords='offset points', color=ACCENT, zorder=3)


def _draw_vehicle(axes: 'Axes', sight: _Sight, vehicle: VehicleParameters) -> None:
    frame = Affine2D().rotate(sight.heading).translate(sight.x, sight.y) + axes.transData
    front, rear = vehicle.cg_to_front_axle, -vehicle.cg_to_rear_axle
    width = max(vehicle.front_track, vehicle.rear_track) - 0.1
    corner, length = (rear - _OVERHANG, -0.5 * width), front - rear + 2 * _OVERHANG
    body = FancyBboxPatch(
        corner, length, width, boxstyle='round,pad=0.0,rounding_size=0.4', transform=frame,
        facecolor=_BODY, edgecolor=MUTED, linewidth=0.8, alpha=0.85, zorder=4,
    )
    axes.add_patch(body)
    nose = front + _OVERHANG
    screen = [(nose - 0.75, -0.40 * width), (nose - 0.75, 0.40 * width), (nose - 1.25, 0.33 * width), (nose - 1.25, -0.33 * width)]
    axes.add_patch(Polygon(screen, transform=frame, facecolor='#cbd2d9', edgecolor='none', zorder=5))
    radius = vehicle.wheel_radius
    for x, y, angle, colour in zip(vehicle.wheel_x, vehicle.wheel_y, sight.steer_angles, WHEEL_COLOURS, strict=True):
        place = Affine2D().rotate(angle).translate(x, y) + frame
        axes.add_patch(Rectangle(
            (-radius, -0.5 * _WHEEL_WIDTH), 2 * radius, _WHEEL_WIDTH, transform=place, facecolor=colour, edgecolor='white',
            linewidth=0.4, zorder=6,
        ))
