"""Allocation: the commanded path with the least of the worst slip."""

import math
from typing import NamedTuple

from omni_vehicle_ros.control.axles import (
    NO_SLIP,
    AxleSlips,
    Demand,
    Tyres,
    axle_slips,
    largest_force,
    level_slips,
    within,
)
from omni_vehicle_ros.control.course import Course, CourseController, course_of, wheel_motion
from omni_vehicle_ros.control.grip import Grip, traction_share
from omni_vehicle_ros.control.health import WARN
from omni_vehicle_ros.control.traction import Resultant, easiest_moment_forces, resultant, traction_levers
from omni_vehicle_ros.control.trim import Sensed, Trims
from omni_vehicle_ros.model.kinematics import Twist
from omni_vehicle_ros.model.tyres.friction_circle import lateral_capacity
from omni_vehicle_ros.parameters import SideSlipParameters, VehicleParameters
from omni_vehicle_ros.wheels import PerWheel, per_wheel

# Shares of the slip limit from which on traction does less for the slips, and up to which anything: what friction
# is left then keeps the vehicle on its path.
_LEVEL_WHOLE, _LEVEL_NONE = 0.5, 0.8

# Rate at which levelling comes back after it was eased [1/s]: at once, it would be eased and come back in turns.
_LEVEL_RATE = 0.3

# Share of the slip limit that the path may ask for: the rest is for feedback, without which the vehicle sways at
# the limit.
_PLANNED = 0.85

# Difference of the axles' slips that never matters [rad].
_SLIP_NOISE = 0.01

# Share of what is left of a tyre's friction that levelling may use.
_LEVEL_ROOM = 0.5

# Slip over its limit that a wheel may have beside the command; its side force still grows there.
_SLIDING = 1.25

# Share of the slip limit that the slips fall short of what feedback wants where it counts as lost.
_LOST = 0.25

# Angle by which a path that can't be held turns less over its length of one wheelbase, per angle of drift.
_RUN_WIDE = 2.0

# Share of all friction that a change of the command may ask for.
_FOR_CHANGE = 0.25


class _Scene(NamedTuple):
    """One cycle: the course, the tyres on it, what the drives make, and the largest slip of an axle [rad]."""

    course: Course
    tyres: Tyres
    drive: Resultant
    limit: float


class _Path(NamedTuple):
    """What the grip lets the vehicle do of its course: the slips, curvature [1/m], the wheels' directions [rad]."""

    slips: AxleSlips
    curvature: float
    directions: PerWheel


