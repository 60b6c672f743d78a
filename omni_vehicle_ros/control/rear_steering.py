"""Active rear steering for zero body slip (thesis, 2.11; Abe 2009, ch. 8)."""

import math

from omni_vehicle_ros.control.course import Course, CourseController, wheel_motion
from omni_vehicle_ros.control.grip import Grip
from omni_vehicle_ros.control.trim import Sensed, Trims
from omni_vehicle_ros.parameters import SideSlipParameters, VehicleParameters


class RearSteeringController(CourseController):
    """Steers the rear wheels so that the vehicle does not drift from its course; it trims nothing else.

    Without drift the tyres must make ``m v r``. The front ones make what their measured angles give them on a
    vehicle that turns at the measured yaw rate; the rear ones are turned from their own directions of motion
    by the slip that makes the rest, all with linear tyres. For small angles that is Abe's law

        delta_r = -(Kf / Kr) delta_f + (m v / (2 Kr) + (lf Kf - lr Kr) / (Kr v)) r

    with the stiffnesses Kf, Kr of one tyre: the front makes ``2 Kf (delta_f - lf r / v)``, the rear has to
    make ``2 Kr (delta_r + lr r / v)`` = ``m v r`` minus that (thesis eq. 2.11 with beta = 0). In a crab the
    course is the commanded direction. In reverse, where the rear axle leads, zero body slip is unstable
    beyond ``v^2 = 2 K l lf / (m lr)``, so the law fades out from a course of 60 deg off straight ahead on and
    is gone at 90 deg.

    Parameters
    ----------
    parameters, vehicle
        Limits; mass, geometry, tyres and roll.
    """

    doing = 'steering the rear wheels to zero body slip'

    def __init__(self, parameters: SideSlipParameters, vehicle: VehicleParameters) -> None:
        super().__init__(parameters, vehicle)
        self._grip = Grip(vehicle, parameters.friction_estimate)

    def _reset(self) -> None:
        pass

    def _control(self, course: Course, sensed: Sensed, dt: float) -> Trims:
        vehicle, stiffness = self._vehicle, self._vehicle.cornering_stiffness
        roll = self._grip.roll_steer(sensed.lateral_acceleration)
        told, _ = wheel_motion(course.bearing, course.curvature, vehicle)
        moving, _ = wheel_motion(course.bearing, course.yaw_rate / course.speed, vehicle)
        front = sum(
            stiffness * _axis(sensed.steer_angle[i] + roll[i] - moving[i]) * math.cos(moving[i] - course.bearing)
            for i in (0, 1)
        )
        rest = vehicle.mass * course.speed * course.yaw_rate - front
        slip = rest / (stiffness * sum(math.cos(moving[i] - course.bearing) for i in (2, 3)))
        share = min(max(2.0 * math.cos(course.bearing), 0.0), 1.0)
        trim = [share * (_axis(moving[i] - told[i]) + slip - roll[i]) for i in (2, 3)]
        return Trims((0.0, 0.0, trim[0], trim[1]))


def _axis(angle: float) -> float:
    """Return the angle between two wheels' headings, of which forward and backward are the same [rad]."""
    return math.remainder(angle, math.pi)
