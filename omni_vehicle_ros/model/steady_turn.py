"""Steady turns found directly, as roots of the equations of motion, and the speed at which they are lost.

At a creep the steady turn is the motion about the ICR, without any slip. The turns of higher speeds are what this one
becomes as the speed rises: a branch of roots, to which slow driving leads. There are other roots: saddles, repellers,
and at higher speeds stable ones, too, to which a vehicle comes from a wider turn; see `other_turns`.
"""

import functools
import math
from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np
from scipy.optimize import minimize_scalar

from omni_vehicle_ros.errors import ParameterError
from omni_vehicle_ros.model.continuation import Point
from omni_vehicle_ros.model.dynamics import Environment
from omni_vehicle_ros.model.turning import SteadyTurn, Turning, speed_of, turning
from omni_vehicle_ros.parameters import VehicleParameters

LEVEL_ROAD = Environment()
CREEP = 0.1  # m/s, where a branch begins
TOP_SPEED = 60.0  # m/s
LONGEST_STEP = 0.05
FLAT = 1e-3  # share of the speed in a step along the branch where it turns back

Cause = Literal['fold', 'divergence', 'oscillation', 'skid', 'lift']
_Loss = tuple[float, Cause] | tuple[None, None]


class Limit(NamedTuple):
    """Where the steady turns of a radius are lost to a vehicle that speeds up slowly.

    ``speed``: the largest forward speed up to which slow driving leads to a stable steady turn with all wheels on the
    ground [m/s]. ``cause``: what comes then; None as ``speed`` is if nothing does.

    - fold: the branch turns back, slow driving leads to no steady turn at a higher speed;
    - divergence, oscillation: it leads to one, but disturbances grow, without or with oscillation;
    - skid: the vehicle moves sideways rather than forward, or there is no grip for a turn at any speed;
    - lift: a wheel leaves the ground.

    A turn that is not lost may be wide all the same. ``grip_speed``: the speed of the largest lateral acceleration
    [m/s], from which on a faster vehicle only runs wide; ``slide_speed``: that from which on both tyres of an axle
    slide [m/s]. None if they don't come up to the limit.
    """

    speed: float | None
    cause: Cause | None
    grip_speed: float | None
    slide_speed: float | None

    def margin(self, speed: float) -> float | None:
        """Return by how much of the limit a speed [m/s] lies below it, negative above; None without a limit."""
        if self.speed is None:
            return None
        return 1.0 - speed / self.speed if self.speed > 0.0 else -math.inf


class Branch(NamedTuple):
    """The steady turns of one radius: points in the order of speed, from a creep to a fold or to the top speed."""

    turning: Turning
    points: tuple[Point, ...]
    limit: Limit

    @property
    def end(self) -> float:
        """Speed up to which slow driving leads to steady turns, or up to which they were looked for [m/s]."""
        return speed_of(self.points[-1]) if self.points else 0.0

    @property
    def folds(self) -> bool:
        """Whether the curve turns back where the branch ends."""
        return bool(self.points) and bool(self.points[-1].tangent[0] < FLAT)

    def turn(self, speed: float) -> SteadyTurn | None:
        """Return the steady turn at a forward speed above 0 [m/s], or None if there is none."""
        point = self.point(speed)
        return None if point is None else self.turning.turn(point)

    def point(self, speed: float) -> Point | None:
        """Return the point at a forward speed above 0 [m/s], or None if there is none."""
        if not 0.0 < speed <= self.end:
            return None
        levels = [float(point.place[0]) for point in self.points]
        level = min(self.turning.level(speed), levels[-1])
        above = int(np.searchsorted(levels, level))
        if above == 0:
            return self.turning.creeping(speed)
        return self.turning.curve.between(self.points[above - 1], self.points[above], level)


def steady_turn(
    vehicle: VehicleParameters, radius: float, speed: float, environment: Environment = LEVEL_ROAD
) -> SteadyTurn | None:
    """Return the steady turn that slow driving leads to at a forward speed, or None if it leads to none.

    Parameters
    ----------
    vehicle
        The vehicle.
    radius
        Distance of the ICR to the left of the centre of gravity [m]; negative to the right, inf straight on.
    speed
        Forward speed [m/s], above 0.
    environment
        Bank, wind and friction.

    Raises
    ------
    CommandError
        A wheel would have to turn by more than 90 deg (road rule), as the ICR lies within the track.
    ParameterError
        The speed is not above 0.
    """
    if not speed > 0.0:
        raise ParameterError(f'speed: {speed!r} m/s must be above 0')
    return steady_turns(vehicle, radius, environment, speed).turn(speed)


