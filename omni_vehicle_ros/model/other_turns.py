"""Steady turns other than the one that slow driving leads to, on two curves that both begin in a turn of slow driving.

Over radius and speed the steady turns of a vehicle make a surface with folds. `steady_turn` follows a line of it, that
of a radius, from a creep to its first fold. Here the curve of the radius is followed round the fold to its end, and so
is the curve of a speed, from straight on to ever tighter turns: a driver who tightens a turn slowly at a held speed
stays on it for as long as it is stable.

A curve ends where a wheel lifts, where the vehicle skids sideways and at the end of the range that is looked at. There
are steady turns on neither curve, such as those of a vehicle that turns against its wheels; they are not looked for.
"""

import math
from typing import NamedTuple

import numpy as np

from omni_vehicle_ros.model.body import Inputs
from omni_vehicle_ros.model.continuation import Curve, Point
from omni_vehicle_ros.model.state import Vector
from omni_vehicle_ros.model.steady_turn import CREEP, Branch
from omni_vehicle_ros.model.turning import SteadyTurn, Turning
from omni_vehicle_ros.wheels import per_wheel

LONGEST_STEP = 0.1


class Tightening(NamedTuple):
    """A vehicle at a held ``speed`` [m/s] whose wheels stand as the ICR of any radius wants them.

    ``ahead`` is the vehicle with its wheels straight on. A place has the coordinates of a `Turning`, but for the first
    one, which is the wheelbase over the radius.
    """

    ahead: Turning
    speed: float

    @property
    def curve(self) -> Curve:
        """The places of all steady turns; their parameter is the curvature of the commanded turn."""
        return Curve(self.rates, self.ahead.curve.weights)

    def level(self, radius: float) -> float:
        """Return the first coordinate of a radius [m]."""
        return self.ahead.wheelbase / radius

    def rates(self, place: Vector) -> Vector:
        """Return what is 0 in a steady turn, shape (6,)."""
        return self._held(place[0]).rates(self._place(place))

    def turn(self, point: Point) -> SteadyTurn:
        """Return what a steady turn is like."""
        return self._held(point.place[0]).turn(point._replace(place=self._place(point.place)))

    def _held(self, level: float) -> Turning:
        """Return the vehicle with its wheels held along their motion about the ICR: 1 - y / R ahead, x / R across."""
        curvature = float(level) / self.ahead.wheelbase
        xs, ys = self.ahead.constants.wheel_x, self.ahead.constants.wheel_y
        angles = per_wheel(lambda i: math.atan2(xs[i] * curvature, 1.0 - ys[i] * curvature))
        return self.ahead._replace(inputs=Inputs(angles), radius=1.0 / curvature if curvature else math.inf)

    def _place(self, place: Vector) -> Vector:
        place = place.copy()
        place[0] = self.ahead.level(self.speed)
        return place


class TurnCurve(NamedTuple):
    """Steady turns along a curve: those of a held radius over the speed, or of a held speed over the radius."""

    held: Turning | Tightening
    points: tuple[Point, ...]

    def turns(self, value: float) -> list[SteadyTurn]:
        """Return the steady turns at a speed [m/s] or at a radius [m], whichever is not held."""
        found = self.held.curve.crossings(self.points, self.held.level(value))
        return [self.held.turn(point) for point in found]


def past_fold(branch: Branch, top_speed: float) -> TurnCurve:
    """Follow the curve of a radius from where its branch turned back; empty if it ended in another way.

    Parameters
    ----------
    branch
        The steady turns of the radius.
    top_speed
        Forward speed at which to stop [m/s].
    """
    held = branch.turning
    if not branch.folds:
        return TurnCurve(held, ())
    return _traced(held, branch.points[-1], held.level(CREEP), held.level(top_speed))


def tightened(straight: Branch, speed: float, smallest_radius: float) -> TurnCurve:
    """Follow the turns to the left of a held speed, from straight on; empty if straight on does not go so fast.

    Parameters
    ----------
    straight
        Driving straight on, of the vehicle on its road.
    speed
        Forward speed [m/s], above 0.
    smallest_radius
        Radius at which to stop [m].
    """
    held = Tightening(straight.turning, speed)
    start = straight.point(speed)
    first = None if start is None else held.curve.at(np.append(0.0, start.place[1:]))
    return TurnCurve(held, ()) if first is None else _traced(held, first, 0.0, held.level(smallest_radius))


def _traced(held: Turning | Tightening, first: Point, low: float, high: float) -> TurnCurve:
    """Follow a curve to its end, and a step beyond the largest parameter."""

    def goes_on(point: Point) -> bool:
        turn, inside = held.turn(point), low <= point.place[0] <= high + LONGEST_STEP
        return bool(inside) and not turn.skids and not turn.lifted

    return TurnCurve(held, held.curve.trace(first, LONGEST_STEP, goes_on))
