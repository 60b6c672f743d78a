"""From the force that a path asks for to the slips of the two axles.

Every wheel is turned from the direction that it moves in by the slip of its axle, and makes a side force to
the left of its heading. The axle that leads and the one that trails are the front and the rear one straight
on, the other way round in reverse, and the left and the right wheels in a crab to the left; a wheel abreast
of the centre of gravity belongs to both by halves.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

from omni_vehicle_ros.control.course import Course, wheel_motion
from omni_vehicle_ros.control.grip import Grip
from omni_vehicle_ros.parameters import VehicleParameters
from omni_vehicle_ros.wheels import PerWheel, per_wheel

_STEPS = 8
_SETTLED = 1e-5  # rad, of the last step; what it leaves is of the order of its square
_DIFFERENCE = 1e-6  # rad, for the slope of a tyre


class AxleSlips(NamedTuple):
    """Slips of the leading and of the trailing axle [rad], positive where they make a force to the left."""

    leading: float
    trailing: float


NO_SLIP = AxleSlips(0.0, 0.0)


class Demand(NamedTuple):
    """Force to the left of the course [N] and moment, anticlockwise [N m]."""

    force: float
    moment: float


class Tyres:
    """The four tyres on a course.

    Parameters
    ----------
    course
        What the wheels do if the vehicle keeps to it.
    steer_angle
        Measured steer angles, for the directions of the forces [rad].
    capacities
        Largest force of each tyre sideways [N].
    grip, vehicle
        Law of the tyres; positions of the wheels.

    Attributes
    ----------
    directions
        In which the wheels move, in base_link [rad].
    base
        Distance along the course from the axle that trails to the one that leads [m].
    """

    def __init__(
        self, course: Course, steer_angle: PerWheel, capacities: PerWheel, grip: Grip, vehicle: VehicleParameters
    ) -> None:
        directions, ratios = wheel_motion(course.bearing, course.curvature, vehicle)
        self.directions = directions
        self._speeds = per_wheel(lambda i: ratios[i] * course.speed)
        self._capacities, self._grip = capacities, grip
        x, y = vehicle.wheel_x, vehicle.wheel_y
        # Also of a wheel that rolls backward: the force to the left of the way that it goes.
        headings = per_wheel(lambda i: directions[i] + math.remainder(steer_angle[i] - directions[i], math.pi))
        self._across = per_wheel(lambda i: math.cos(headings[i] - course.bearing))
        self._lever = per_wheel(lambda i: x[i] * math.cos(headings[i]) + y[i] * math.sin(headings[i]))
        cos, sin = math.cos(course.bearing), math.sin(course.bearing)
        ahead = per_wheel(lambda i: x[i] * cos + y[i] * sin)
        farthest = max(map(abs, ahead))
        lead = self._lead = per_wheel(lambda i: 0.5 + 0.5 * min(max(5.0 * ahead[i] / farthest, -1.0), 1.0))
        leading = sum(share * place for share, place in zip(lead, ahead, strict=True)) / sum(lead)
        trailing = sum((1.0 - share) * place for share, place in zip(lead, ahead, strict=True)) / (4.0 - sum(lead))
        self.base = leading - trailing

    def slips(self, axles: AxleSlips) -> PerWheel:
        """Return the slip of every wheel [rad]."""
        lead = self._lead
        return per_wheel(lambda i: lead[i] * axles.leading + (1.0 - lead[i]) * axles.trailing)

    def means(self, slips: PerWheel) -> AxleSlips:
        """Return the mean slips of the axles [rad]."""
        lead = self._lead
        return AxleSlips(
            sum(share * slip for share, slip in zip(lead, slips, strict=True)) / sum(lead),
            sum((1.0 - share) * slip for share, slip in zip(lead, slips, strict=True)) / (4.0 - sum(lead)),
        )

    def side_forces(self, axles: AxleSlips) -> PerWheel:
        """Return the force of every tyre to the left of the way that it goes [N]."""
        slips = self.slips(axles)
        return per_wheel(lambda i: self._grip.side_force(slips[i], self._speeds[i], self._capacities[i]))

    def made(self, axles: AxleSlips) -> Demand:
        """Return force and moment that all side forces make together."""
        return self._sum(self.side_forces(axles))

    def linearised(self, axles: AxleSlips) -> tuple[Demand, Demand, Demand]:
        """Return what is `made`, and its slopes by the slips of the leading and of the trailing axle."""
        force, lead = self.side_forces(axles), self._lead
        more = self.side_forces(AxleSlips(axles.leading + _DIFFERENCE, axles.trailing + _DIFFERENCE))
        slope = per_wheel(lambda i: (more[i] - force[i]) / _DIFFERENCE)
        leading = per_wheel(lambda i: slope[i] * lead[i])
        return self._sum(force), self._sum(leading), self._sum(per_wheel(lambda i: slope[i] - leading[i]))

    def _sum(self, forces: PerWheel) -> Demand:
        fl, fr, rl, rr = forces
        across, lever = self._across, self._lever
        return Demand(
            fl * across[0] + fr * across[1] + rl * across[2] + rr * across[3],
            fl * lever[0] + fr * lever[1] + rl * lever[2] + rr * lever[3],
        )


def axle_slips(demand: Demand, tyres: Tyres, limit: float, start: AxleSlips = NO_SLIP) -> AxleSlips:
    """Return the slips that make a force and a moment (Newton's method).

    Where an axle would have to pass the limit it stays there, and the other one makes what is missing of the
    moment, not of the force: past the grip limit the vehicle runs wide and doesn't spin.

    Parameters
    ----------
    demand
        What the side forces shall make.
    tyres
        The tyres on their course.
    limit
        Largest slip of an axle, to either side [rad]; up to there every tyre makes more force with more slip.
    start
        Where to begin: it saves time, and changes the result by rounding only. From no slip at all each step
        falls short, as a tyre gives less and less for more slip.
    """
    lead, trail = start
    for _ in range(_STEPS):
        now, by_lead, by_trail = tyres.linearised(AxleSlips(lead, trail))
        determinant = by_lead.force * by_trail.moment - by_trail.force * by_lead.moment
        if determinant == 0.0:
            break
        force, moment = demand.force - now.force, demand.moment - now.moment
        more_lead = (by_trail.moment * force - by_trail.force * moment) / determinant
        more_trail = (by_lead.force * moment - by_lead.moment * force) / determinant
        lead, trail = lead + more_lead, trail + more_trail
        if max(abs(lead), abs(trail)) > limit:
            if start != NO_SLIP:
                return axle_slips(demand, tyres, limit)
            return _held(AxleSlips(lead, trail), demand.moment, tyres, limit)
        if abs(more_lead) + abs(more_trail) < _SETTLED:
            break
    return AxleSlips(lead, trail)


def largest_force(side: float, moment: float, tyres: Tyres, limit: float) -> float:
    """Return the largest force to one side that goes with a moment [N].

    Parameters
    ----------
    side
        Positive for a force to the left.
    moment
        Of the side forces, anticlockwise [N m].
    tyres, limit
        As in `axle_slips`.
    """
    beyond = math.copysign(2.0 * limit, side)
    return tyres.made(_held(AxleSlips(beyond, beyond), moment, tyres, limit)).force


def level_slips(force: float, tyres: Tyres, limit: float, start: AxleSlips = NO_SLIP) -> AxleSlips:
    """Return the slips, the same for both axles, that make a force to the left of the course [N].

    Parameters
    ----------
    force
        [N].
    tyres, limit, start
        As in `axle_slips`.
    """

    def level(slip: float) -> tuple[float, float]:
        now, by_lead, by_trail = tyres.linearised(AxleSlips(slip, slip))
        return now.force, by_lead.force + by_trail.force

    slip = _balance(level, force, limit, start.trailing)
    return AxleSlips(slip, slip)


def within(wanted: AxleSlips, beside: AxleSlips, limit: float, sliding: float) -> AxleSlips:
    """Return slips within their limits, and their difference before their sum.

    The difference turns the vehicle, the sum moves it: so it may leave its path, but not its heading.

    Parameters
    ----------
    wanted
        Slips on the path.
    beside
        What the axles slip beside that already, as the vehicle does not move along its path.
    limit, sliding
        Largest slip on the path, and of both together [rad].
    """
    low, high = AxleSlips(*(-sliding - more for more in beside)), AxleSlips(*(sliding - more for more in beside))
    lowest = AxleSlips(*(min(max(least, -limit), most) for least, most in zip(low, high, strict=True)))
    highest = AxleSlips(*(max(min(most, limit), least) for least, most in zip(low, high, strict=True)))
    shift = min(most - slip for most, slip in zip(highest, wanted, strict=True))
    if shift >= 0.0:
        shift = max(0.0, *(least - slip for least, slip in zip(lowest, wanted, strict=True)))
    slips = (slip + shift for slip in wanted)
    return AxleSlips(*(min(max(slip, least), most) for slip, least, most in zip(slips, lowest, highest, strict=True)))


def _held(slips: AxleSlips, moment: float, tyres: Tyres, limit: float) -> AxleSlips:
    """Return slips within the limit that make the moment, whatever becomes of the force."""

    def leading(trail: float) -> float:
        def made(slip: float) -> tuple[float, float]:
            now, by_lead, _ = tyres.linearised(AxleSlips(slip, trail))
            return now.moment, by_lead.moment

        return _balance(made, moment, limit)

    def trailing(lead: float) -> float:
        def made(slip: float) -> tuple[float, float]:
            now, _, by_trail = tyres.linearised(AxleSlips(lead, slip))
            return now.moment, by_trail.moment

        return _balance(made, moment, limit)

    if abs(slips.leading) <= limit:
        trail = _clip(slips.trailing, limit)
        return AxleSlips(leading(trail), trail)
    lead = _clip(slips.leading, limit)
    trail = trailing(lead)
    return AxleSlips(lead, trail) if abs(trail) < limit else AxleSlips(leading(trail), trail)


def _balance(
    made: Callable[[float], tuple[float, float]], wanted: float, limit: float, start: float = 0.0
) -> float:
    """Return the slip at which ``made``, a value and its slope, is what is wanted; at most the limit."""
    slip = start
    for _ in range(_STEPS):
        now, slope = made(slip)
        if slope == 0.0:
            break
        more = (wanted - now) / slope
        slip += more
        if abs(slip) > limit:
            return _balance(made, wanted, limit) if start != 0.0 else _clip(slip, limit)
        if abs(more) < _SETTLED:
            break
    return slip


def _clip(slip: float, limit: float) -> float:
    return min(max(slip, -limit), limit)