def limit_speed(
    vehicle: VehicleParameters, radius: float, environment: Environment = LEVEL_ROAD, top_speed: float = TOP_SPEED
) -> Limit:
    """Return up to which speed slow driving leads to stable steady turns, and what comes then; see `steady_turns`."""
    return steady_turns(vehicle, radius, environment, top_speed).limit


@functools.lru_cache(maxsize=64)
def steady_turns(
    vehicle: VehicleParameters, radius: float, environment: Environment = LEVEL_ROAD, top_speed: float = TOP_SPEED
) -> Branch:
    """Follow the steady turns of a radius from a creep to where they end, or to the top speed.

    The limit is good to 1e-6 m/s or so. The branch ends at a fold, where a wheel lifts, and where the vehicle
    skids sideways.

    Parameters
    ----------
    vehicle, radius, environment
        As in `steady_turn`.
    top_speed
        Forward speed up to which to look [m/s].

    Raises
    ------
    CommandError
        As in `steady_turn`.
    """
    held = turning(vehicle, radius, environment)
    first = held.creeping(min(CREEP, top_speed))
    if first is None:  # bank or wind take more than the grip there is
        return Branch(held, (), Limit(0.0, 'skid', None, None))
    points, turns, (lost, cause) = _followed(held, first, top_speed)
    marks = _grip_speed(held, points, turns), _slide_speed(held, points, turns)
    grip, slide = (None if mark is None or (lost is not None and mark > lost) else mark for mark in marks)
    return Branch(held, tuple(points), Limit(lost, cause, grip, slide))


def _followed(held: Turning, first: Point, top_speed: float) -> tuple[list[Point], list[SteadyTurn], _Loss]:
    """Return the points of a branch that begins with the first one, their turns, and how they are lost first."""
    curve, points, turns = held.curve, [first], [held.turn(first)]
    loss: _Loss = (None, None) if _sound(turns[0]) else (0.0, _cause(first, turns[0]))
    for point in curve.follow(first, LONGEST_STEP):
        turn, end = held.turn(point), None
        if not _goes_on(point, turn):
            point, end = curve.border(points[-1], point, lambda point: _goes_on(point, held.turn(point)))
            turn = held.turn(point)
        if loss[0] is None and not _sound(turn):
            inside, outside = curve.border(points[-1], point, lambda point: _sound(held.turn(point)))
            loss = speed_of(inside), _cause(outside, held.turn(outside))
        points.append(point)
        turns.append(turn)
        if end is not None:
            loss = loss if loss[0] is not None else (speed_of(point), _cause(end, held.turn(end)))
        if end is not None or speed_of(point) >= top_speed:
            break
    else:  # nothing but the corner of the curve where a wheel lifts can't be passed
        loss = loss if loss[0] is not None else (speed_of(points[-1]), 'lift')
    return points, turns, loss


def _sound(turn: SteadyTurn) -> bool:
    return turn.stable and not turn.skids and not turn.lifted


def _goes_on(point: Point, turn: SteadyTurn) -> bool:
    return bool(point.tangent[0] > 0.0) and not turn.skids and not turn.lifted


def _cause(point: Point, turn: SteadyTurn) -> Cause:
    if turn.lifted:
        return 'lift'
    if turn.skids:
        return 'skid'
    if turn.eigenvalues[0].imag != 0.0:
        return 'oscillation'
    return 'fold' if point.tangent[0] < FLAT else 'divergence'


def _slide_speed(held: Turning, points: Sequence[Point], turns: Sequence[SteadyTurn]) -> float | None:
    first = next((number for number, turn in enumerate(turns) if turn.slides), None)
    if first is None:
        return None
    if first == 0:
        return speed_of(points[0])
    border = held.curve.border(points[first - 1], points[first], lambda point: not held.turn(point).slides)
    return speed_of(border[0])


def _grip_speed(held: Turning, points: Sequence[Point], turns: Sequence[SteadyTurn]) -> float | None:
    curve, side = held.curve, math.copysign(1.0, held.radius)
    best = int(np.argmax([side * turn.lateral_acceleration for turn in turns]))
    if not 0 < best < len(points) - 1:
        return None
    before = points[best - 1]

    def outward(step: float) -> float:
        point = curve.stepped(before, step)
        return 0.0 if point is None else -side * held.turn(point).lateral_acceleration

    reach = curve.along(before, points[best + 1].place - before.place)
    top = curve.stepped(before, minimize_scalar(outward, bounds=(0.0, reach), method='bounded').x)
    return None if top is None else speed_of(top)
