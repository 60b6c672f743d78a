"""The direction of a rigid motion in the plane, in which straight, crab and spin are nothing special.

The twist (vx, vy, r) of the body is a signed magnitude [m/s] times a unit vector in (vx, vy, r L), L being
half the wheelbase. Straight on is (1, 0, 0), crab to the left (0, 1, 0), spin to the left (0, 0, 1); the ICR
lies at (-uy, ux) L / ur, and at infinity for ur = 0. Reverse is the same direction with a negative magnitude.
Turning one direction into another passes through directions only, each of them a rigid motion: the four
wheels always agree on one ICR.
"""

import math
from typing import NamedTuple

from omni_vehicle_ros.errors import CommandError
from omni_vehicle_ros.model.kinematics import Twist
from omni_vehicle_ros.parameters import VehicleParameters

# Nearer to the centre of gravity than this, a speed of the centre of gravity says nothing about the yaw rate.
MINIMUM_ICR_DISTANCE = 0.01

# Share of the speed of the centre of gravity in a motion below which it is much like a spin in place.
_NEARLY_SPIN = 0.3

# cos of the angle past which the opposite direction, backwards, is the closer way: wide of 90 deg, so that a
# change from left to right passes through straight on and not through a spin.
_REVERSE = -math.sqrt(0.5)


class Motion(NamedTuple):
    """A unit vector: shares of forward speed, leftward speed and yaw rate times L."""

    ux: float
    uy: float
    ur: float


STRAIGHT = Motion(1.0, 0.0, 0.0)


def length_scale(vehicle: VehicleParameters) -> float:
    """Return L, half the wheelbase [m]: it makes a yaw rate comparable to a speed."""
    return 0.5 * vehicle.wheelbase


def motion_of_icr(x: float, y: float, length: float, straight_radius: float) -> Motion:
    """Return the direction that turns about an ICR, facing forward.

    Parameters
    ----------
    x, y
        ICR in base_link [m].
    length
        L [m].
    straight_radius
        An ICR farther away than this is at infinity: straight on if it lies across, else crab across its
        bearing.

    Raises
    ------
    CommandError
        The ICR is at the centre of gravity, where a speed of the centre of gravity has no meaning.
    """
    distance = math.hypot(x, y)
    if distance < MINIMUM_ICR_DISTANCE:
        raise CommandError(
            f'ICR ({x:g}, {y:g}) m is nearer than {MINIMUM_ICR_DISTANCE:g} m to the centre of gravity, whose speed is '
            'then 0: use cmd_vel to spin in place'
        )
    turn = math.copysign(1.0, y) if y else 1.0
    if distance > straight_radius:
        return Motion(turn * y / distance, -turn * x / distance, 0.0)
    return unit_motion(turn * y, -turn * x, turn * length)


def motion_of_twist(vx: float, vy: float, yaw_rate: float, length: float) -> tuple[Motion, float] | None:
    """Return direction, facing forward, and signed magnitude [m/s] of a twist; None for no twist at all.

    The magnitude of a twist beyond the range of floats is inf.

    Parameters
    ----------
    vx, vy, yaw_rate
        Twist at the centre of gravity [m/s, m/s, rad/s], finite.
    length
        L [m].
    """
    yaw = yaw_rate * length if abs(yaw_rate) < 1e300 else math.copysign(1e300, yaw_rate)
    largest = max(abs(vx), abs(vy), abs(yaw))
    if largest == 0.0:
        return None
    ux, uy, ur = vx / largest, vy / largest, yaw / largest
    sign = math.copysign(1.0, ux or uy or ur)
    return unit_motion(sign * ux, sign * uy, sign * ur), sign * largest * math.sqrt(ux * ux + uy * uy + ur * ur)


def twist_of_motion(motion: Motion, magnitude: float, length: float) -> Twist:
    """Return the twist of a direction with a signed magnitude [m/s]; ``length`` is L [m]."""
    return Twist(magnitude * motion.ux, magnitude * motion.uy, magnitude * motion.ur / length)


def magnitude_of_speed(motion: Motion, speed: float) -> float:
    """Return the magnitude that gives the centre of gravity a signed speed [m/s]; not for a spin in place."""
    return speed / math.hypot(motion.ux, motion.uy)


def magnitude_on_the_way(magnitude: float, motion: Motion, target: Motion) -> float:
    """Return the magnitude that already gives the centre of gravity the speed that it will have [m/s].

    Parameters
    ----------
    magnitude
        That goes with the target [m/s].
    motion, target
        The direction on the way, and the one that it turns towards. Of a spin in place, which has no such
        speed, and for one that is far from the target, the magnitude stays near that of the target.
    """
    there = max(math.hypot(target.ux, target.uy), _NEARLY_SPIN)
    return magnitude * there / max(math.hypot(motion.ux, motion.uy), _NEARLY_SPIN, 0.8 * there)


def nearest(motion: Motion, reference: Motion) -> float:
    """Return 1, or -1 if ``motion`` is so far from ``reference`` that driving it backwards is closer.

    The answer stays the same while the reference turns towards the one that was chosen.
    """
    return -1.0 if _dot(motion, reference) < _REVERSE else 1.0


def angle_between(motion: Motion, other: Motion) -> float:
    """Return the angle between two directions [rad]."""
    return math.acos(min(max(_dot(motion, other), -1.0), 1.0))


def opposite(motion: Motion) -> Motion:
    """Return the direction backwards."""
    return Motion(-motion.ux, -motion.uy, -motion.ur)


def turn_towards(motion: Motion, target: Motion, angle: float) -> Motion:
    """Turn a direction along the great circle towards another one.

    Parameters
    ----------
    motion, target
        From where and whereto.
    angle
        Largest turn [rad]; ``math.inf`` for all of it.
    """
    cosine = _dot(motion, target)
    ax, ay, ar = target.ux - cosine * motion.ux, target.uy - cosine * motion.uy, target.ur - cosine * motion.ur
    sine = math.sqrt(ax * ax + ay * ay + ar * ar)
    if math.atan2(sine, cosine) <= angle:
        return target
    if sine < 1e-9:
        # Exactly opposite: every way is as long, the one past spin or straight on is as good as any.
        ax, ay, ar = (0.0, 0.0, 1.0) if abs(motion.ur) < 0.5 else (1.0, 0.0, 0.0)
        along = ax * motion.ux + ay * motion.uy + ar * motion.ur
        ax, ay, ar = ax - along * motion.ux, ay - along * motion.uy, ar - along * motion.ur
        sine = math.sqrt(ax * ax + ay * ay + ar * ar)
    c, s = math.cos(angle), math.sin(angle) / sine
    return unit_motion(c * motion.ux + s * ax, c * motion.uy + s * ay, c * motion.ur + s * ar)


def _dot(a: Motion, b: Motion) -> float:
    return a.ux * b.ux + a.uy * b.uy + a.ur * b.ur


def unit_motion(x: float, y: float, z: float) -> Motion:
    """Return the direction of a vector in (vx, vy, r L) that is not 0."""
    norm = math.sqrt(x * x + y * y + z * z)
    return Motion(x / norm, y / norm, z / norm)
