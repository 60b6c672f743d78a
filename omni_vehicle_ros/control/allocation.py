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

# Share of the slip limit up to which traction loads the axle that trails for the sake of the one that leads:
# past the grip limit the one that leads must be the first to let go.
_RESERVE = 0.7

# Difference of the axles' slips that never matters [rad].
_SLIP_NOISE = 0.01

# Share of all friction that a change of the command may ask for.
_FOR_CHANGE = 0.25


class _Scene(NamedTuple):
    """One cycle: the course, the tyres on it, what the drives make, and the largest slip of an axle [rad]."""

    course: Course
    tyres: Tyres
    drive: Resultant
    limit: float


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

    No axle is asked for more than half of the slip of the largest side force. Where the path asks for more,
    the reference moves out to the curvature that the axles can hold without a yaw moment: the vehicle runs
    wide, and comes back when it is slower.

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
        slips, curvature = self._feed_forward(scene, dt)
        slips = self._corrected(slips, curvature, scene, sensed.twist, dt)
        steer_angle = self._steer(slips, curvature, scene, sensed.lateral_acceleration)
        if not self._parameters.allocation_traction:
            return Trims(steer_angle)
        return Trims(steer_angle, self._drive(curvature, scene, sensed, capacities))

    def _feed_forward(self, scene: _Scene, dt: float) -> tuple[AxleSlips, float]:
        """Return the slips that the course asks for, and its curvature or what can be held of it [1/m]."""
        course, tyres, drive, limit = scene
        change = self._change(course, dt)
        pull = self._vehicle.mass * course.speed**2
        steady = pull * course.curvature - drive.across
        demand = Demand(steady + change.force, change.moment - drive.moment)
        slips = self._last = axle_slips(demand, tyres, limit, self._last)
        if max(map(abs, slips)) < limit:
            return slips, course.curvature
        most = largest_force(steady, -drive.moment, tyres, limit)
        if abs(steady) <= abs(most):
            return slips, course.curvature
        self._notes.append((WARN, 'the path asks for more than the grip: running wide'))
        slips = axle_slips(demand._replace(force=most), tyres, limit)
        return slips, (most + drive.across) / pull

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

    def _corrected(
        self, slips: AxleSlips, curvature: float, scene: _Scene, measured: Twist, dt: float
    ) -> AxleSlips:
        """Return the slips with what the feedback adds, within their limit; no integral pushes beyond it."""
        p, limit, speed = self._parameters, scene.limit, scene.course.speed
        expected = course_of(self._expected, measured) or scene.course
        most = abs(curvature)
        turn = min(max(expected.curvature, -most), most) if curvature != scene.course.curvature else expected.curvature
        drift_error = -expected.drift / speed
        yaw_error = (turn - measured.r / speed) * scene.tyres.base

        def total(common: float, difference: float) -> AxleSlips:
            both = p.allocation_gain * drift_error + common
            half = 0.5 * (p.allocation_gain * yaw_error + difference)
            return AxleSlips(slips.leading + both + half, slips.trailing + both - half)

        step = p.allocation_integral_gain * dt
        new = self._common + step * drift_error, self._difference + step * yaw_error
        old = self._common, self._difference
        pairs = zip(total(*new), total(*old), strict=True)
        if any(abs(after) > max(limit, abs(before)) for after, before in pairs):
            new = old
        self._common, self._difference = new
        lead, trail = total(*new)
        return AxleSlips(min(max(lead, -limit), limit), min(max(trail, -limit), limit))

    def _steer(self, slips: AxleSlips, curvature: float, scene: _Scene, lateral_acceleration: float) -> PerWheel:
        """Return the steering trims: slip less roll steer, on the directions of the turn that can be held."""
        told, each = scene.tyres.directions, scene.tyres.slips(slips)
        held, _ = wheel_motion(scene.course.bearing, curvature, self._vehicle)
        roll = self._grip.roll_steer(lateral_acceleration)
        return per_wheel(lambda i: math.remainder(held[i] - told[i], math.tau) + each[i] - roll[i])

    def _drive(self, curvature: float, scene: _Scene, sensed: Sensed, capacities: PerWheel) -> PerWheel:
        """Return the torques of the moment that levels the axles' slips, within the friction circles."""
        course, tyres, drive, limit = scene
        force = self._vehicle.mass * curvature * course.speed**2 - drive.across
        slips = self._last_level = level_slips(force, tyres, limit, _RESERVE * limit, self._last_level)
        side = tyres.side_forces(slips)
        room = per_wheel(lambda i: lateral_capacity(capacities[i], side[i]))
        # What the drives make without the trim: the force along the course, shared equally.
        angle = sensed.steer_angle
        ways = per_wheel(lambda i: math.copysign(0.25, math.cos(angle[i] - tyres.directions[i])))
        present = per_wheel(lambda i: ways[i] * drive.along)
        levers = traction_levers(angle, self._vehicle)
        there = sum(force * lever for force, lever in zip(present, levers, strict=True))
        moment = -tyres.made(slips).moment * _ease(slips, tyres.means(sensed.side_slip), _RESERVE * limit) - there
        added = easiest_moment_forces(moment, angle, course.bearing, room, self._vehicle)
        scale = traction_share(added, present, room) * self._vehicle.wheel_radius
        return per_wheel(lambda i: scale * added[i])


def _ease(expected: AxleSlips, measured: AxleSlips, reserve: float) -> float:
    """Return the share of the moment: down to 0 where the axle that trails slips far more than the other one.

    It does so where the road is more slippery than estimated: the moment would take from it what it does not
    have.
    """
    excess = abs(measured.trailing) - min(abs(measured.leading), reserve)
    return min(max(1.0 - excess / (0.5 * abs(expected.trailing) + _SLIP_NOISE), 0.0), 1.0)
