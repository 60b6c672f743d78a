"""Traction and brake shared among the wheels, along their headings (thesis, sec. 2.10, 3.2.2, 4.3, 4.6).

Wheels are measured by their speed over ground along their heading. ``unit_speeds`` say how fast each of them
rolls, with its sign, for a magnitude of 1 m/s of the commanded motion.
"""

import math
from typing import NamedTuple

from omni_vehicle_ros.parameters import SteeringParameters, VehicleParameters
from omni_vehicle_ros.wheels import PerWheel, per_wheel, scaled

# Rate at which the speed of a wheel that has to stop dies away [1/s]. With the default time constant T of the
# drive, 0.05 s, 4 T rate = 0.8 is below 1: no overshoot, so a brake doesn't drive the vehicle backwards.
STOPPING_RATE = 4.0

# Wheels that all point at the centre of gravity make no yaw moment [m].
_SHORT_LEVER = 0.01

_NO_FORCE: PerWheel = (0.0, 0.0, 0.0, 0.0)


def rolling_signs(unit_speeds: PerWheel) -> PerWheel:
    """Return the rolling directions, +1 or -1, that go smoothly through 0 where the ICR passes a wheel.

    Parameters
    ----------
    unit_speeds
        Wheel speeds per magnitude; the fifth of the largest is where a sign is whole.
    """
    largest = max(map(abs, unit_speeds))
    if largest == 0.0:
        return _NO_FORCE
    fl, fr, rl, rr = scaled(5.0, unit_speeds)
    return clipped((fl / largest, fr / largest, rl / largest, rr / largest), 1.0)


def stopping_forces(largest: PerWheel, speeds: PerWheel, mass: float) -> PerWheel:
    """Return brake forces that oppose each wheel's own motion and never turn it round [N].

    Parameters
    ----------
    largest
        Size of each force while the wheel rolls fast enough [N].
    speeds
        Measured wheel speeds [m/s].
    mass
        Of the vehicle [kg]; close to standstill a wheel slows down at `STOPPING_RATE`, as if it carried a
        quarter.
    """
    gain = 0.25 * mass * STOPPING_RATE
    return per_wheel(lambda i: -math.copysign(min(abs(largest[i]), gain * abs(speeds[i])), speeds[i]))


def traction_levers(steer_angles: PerWheel, vehicle: VehicleParameters) -> PerWheel:
    """Return the yaw moment per force along the heading of each wheel [m].

    Parameters
    ----------
    steer_angles
        [rad].
    vehicle
        Positions of the wheels.
    """
    x, y = vehicle.wheel_x, vehicle.wheel_y
    return per_wheel(lambda i: x[i] * math.sin(steer_angles[i]) - y[i] * math.cos(steer_angles[i]))


class Resultant(NamedTuple):
    """What drive forces make together: force along and to the left of a course [N], and yaw moment [N m]."""

    along: float
    across: float
    moment: float


def resultant(forces: PerWheel, steer_angles: PerWheel, bearing: float, vehicle: VehicleParameters) -> Resultant:
    """Return what forces along the wheels' headings make together.

    Parameters
    ----------
    forces, steer_angles
        [N], [rad].
    bearing
        Of the course, in base_link [rad].
    vehicle
        Positions of the wheels.
    """
    levers = traction_levers(steer_angles, vehicle)
    return Resultant(
        sum(force * math.cos(angle - bearing) for force, angle in zip(forces, steer_angles, strict=True)),
        sum(force * math.sin(angle - bearing) for force, angle in zip(forces, steer_angles, strict=True)),
        sum(force * lever for force, lever in zip(forces, levers, strict=True)),
    )


