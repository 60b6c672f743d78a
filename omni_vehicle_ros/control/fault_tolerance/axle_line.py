"""Where the ICR can be when a wheel does not steer, and what of that is nearest to what the driver wants.

A wheel at (x, y) that points along ``h = (cos d, sin d)`` rolls without side slip if its velocity has no part across
``h``: ``-sin d vx + cos d vy + (x cos d + y sin d) r = 0``. In the space of motions (vx, vy, r L) that is a plane
through the origin. The ICRs of its motions are the points of the wheel's axle line, and the motion straight along
``h`` is its point at infinity. Two such planes meet in one motion, which turns about the point where the two lines
meet, or goes straight on if they are parallel.

Nearest is meant in the metric ``dvx^2 + dvy^2 + (D dr)^2`` for a large look-ahead distance D, that is, by where the
vehicle is after a while: an error of the yaw rate grows with the square of the way, one of the velocity with the way.
In the limit the yaw rate stays the driver's, and the velocity gives way by as little as it can. So the nearest ICR is
the foot of the perpendicular from the driver's ICR to the axle line, and straight on becomes a crab along the wheel:
one rule for near and far ICRs, crab, straight on and the spin in place.
"""

import math
from collections.abc import Callable, Sequence
from itertools import count, takewhile
from typing import NamedTuple

from omni_vehicle_ros.control.motion import Motion, angle_between, length_scale, opposite, unit_motion
from omni_vehicle_ros.parameters import VehicleParameters

FARTHEST = math.pi / 3.0
"""A motion farther from the driver's than this is not what the driver wants in any sense [rad]."""

FORCED = 0.05
"""The one motion of two axle lines can't be steered. It is only made if it is not farther from the driver's than this
[rad]: over the way of a stop from 4 m/s at 2 m/s2 the path is then off by a third of a metre at most."""

# Axle lines whose planes have a smaller angle than this are one [rad]: those of two wheels that point straight on.
_SAME_LINE = 0.02

# Step of the search along a line for what the other wheels can steer [rad], and halvings that refine what it finds.
_STEP = math.radians(1.0)
_HALVINGS = 30

# A projection shorter than this has no direction.
_NOTHING = 1e-6


class HeldWheel(NamedTuple):
    """A wheel that does not steer: its place ahead and to the left of the centre of gravity [m], its angle [rad]."""

    x: float
    y: float
    angle: float


def nearest_motion(
    target: Motion, held: Sequence[HeldWheel], reachable: Callable[[Motion], bool], vehicle: VehicleParameters
) -> Motion | None:
    """Return the motion nearest to a target that held wheels make without side slip.

    Parameters
    ----------
    target
        What the driver wants.
    held
        One wheel or more.
    reachable
        Says of a motion whether the other wheels can steer it.
    vehicle
        Its wheelbase.

    Returns
    -------
    Motion or None
        None if there is no such motion within `FARTHEST` of the target, or within `FORCED` if it is the only one.
    """
    planes = _different([_plane(wheel, vehicle) for wheel in held])
    if len(planes) > 2:
        return None
    if len(planes) == 1:
        return _on_line(target, planes[0], reachable)
    meeting = unit_motion(*_cross(*planes))
    if angle_between(meeting, target) > 0.5 * math.pi:
        meeting = opposite(meeting)
    return meeting if angle_between(meeting, target) <= FORCED and reachable(meeting) else None


def _plane(wheel: HeldWheel, vehicle: VehicleParameters) -> Motion:
    """Return the normal of the motions without side slip of a wheel."""
    cos, sin = math.cos(wheel.angle), math.sin(wheel.angle)
    return unit_motion(-sin, cos, (wheel.x * cos + wheel.y * sin) / length_scale(vehicle))


def _different(planes: list[Motion]) -> list[Motion]:
    found: list[Motion] = []
    for plane in planes:
        if all(math.hypot(*_cross(plane, other)) > _SAME_LINE for other in found):
            found.append(plane)
    return found


def _on_line(target: Motion, plane: Motion, reachable: Callable[[Motion], bool]) -> Motion | None:
    # Across the heading, and by how much the target moves the wheel so.
    across = plane.ux * plane.ux + plane.uy * plane.uy
    step = (plane.ux * target.ux + plane.uy * target.uy + plane.ur * target.ur) / across
    found = target.ux - step * plane.ux, target.uy - step * plane.uy, target.ur
    if math.hypot(*found) < _NOTHING:
        return None
    best = unit_motion(*found)
    if reachable(best):
        return best if angle_between(best, target) <= FARTHEST else None
    ways = (_along(best, unit_motion(*_cross(way, best)), target, reachable) for way in (plane, opposite(plane)))
    return min((motion for motion in ways if motion), key=lambda motion: angle_between(motion, target), default=None)


def _along(start: Motion, way: Motion, target: Motion, reachable: Callable[[Motion], bool]) -> Motion | None:
    """Return the first reachable motion on the great circle from a start, which is not, on one way."""

    def at(angle: float) -> Motion:
        c, s = math.cos(angle), math.sin(angle)
        return unit_motion(*(c * a + s * b for a, b in zip(start, way, strict=True)))

    angles = takewhile(lambda angle: angle <= 2.0 * FARTHEST, (_STEP * number for number in count(1)))
    high = next((angle for angle in angles if reachable(at(angle))), None)
    if high is None or angle_between(at(high), target) > FARTHEST:
        return None
    low = high - _STEP
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if reachable(at(middle)) else (middle, high)
    return at(high)


def _cross(a: Motion, b: Motion) -> tuple[float, float, float]:
    return a.uy * b.ur - a.ur * b.uy, a.ur * b.ux - a.ux * b.ur, a.ux * b.uy - a.uy * b.ux
