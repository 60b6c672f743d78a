"""Direct yaw moment control: more traction on one side than on the other (thesis, 2.9 and 2.10)."""

import math

from omni_vehicle_ros.control.course import Course, CourseController
from omni_vehicle_ros.control.grip import Grip
from omni_vehicle_ros.control.health import WARN
from omni_vehicle_ros.control.pid import Pid
from omni_vehicle_ros.control.traction import axle_moment_forces, resultant
from omni_vehicle_ros.control.trim import NO_WHEEL, Sensed, Trims
from omni_vehicle_ros.model.tyres.friction_circle import lateral_capacity
from omni_vehicle_ros.parameters import SideSlipParameters, VehicleParameters
from omni_vehicle_ros.wheels import PerWheel, per_wheel


class YawMomentController(CourseController):
    """A PID law from the error of the yaw rate to a yaw moment; it trims no steer angle.

    Its reference is the yaw rate of the commanded motion at the measured speed, behind a lag, divided by ``1
    + A v^2`` with the stability factor A: that of a car that understeers as drivers expect. Each axle makes
    half of the moment (thesis eq. 2.10, with the levers that turned wheels have), as far as the friction
    circle of every one of its tyres allows: the side force is reckoned from the measured slip, the load from
    the measured lateral acceleration. For how large the gains may be see
    `omni_vehicle_ros.control.gain_margin`.

    Parameters
    ----------
    parameters
        Gains and friction estimate.
    vehicle
        Stability factor, geometry, tyres.
    """

    doing = 'controlling the yaw rate by traction'

    def __init__(self, parameters: SideSlipParameters, vehicle: VehicleParameters) -> None:
        p = parameters
        gains = p.yaw_gain, p.yaw_integral_gain, p.yaw_derivative_gain
        self._pid = Pid(*gains, p.derivative_time_constant, math.inf)
        self._grip = Grip(vehicle, p.friction_estimate)
        super().__init__(parameters, vehicle)

    def _reset(self) -> None:
        self._pid.reset()
        self._curvature: float | None = None

    def _control(self, course: Course, sensed: Sensed, dt: float) -> Trims:
        vehicle, speed = self._vehicle, course.speed
        reference = self._expected_curvature(course, dt) * speed / (1.0 + vehicle.stability_factor * speed * speed)
        unit = axle_moment_forces(1.0, sensed.steer_angle, course.bearing, vehicle)
        room, present = self._room(sensed), self._present(course, sensed)
        # Beyond this moment no tyre could carry more.
        reach = [(room[i] + abs(present[i])) / abs(unit[i]) for i in range(4) if unit[i] != 0.0]
        self._pid.limit = max(reach, default=0.0)
        moment = self._pid.update(reference - course.yaw_rate, dt)
        if self._pid.saturated:
            self._notes.append((WARN, 'the yaw moment is at what the friction circles leave of traction'))
        low = per_wheel(lambda i: min(-room[i] - present[i], 0.0))
        high = per_wheel(lambda i: max(room[i] - present[i], 0.0))
        added = per_wheel(lambda i: min(max(moment * unit[i], low[i]), high[i]))
        return Trims(NO_WHEEL, per_wheel(lambda i: vehicle.wheel_radius * added[i]))

    def _expected_curvature(self, course: Course, dt: float) -> float:
        """Return the commanded curvature behind the lag that the steering has [1/m]."""
        before = course.curvature if self._curvature is None else self._curvature
        gain = 1.0 - math.exp(-dt / self._parameters.reference_time_constant)
        self._curvature = before + gain * (course.curvature - before)
        return self._curvature

    def _room(self, sensed: Sensed) -> PerWheel:
        """Return the largest force along the heading that each tyre can carry beside its side force [N]."""
        grip, slip, speed = self._grip, sensed.side_slip, sensed.wheel_speed
        capacities = grip.capacities(sensed.lateral_acceleration)
        side = per_wheel(lambda i: grip.side_force(slip[i], abs(speed[i]), capacities[i]))
        return per_wheel(lambda i: lateral_capacity(capacities[i], side[i]))

    def _present(self, course: Course, sensed: Sensed) -> PerWheel:
        """Return what the drives make without the trim: the force along the course, shared equally [N]."""
        forces = per_wheel(lambda i: sensed.drive_torque[i] / self._vehicle.wheel_radius)
        share = 0.25 * resultant(forces, sensed.steer_angle, course.bearing, self._vehicle).along
        return per_wheel(lambda i: math.copysign(share, share * math.cos(sensed.steer_angle[i] - course.bearing)))