def axle_moment_forces(moment: float, steer_angles: PerWheel, bearing: float, vehicle: VehicleParameters) -> PerWheel:
    """Return forces along the headings by which each axle makes half of a yaw moment and no traction [N].

    For wheels that point straight ahead: Mz / 2 = T / 2 (right - left) on each axle (thesis eq. 2.10). An
    axle whose wheels have no lever about each other gets none.

    Parameters
    ----------
    moment
        Yaw moment, anticlockwise [N m].
    steer_angles
        [rad].
    bearing
        Along which the forces of an axle cancel, in base_link [rad].
    vehicle
        Positions of the wheels.
    """
    levers = traction_levers(steer_angles, vehicle)
    along = per_wheel(lambda i: math.cos(steer_angles[i] - bearing))

    def pair(left: int, right: int) -> tuple[float, float]:
        arm = along[left] * levers[right] - along[right] * levers[left]
        scale = 0.5 * moment / arm if abs(arm) > _SHORT_LEVER else 0.0
        return -scale * along[right], scale * along[left]

    return *pair(0, 1), *pair(2, 3)


def easiest_moment_forces(
    moment: float, steer_angles: PerWheel, bearing: float, room: PerWheel, vehicle: VehicleParameters
) -> PerWheel:
    """Return the forces along the wheels' headings that make a yaw moment with the least use of friction [N].

    They have no part along the course: minimise sum (F / room)^2 subject to sum F cos = 0 and sum F lever =
    Mz. With Lagrange's multipliers F = room^2 (p lever + q cos).

    Parameters
    ----------
    moment, steer_angles, bearing, vehicle
        As in `axle_moment_forces`.
    room
        What is left of the friction of each tyre [N].
    """
    levers = traction_levers(steer_angles, vehicle)
    along = per_wheel(lambda i: math.cos(steer_angles[i] - bearing))
    weights = per_wheel(lambda i: room[i] * room[i])
    cc = sum(w * c * c for w, c in zip(weights, along, strict=True))
    cl = sum(w * c * lever for w, c, lever in zip(weights, along, levers, strict=True))
    ll = sum(w * lever * lever for w, lever in zip(weights, levers, strict=True))
    determinant = cc * ll - cl * cl
    if determinant <= (_SHORT_LEVER * cc) ** 2:
        return _NO_FORCE
    return per_wheel(lambda i: weights[i] * moment * (cc * levers[i] - cl * along[i]) / determinant)


def moment_forces(moment: float, steer_angles: PerWheel, vehicle: VehicleParameters) -> PerWheel:
    """Return the smallest forces along the wheels' headings that make a yaw moment [N].

    For wheels that point straight ahead: Mz = T / 2 (right - left) on each axle (thesis, 2.10).

    Parameters
    ----------
    moment
        Yaw moment, anticlockwise [N m].
    steer_angles
        [rad].
    vehicle
        Positions of the wheels.
    """
    levers = traction_levers(steer_angles, vehicle)
    square = sum(lever * lever for lever in levers)
    return per_wheel(lambda i: moment * levers[i] / square) if square > _SHORT_LEVER**2 else _NO_FORCE


def traction_forces(
    total: float, unit_speeds: PerWheel, speeds: PerWheel, vehicle: VehicleParameters, steering: SteeringParameters
) -> PerWheel:
    """Share open-loop traction or brake among the wheels (thesis, 2.10 and 3.2.2).

    Parameters
    ----------
    total
        Sum of the traction forces [N]; negative: of the brake forces, each of which opposes its wheel's
        motion.
    unit_speeds
        Wheel speeds per magnitude of the commanded motion.
    speeds
        Measured wheel speeds [m/s].
    vehicle, steering
        Mass; shares of the wheels.

    Returns
    -------
    PerWheel
        Forces along the wheels' headings [N].
    """
    shared = per_wheel(lambda i: total * steering.drive_shares[i])
    if total < 0.0:
        return stopping_forces(shared, speeds, vehicle.mass)
    signs = rolling_signs(unit_speeds)
    return per_wheel(lambda i: shared[i] * signs[i])


def clipped(forces: PerWheel, limit: float) -> PerWheel:
    """Return forces that are all within a limit to either side [N]."""
    fl, fr, rl, rr = forces
    return _clip(fl, limit), _clip(fr, limit), _clip(rl, limit), _clip(rr, limit)


def _clip(force: float, limit: float) -> float:
    return math.copysign(limit, force) if abs(force) > limit else force
