"""Controllers on the same manoeuvres: side slip, path error, steering effort and friction use of each."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.integrate import trapezoid

from omni_vehicle_ros.analysis.signals import Array
from omni_vehicle_ros.bags import Bag
from omni_vehicle_ros.scenarios import load_scenario
from omni_vehicle_ros.simulation import record

_TURN = 0.5  # rad, of which a radius can be told
_AHEAD = 10.0  # m, by which a commanded path goes on: the vehicle may be ahead of it


class Controller(NamedTuple):
    """A controller as a run selects it: its name in tables, and the settings of the scenario."""

    name: str
    settings: tuple[str, ...]


class Manoeuvre(NamedTuple):
    """A manoeuvre: its name in tables, its scenario, and the times [s] between which it is judged."""

    name: str
    scenario: str
    begin: float
    end: float


CONTROLLERS = (
    Controller('none', ('side_slip_control=false',)),
    Controller('wheel slip (5,5,0,0)', ('side_slip.proportional_gains=[5.0, 5.0, 0.0, 0.0]',)),
    Controller('wheel slip (5,1,0,0)', ('side_slip.proportional_gains=[5.0, 1.0, 0.0, 0.0]',)),
    Controller('yaw moment', ('side_slip.controller=yaw_moment',)),
    Controller('rear steering', ('side_slip.controller=rear_steering',)),
    Controller('allocation, steering', ('side_slip.controller=allocation', 'side_slip.allocation_traction=false')),
    Controller('allocation, all', ('side_slip.controller=allocation', 'side_slip.allocation_traction=true')),
)
MANOEUVRES = (
    Manoeuvre('turn, 5 m, 15 km/h', 'manoeuvres/turn', 10.0, 12.0),
    Manoeuvre('slippery turn', 'manoeuvres/slippery_turn', 7.0, 14.0),
    Manoeuvre('lane change', 'manoeuvres/lane_change', 1.0, 9.0),
    Manoeuvre('gust', 'manoeuvres/gust', 2.0, 9.0),
)


class Judgement(NamedTuple):
    """What a controller made of a manoeuvre.

    ``worst_slip``: largest side slip of any tyre [rad]; ``mean_slip``: mean size of the slips of all tyres [rad];
    ``path_error``: largest distance to the path that the commanded twist draws [m]; ``radius``: mean radius of
    the path [m], inf where it goes straight on in the end; ``steering_effort``: root mean square of the steer
    rates of all wheels over the whole run [rad/s]; ``friction_use``: largest of any tyre.
    """

    worst_slip: float
    mean_slip: float
    path_error: float
    radius: float
    steering_effort: float
    friction_use: float


@dataclass(frozen=True)
class Trial:
    """A controller on a manoeuvre, offline."""

    manoeuvre: Manoeuvre
    controller: Controller

    def work(self) -> Judgement:
        """Run it and judge it."""
        bag = record(load_scenario(self.manoeuvre.scenario, self.controller.settings))
        return judge(bag, self.manoeuvre.begin, self.manoeuvre.end)


def judge(bag: Bag, begin: float, end: float) -> Judgement:
    """Judge a run between two times [s]."""
    odom, tyres = bag['odom'], bag['tyres/side_slip']
    rows = slice(*np.searchsorted(odom.stamp, (begin - 1e-9, end + 1e-9)))
    slip = np.abs(tyres.position[rows])
    speed, yaw_rate = np.hypot(odom.vx, odom.vy)[rows], odom.yaw_rate[rows]
    turned, way = trapezoid(yaw_rate, odom.stamp[rows]), trapezoid(speed, odom.stamp[rows])
    reference = commanded_path(bag)
    position = np.column_stack((odom.x, odom.y))[rows]
    return Judgement(
        worst_slip=float(np.max(slip)),
        mean_slip=float(np.mean(slip)),
        path_error=float(np.max(distances(position, reference))),
        radius=float(way / turned) if abs(turned) > _TURN else math.inf,
        steering_effort=float(np.sqrt(np.mean(bag['joint_states'].velocity[:, :4] ** 2))),
        friction_use=float(np.max(tyres.effort[rows])),
    )


def commanded_path(bag: Bag) -> Array:
    """Return the path that the commanded twist draws from where the vehicle was at first [m], shape (n, 2).

    The twist holds from one cycle to the next, and its arc is taken exactly: along the chord, turned by half
    of what the heading turns. At the end it goes on straight.
    """
    odom, said = bag['odom'], bag['commanded_twist']
    step = np.diff(said.stamp)
    turn = said.yaw_rate[:-1] * step
    heading = odom.heading[0] + np.concatenate(([0.0], np.cumsum(turn)))[:-1] + 0.5 * turn
    chord = step * np.sinc(turn / (2.0 * math.pi))
    vx, vy = said.vx[:-1] * chord, said.vy[:-1] * chord
    steps = np.column_stack((vx * np.cos(heading) - vy * np.sin(heading), vx * np.sin(heading) + vy * np.cos(heading)))
    onward = steps[-1:] / np.hypot(*steps[-1]) * _AHEAD
    start = np.array([[odom.x[0], odom.y[0]]])
    path: Array = np.cumsum(np.concatenate((start, steps, onward)), axis=0)
    return path


def distances(points: Array, path: Array) -> Array:
    """Return how far points are from a path.

    Parameters
    ----------
    points
        [m], shape (n, 2).
    path
        Corners of the path in their order [m], shape (m, 2), m > 1.

    Returns
    -------
    ndarray
        Distance of each point to the nearest place on the path [m], shape (n,).
    """
    begin, along = path[:-1], np.diff(path, axis=0)
    length = np.maximum(np.sum(along * along, axis=1), 1e-12)
    nearest = np.empty(len(points))
    for i, point in enumerate(points):
        share = np.clip(np.sum((point - begin) * along, axis=1) / length, 0.0, 1.0)
        nearest[i] = np.sqrt(np.min(np.sum((begin + share[:, np.newaxis] * along - point) ** 2, axis=1)))
    return nearest
