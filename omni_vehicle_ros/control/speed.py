"""The central speed controller: one signed magnitude of the motion in, drive forces of the four wheels out.

Wheels are measured as in `omni_vehicle_ros.control.traction`.
"""

import math

from omni_vehicle_ros.control.traction import STOPPING_RATE, clipped, rolling_signs
from omni_vehicle_ros.parameters import SteeringParameters, VehicleParameters
from omni_vehicle_ros.wheels import PerWheel, per_wheel, scaled

# Of the integral part, which has to find what pulls at a standing vehicle [1/s2]: critical damping.
_HOLDING_RATE = STOPPING_RATE**2 / 4.0

# Reference speed from which on the vehicle counts as standing [m/s].
_STOPPED = 0.01

_NO_FORCE: PerWheel = (0.0, 0.0, 0.0, 0.0)
_EQUAL: PerWheel = (0.25, 0.25, 0.25, 0.25)


class SpeedController:
    """PI control with feed-forward: on the mean of the wheels driving, on every single wheel standing.

    Parameters
    ----------
    vehicle, steering
        Mass; gains, shares and the largest force of a wheel.

    Notes
    -----
    Standing, each wheel follows a reference that dies away from its own speed. The integral part begins when
    it has died, and sees only what pulls at a standing vehicle, a slope for instance: it doesn't push one
    back that has just stopped.
    """

    def __init__(self, vehicle: VehicleParameters, steering: SteeringParameters) -> None:
        self._mass = vehicle.mass
        self._steering = steering
        self._integral = 0.0
        self._standing: PerWheel | None = None
        self._reference: PerWheel = _NO_FORCE

    def reset(self) -> None:
        """Forget what the integral parts have learned."""
        self._integral, self._standing = 0.0, None

    def drive(
        self, magnitude: float, measured: float, acceleration: float, unit_speeds: PerWheel, dt: float
    ) -> PerWheel:
        """Return the forces that follow a magnitude.

        Parameters
        ----------
        magnitude, measured
            Commanded and measured magnitude of the motion [m/s].
        acceleration
            Rate of the commanded one [m/s2].
        unit_speeds
            Wheel speeds per magnitude.
        dt
            Time since the last call [s].

        Returns
        -------
        PerWheel
            Forces along the wheels' headings [N].
        """
        signs = rolling_signs(unit_speeds)
        scale = sum(map(abs, unit_speeds)) / 4.0
        if self._standing is not None:
            self._integral = sum(s * f for s, f in zip(signs, self._standing, strict=True)) / self._mass
            self._standing = None
        error, forward = scale * (magnitude - measured), scale * acceleration
        integral = self._integral + self._steering.speed_integral_gain * error * dt
        total = self._mass * (self._steering.speed_gain * error + integral + forward)
        forces = self._share(total, magnitude, signs)
        limit = self._steering.maximum_drive_force
        if max(map(abs, forces)) < limit or error * total < 0.0:
            self._integral = integral
        return clipped(forces, limit)

    def stand(self, speeds: PerWheel, dt: float) -> PerWheel:
        """Return the forces that bring every wheel to rest and keep it there, on a slope too.

        Parameters
        ----------
        speeds
            Measured wheel speeds [m/s].
        dt
            Time since the last call [s].
        """
        if self._standing is None:
            self._standing, self._reference, self._integral = _NO_FORCE, speeds, 0.0
        steps = [self._stop(*wheel, dt) for wheel in zip(self._standing, self._reference, speeds, strict=True)]
        self._standing = per_wheel(lambda i: steps[i][1])
        self._reference = per_wheel(lambda i: steps[i][2])
        return per_wheel(lambda i: steps[i][0])

    def _stop(self, learned: float, reference: float, speed: float, dt: float) -> tuple[float, float, float]:
        """Return the force of one wheel, and what it has learned and its reference for the next cycle."""
        mass, limit = 0.25 * self._mass, self._steering.maximum_drive_force
        slowest = self._steering.acceleration_limit or math.inf
        acceleration = -min(max(STOPPING_RATE * reference, -slowest), slowest)
        error = reference - speed
        force = learned + mass * (acceleration + STOPPING_RATE * error)
        if abs(force) > limit:
            return math.copysign(limit, force), learned, speed
        # While the wheel still slows down, the error is the lag of the drive, which is not for the integral.
        rate = _HOLDING_RATE * error if abs(reference) < _STOPPED else 0.0
        return force, learned + mass * rate * dt, reference + acceleration * dt

    def _share(self, total: float, magnitude: float, signs: PerWheel) -> PerWheel:
        # A brake acts on all wheels, whichever of them drive.
        shares = _EQUAL if total * magnitude < 0.0 else self._steering.drive_shares
        fl, fr, rl, rr = scaled(total, shares)
        return fl * signs[0], fr * signs[1], rl * signs[2], rr * signs[3]