class AllocationController(CourseController):
    """Four steer angles, and four drive torques if wanted, that keep the path with the least worst slip.

    On a path the balance of forces leaves each axle no choice of its side force, so the slips of its two
    tyres have a given mean. They differ as far as the vehicle moves beside its command: on a turn that it
    should make about one centre it turns about another one. A vehicle that does move as commanded has equal
    slips on an axle if both wheels are turned from their directions of motion by the same angle. That is the
    optimum here: the least worst slip (min-max), first of all wheels, then of the axle with the smaller slip.
    Steering alone reaches the mean of the axle with the larger slip. A yaw moment by traction takes side
    force from that axle; with ``Mz = (lr - lf) / 2 m ay`` all four slips of linear tyres are equal, and of
    all forces that make it those with the least use of friction are taken (`easiest_moment_forces`). Forces
    of turned wheels also have parts across the course. They are reckoned with, but not sought: to push the
    vehicle sideways with them would take slip from all tyres, for a multiple of the friction.

    The least sum of squares of all tyre forces would be another optimum, and take only ``T^2 / (T^2 + l^2)``
    of that moment (T track, l wheelbase; a quarter); the least sum of squares of friction use takes none at
    all, as without a moment both axles use the same share of their friction.

    Feed-forward: the slips that make ``m v r`` and ``Iz dr/dt``, by the inverse of Dugoff's tyre with
    quasi-static loads and the friction estimate, and against roll steer. Feedback: a PI law on the error of
    the yaw rate, to the axle that leads minus the one that trails, and another on the drift, to both. As
    angles: ``(r_ref - r) base / v`` and ``-drift / v``. One law for each axle on the error of its own
    direction would not do: past ``v^2 = 2 C l^2 / (m lf)``, 17 m/s by default, a larger front angle in the
    end turns the direction of the front axle the other way.

    No axle is asked for more than half of the slip of the largest side force, and 0.85 of that by the path
    alone, and no wheel is turned much farther from the way that it really goes. Where the path asks for more,
    the reference moves out to the curvature that the axles can hold without a yaw moment: the vehicle runs
    wide, and comes back when it is slower. The difference of the axles, which turns the vehicle, comes before
    what they push together; and where that is not enough to keep it from drifting outward, it turns less.

    Parameters
    ----------
    parameters
        Gains, limits, friction estimate, and whether to use traction.
    vehicle
        Mass, geometry, tyres, roll.
    """

    doing = 'allocating slip on the commanded path'

    def __init__(self, parameters: SideSlipParameters, vehicle: VehicleParameters) -> None:
        super().__init__(parameters, vehicle)
        self._grip = Grip(vehicle, parameters.friction_estimate)
        self._for_change = _FOR_CHANGE * parameters.friction_estimate * vehicle.mass * vehicle.gravity

    def _reset(self) -> None:
        self._common = self._difference = 0.0
        self._before: Course | None = None
        self._last = self._last_level = NO_SLIP  # where to begin to solve
        self._expected = Twist(0.0, 0.0, 0.0)
        self._lost = 0.0
        self._levelled = 1.0

    def _control(self, course: Course, sensed: Sensed, dt: float) -> Trims:
        vehicle, grip = self._vehicle, self._grip
        forces = per_wheel(lambda i: sensed.drive_torque[i] / vehicle.wheel_radius)
        capacities = grip.capacities(sensed.lateral_acceleration)
        rest = per_wheel(lambda i: lateral_capacity(capacities[i], forces[i]))
        scene = _Scene(
            course,
            Tyres(course, sensed.steer_angle, rest, grip, vehicle),
            resultant(forces, sensed.steer_angle, course.bearing, vehicle),
            grip.slip_limit(course.speed),
        )
        path = self._feed_forward(scene, dt)
        path = path._replace(slips=self._corrected(path, scene, sensed, dt))
        steer_angle = self._steer(path, scene, sensed.lateral_acceleration)
        if not self._parameters.allocation_traction:
            return Trims(steer_angle)
        return Trims(steer_angle, self._drive(path.curvature, scene, sensed, capacities, dt))

    def _feed_forward(self, scene: _Scene, dt: float) -> _Path:
        """Return the course, or what can be held of it, and the slips that it asks for."""
        course, tyres, drive, limit = scene
        limit = _PLANNED * limit
        change = self._change(course, dt)
        pull = self._vehicle.mass * course.speed**2
        steady = pull * course.curvature - drive.across
        demand = Demand(steady + change.force, change.moment - drive.moment)
        slips = self._last = axle_slips(demand, tyres, limit, self._last)
        if max(map(abs, slips)) < limit:
            return _Path(slips, course.curvature, tyres.directions)
        most = largest_force(steady, -drive.moment, tyres, limit)
        if abs(steady) <= abs(most):
            return _Path(slips, course.curvature, tyres.directions)
        self._notes.append((WARN, 'the path asks for more than the grip: running wide'))
        slips = axle_slips(demand._replace(force=most), tyres, limit)
        curvature = (most + drive.across) / pull
        return _Path(slips, curvature, wheel_motion(course.bearing, curvature, self._vehicle)[0])

    def _change(self, course: Course, dt: float) -> Demand:
        """Return what the change of bearing and curvature asks for; update what is expected."""
        before, self._before = self._before, course
        told = Twist(math.cos(course.bearing), math.sin(course.bearing), course.curvature)
        if before is None:
            self._expected = told
            return Demand(0.0, 0.0)
        gain = 1.0 - math.exp(-dt / self._parameters.reference_time_constant)
        self._expected = Twist(*(old + gain * (new - old) for old, new in zip(self._expected, told, strict=True)))
        swing = math.remainder(course.bearing - before.bearing, math.tau) / dt
        curving = (course.curvature - before.curvature) / dt
        most, arm = self._for_change, self._vehicle.wheelbase
        force, moment = self._vehicle.mass * course.speed * swing, self._vehicle.yaw_inertia * course.speed * curving
        return Demand(min(max(force, -most), most), min(max(moment, -most * arm), most * arm))

    def _corrected(self, path: _Path, scene: _Scene, sensed: Sensed, dt: float) -> AxleSlips:
        """Return the slips with what the feedback adds, within their limits; no integral pushes beyond them."""
        p, speed, base = self._parameters, scene.course.speed, scene.tyres.base
        expected = course_of(self._expected, sensed.twist) or scene.course
        drift_error = -expected.drift / speed
        yaw_error = (self._aim(expected.curvature, drift_error, path, scene) - sensed.twist.r / speed) * base
        step = p.allocation_integral_gain * dt
        common, difference = self._common + step * drift_error, self._difference + step * yaw_error
        both, half = p.allocation_gain * drift_error + common, 0.5 * (p.allocation_gain * yaw_error + difference)
        wanted = AxleSlips(path.slips.leading + both + half, path.slips.trailing + both - half)
        given = within(wanted, self._beside(path, scene, sensed), scene.limit, _SLIDING * scene.limit)
        lost = abs(given.leading - wanted.leading) + abs(given.trailing - wanted.trailing)
        if lost == 0.0:
            self._common, self._difference = common, difference
        self._lost = min(lost / (_LOST * scene.limit), 1.0)
        return given

    def _aim(self, expected: float, drift_error: float, path: _Path, scene: _Scene) -> float:
        """Return the curvature to turn with: where slips are at their limits, a drift outward makes the path wider.

        Nothing else could take the drift back, which would end in a spin.
        """
        if path.curvature != scene.course.curvature:
            expected = min(max(expected, -abs(path.curvature)), abs(path.curvature))
        side = math.copysign(1.0, path.curvature)
        return expected - side * self._lost * _RUN_WIDE * max(side * drift_error, 0.0) / scene.tyres.base

    def _beside(self, path: _Path, scene: _Scene, sensed: Sensed) -> AxleSlips:
        """Return by how much the axles slip more than their steer angles would make them slip on the path [rad]."""
        roll, angle, held = self._grip.roll_steer(sensed.lateral_acceleration), sensed.steer_angle, path.directions
        told = per_wheel(lambda i: math.remainder(angle[i] + roll[i] - held[i], math.pi))
        return scene.tyres.means(per_wheel(lambda i: sensed.side_slip[i] - told[i]))

    def _steer(self, path: _Path, scene: _Scene, lateral_acceleration: float) -> PerWheel:
        """Return the steering trims: slip less roll steer, on the directions of the path that can be held."""
        told, held, each = scene.tyres.directions, path.directions, scene.tyres.slips(path.slips)
        roll = self._grip.roll_steer(lateral_acceleration)
        return per_wheel(lambda i: math.remainder(held[i] - told[i], math.tau) + each[i] - roll[i])

    def _drive(self, curvature: float, scene: _Scene, sensed: Sensed, capacities: PerWheel, dt: float) -> PerWheel:
        """Return the torques of the moment that levels the axles' slips, within the friction circles."""
        course, tyres, drive, limit = scene
        force = self._vehicle.mass * curvature * course.speed**2 - drive.across
        slips = self._last_level = level_slips(force, tyres, limit, self._last_level)
        side = tyres.side_forces(slips)
        room = per_wheel(lambda i: _LEVEL_ROOM * lateral_capacity(capacities[i], side[i]))
        # What the drives make without the trim: the force along the course, shared equally.
        angle = sensed.steer_angle
        ways = per_wheel(lambda i: math.copysign(0.25, math.cos(angle[i] - tyres.directions[i])))
        present = per_wheel(lambda i: ways[i] * drive.along)
        levers = traction_levers(angle, self._vehicle)
        there = sum(force * lever for force, lever in zip(present, levers, strict=True))
        share = _ease(slips, tyres.means(sensed.side_slip), limit)
        self._levelled = min(share, self._levelled + _LEVEL_RATE * dt)
        moment = -self._levelled * (tyres.made(slips).moment + there)
        added = easiest_moment_forces(moment, angle, course.bearing, room, self._vehicle)
        scale = traction_share(added, present, room) * self._vehicle.wheel_radius
        return per_wheel(lambda i: scale * added[i])


def _ease(expected: AxleSlips, measured: AxleSlips, limit: float) -> float:
    """Return the share of the moment: down to 0 near the slip limit, and where the axle that trails slips far more.

    It does so where the road is more slippery than estimated: the moment would take from it what it does not
    have.
    """
    worst = max(map(abs, (*expected, *measured))) / limit
    excess = (abs(measured.trailing) - abs(measured.leading)) / (0.5 * abs(expected.trailing) + _SLIP_NOISE)
    near = (_LEVEL_NONE - worst) / (_LEVEL_NONE - _LEVEL_WHOLE)
    return min(max(near, 0.0), 1.0) * min(max(1.0 - excess, 0.0), 1.0)
