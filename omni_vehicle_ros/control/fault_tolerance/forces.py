"""Drive forces when a drive does not do what it is told: the others make up for it."""

from typing import NamedTuple

from omni_vehicle_ros.control.traction import clipped, traction_levers
from omni_vehicle_ros.parameters import VehicleParameters
from omni_vehicle_ros.wheels import PerWheel, per_wheel

# The push and the yaw moment of the wheels are one thing below this sine of their angle, as in a spin in place.
_ALIKE = 0.05


class Failed(NamedTuple):
    """Which drives don't do what they are told, and the forces that all of them make along their headings [N]."""

    wheels: tuple[bool, bool, bool, bool]
    forces: PerWheel


class Wheels(NamedTuple):
    """How the wheels roll: speeds per magnitude of the motion, and steer angles [rad]."""

    unit_speeds: PerWheel
    steer_angles: PerWheel


def made_up(wanted: PerWheel, failed: Failed, wheels: Wheels, limit: float, vehicle: VehicleParameters) -> PerWheel:
    """Return forces with which the sound wheels make up for failed ones, which stay as wanted.

    What the failed drives lack is shared out so that all wheels together push the vehicle along its motion (the sum
    of force times wheel speed) and turn it (the yaw moment) as wanted. Of all forces that do so, those with the least
    use of friction by the static loads are taken: minimise sum (F / load)^2, with Lagrange's multipliers ``F =
    load^2 (p speed + q lever)``. Where a sound wheel would be beyond the limit, all that is wanted is scaled down
    until it is not: less push, but no yaw moment that nobody wants.

    Parameters
    ----------
    wanted
        Forces along the headings [N].
    failed
        Which wheels fail, and what they make.
    wheels
        How they roll.
    limit
        Largest force of a wheel [N].
    vehicle
        Places of the wheels, loads.
    """
    basis = _Basis.of(failed, wheels, vehicle)
    lack = basis.least(per_wheel(lambda i: wanted[i] if failed.wheels[i] else 0.0))
    made = basis.least(per_wheel(lambda i: failed.forces[i] if failed.wheels[i] else 0.0))
    whole = per_wheel(lambda i: wanted[i] + lack[i])
    sound = [i for i in range(4) if not failed.wheels[i]]
    share = min((_share(whole[i], -made[i], limit) for i in sound), default=1.0)
    forces = per_wheel(lambda i: wanted[i] if failed.wheels[i] else share * whole[i] - made[i])
    return clipped(forces, limit)


class _Basis(NamedTuple):
    """The least forces of the sound wheels that make what given forces of the failed ones would."""

    weights: PerWheel
    speeds: PerWheel
    levers: PerWheel

    @classmethod
    def of(cls, failed: Failed, wheels: Wheels, vehicle: VehicleParameters) -> '_Basis':
        front, rear = vehicle.cg_to_rear_axle / vehicle.wheelbase, vehicle.cg_to_front_axle / vehicle.wheelbase
        loads = front, front, rear, rear
        weights = per_wheel(lambda i: 0.0 if failed.wheels[i] else loads[i] ** 2)
        return cls(weights, wheels.unit_speeds, traction_levers(wheels.steer_angles, vehicle))

    def least(self, forces: PerWheel) -> PerWheel:
        weights, speeds, levers = self
        ss = sum(w * s * s for w, s in zip(weights, speeds, strict=True))
        sl = sum(w * s * lever for w, s, lever in zip(weights, speeds, levers, strict=True))
        ll = sum(w * lever * lever for w, lever in zip(weights, levers, strict=True))
        power = sum(f * s for f, s in zip(forces, speeds, strict=True))
        moment = sum(f * lever for f, lever in zip(forces, levers, strict=True))
        determinant = ss * ll - sl * sl
        p, q = power / ss if ss > 0.0 else 0.0, 0.0
        if determinant > _ALIKE**2 * ss * ll:
            p, q = (ll * power - sl * moment) / determinant, (ss * moment - sl * power) / determinant
        return per_wheel(lambda i: weights[i] * (p * speeds[i] + q * levers[i]))


def _share(force: float, beside: float, limit: float) -> float:
    """Return the largest share of a force, up to 1, that stays within the limit beside another one."""
    if abs(force + beside) <= limit:
        return 1.0
    room = limit - beside if force > 0.0 else limit + beside
    return max(room, 0.0) / abs(force) if force else 1.0
