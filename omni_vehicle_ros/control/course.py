"""The course: where the vehicle is told to go, and how it moves beside that.

A commanded motion (vx, vy, r) is a path: its direction in base_link and its curvature r / v. The speed along
it is the measured one, so that a vehicle slower than its command still turns on the commanded path. Crab and
reverse are courses like any other; a spin in place and standstill are none.
"""

import math
from abc import ABC, abstractmethod
from typing import NamedTuple

from omni_vehicle_ros.control.friction_check import FrictionCheck
from omni_vehicle_ros.control.health import ERROR, Health, health
from omni_vehicle_ros.control.trim import NO_TRIMS, Cycles, Sensed, Trims, fade
from omni_vehicle_ros.model.kinematics import Twist
from omni_vehicle_ros.parameters import SideSlipParameters, VehicleParameters
from omni_vehicle_ros.wheels import PerWheel, per_wheel

# A command slower than this says nothing about a direction [m/s].
_NO_COURSE = 1e-3


class Course(NamedTuple):
    """A commanded path and the measured motion on it.

    Attributes
    ----------
    bearing
        Direction of the commanded velocity in base_link [rad].
    curvature
        Commanded yaw rate per speed, anticlockwise [1/m].
    speed, drift
        Measured velocity of the centre of gravity along the bearing and to the left of it [m/s].
    yaw_rate
        Measured [rad/s].
    """

    bearing: float
    curvature: float
    speed: float
    drift: float
    yaw_rate: float


def course_of(commanded: Twist, measured: Twist) -> Course | None:
    """Return the course of a commanded motion; None at standstill and for a spin in place.

    Parameters
    ----------
    commanded, measured
        Motion that the set-points belong to, and that of the vehicle.
    """
    speed = math.hypot(commanded.vx, commanded.vy)
    if speed < _NO_COURSE:
        return None
    ahead, left = commanded.vx / speed, commanded.vy / speed
    return Course(
        math.atan2(left, ahead),
        commanded.r / speed,
        measured.vx * ahead + measured.vy * left,
        measured.vy * ahead - measured.vx * left,
        measured.r,
    )


def wheel_motion(bearing: float, curvature: float, vehicle: VehicleParameters) -> tuple[PerWheel, PerWheel]:
    """Return in which direction every wheel moves in base_link [rad], and its speed per speed of the vehicle.

    Parameters
    ----------
    bearing, curvature
        Of the course [rad, 1/m].
    vehicle
        Positions of the wheels.
    """
    ahead, left = math.cos(bearing), math.sin(bearing)
    x, y = vehicle.wheel_x, vehicle.wheel_y
    along, across = per_wheel(lambda i: ahead - y[i] * curvature), per_wheel(lambda i: left + x[i] * curvature)
    return per_wheel(lambda i: math.atan2(across[i], along[i])), per_wheel(lambda i: math.hypot(across[i], along[i]))


class CourseController(ABC):
    """A controller of the motion on a course; without a course, or too slow for one, it doesn't trim.

    Parameters
    ----------
    parameters, vehicle
        Gains and limits; what is controlled.
    """

    doing = ''

    def __init__(self, parameters: SideSlipParameters, vehicle: VehicleParameters) -> None:
        self._parameters, self._vehicle = parameters, vehicle
        self._cycles = Cycles()
        self._friction_check = FrictionCheck(parameters, vehicle)
        self._trims = NO_TRIMS
        self._notes: list[tuple[int, str]] = []
        self._reset()

    def update(self, stamp: int, sensed: Sensed) -> Trims:
        """Return the trims of a cycle; see `Controller.update`."""
        dt = self._cycles.next(stamp)
        if dt is None:
            return self._trims
        self._notes = []
        if not sensed.usable:
            self._notes.append((ERROR, 'what is measured or commanded is not finite: the last trims hold'))
            return self._trims
        self._notes += self._friction_check.update(sensed, dt)
        course = course_of(sensed.commanded, sensed.twist)
        share = 0.0 if course is None else fade(max(course.speed, 0.0), self._parameters.minimum_speed)
        if dt == 0.0 or share == 0.0:
            self._reset()
        self._trims = NO_TRIMS
        if course is not None and share > 0.0:
            steer_angle, torque = self._control(course, sensed, dt)
            limit = share * self._parameters.trim_limit
            self._trims = Trims(
                per_wheel(lambda i: min(max(share * steer_angle[i], -limit), limit)),
                per_wheel(lambda i: share * torque[i]),
            )
        return self._trims

    @property
    def status(self) -> Health:
        """How the controller is doing, as of the last update."""
        return health(self._notes, self.doing)

    @abstractmethod
    def _reset(self) -> None:
        """Forget the past."""

    @abstractmethod
    def _control(self, course: Course, sensed: Sensed, dt: float) -> Trims:
        """Return the whole trims of a vehicle on its course; ``dt`` [s] is 0 in the first cycle."""
