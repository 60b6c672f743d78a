"""Steering about an instantaneous centre of rotation (ICR), the thesis's virtual linkage (sec. 2.4).

A motion is a body twist (vx, vy, r): straight on and crab are twists with r = 0 like any other. Every wheel
points along the velocity of its own contact, r x (p - ICR).
"""

import math
from typing import Literal, NamedTuple

from omni_vehicle_ros.errors import CommandError
from omni_vehicle_ros.parameters import VehicleParameters
from omni_vehicle_ros.wheels import PerWheel, per_wheel

SMALLEST_RADIUS = 1e-6  # m
ROUNDING = 1e-9  # rad, by which a limit may be missed
RESTING = 1e-6  # of the fastest wheel: a wheel slower than this has no direction of its own


class Twist(NamedTuple):
    """Motion of the centre of gravity in base_link: forward, leftward [m/s], anticlockwise [rad/s]."""

    vx: float
    vy: float
    r: float


class Icr(NamedTuple):
    """Instantaneous centre of rotation in base_link: ahead and to the left of the centre of gravity [m]."""

    x: float
    y: float


class Steering(NamedTuple):
    """Steer angles [rad], signed wheel speeds over ground [m/s], and which wheels can do it; fl, fr, rl, rr.

    A wheel that can't keeps its reference angle with speed 0.
    """

    angles: PerWheel
    speeds: PerWheel
    reachable: tuple[bool, bool, bool, bool]


def twist_of_icr(icr: Icr, speed: float, straight_radius: float = math.inf) -> Twist:
    """Return the motion about an ICR at a speed of the centre of gravity.

    Parameters
    ----------
    icr
        Centre of rotation [m], not infinite. A centre to the left (y >= 0) means anticlockwise, one to the right
        (y < 0) clockwise rotation, so that a positive speed never has a backward part.
    speed
        Speed of the centre of gravity [m/s]; negative reverses the motion.
    straight_radius
        A centre farther away than this means no rotation: straight on, or crab across its bearing [m].

    Raises
    ------
    CommandError
        The ICR is not finite, or lies in the centre of gravity, which then has no speed.
    """
    radius = math.hypot(icr.x, icr.y)
    if not math.isfinite(radius):
        raise CommandError(
            f'icr: ({icr.x!r}, {icr.y!r}) m must be finite; put it beyond {straight_radius:g} m to go straight'
        )
    if radius < SMALLEST_RADIUS:
        raise CommandError(
            f'icr: ({icr.x!r}, {icr.y!r}) m is within {SMALLEST_RADIUS:g} m of the centre of gravity, which does not '
            'move then; command a twist to turn on the spot'
        )
    scale = speed / radius if icr.y >= 0.0 else -speed / radius
    return Twist(scale * icr.y, -scale * icr.x, scale if radius <= straight_radius else 0.0)


def wheel_velocities(twist: Twist, parameters: VehicleParameters) -> tuple[tuple[float, float], ...]:
    """Return the velocity (forward, leftward) of every wheel's contact in base_link [m/s]; fl, fr, rl, rr."""
    (vx, vy, r), xs, ys = twist, parameters.wheel_x, parameters.wheel_y
    return (
        (vx - ys[0] * r, vy + xs[0] * r),
        (vx - ys[1] * r, vy + xs[1] * r),
        (vx - ys[2] * r, vy + xs[2] * r),
        (vx - ys[3] * r, vy + xs[3] * r),
    )


def road_steer_angles(icr: Icr, parameters: VehicleParameters) -> PerWheel:
    """Return the steer angles about an ICR by the thesis's road rule [rad].

    delta = atan2(D (x - xc), D (yc - y)), D = +1 for an ICR to the left, -1 to the right (thesis sec. 2.4);
    within +-pi/2 as long as the ICR lies outside the track.
    """
    xs, ys = parameters.wheel_x, parameters.wheel_y
    side = 1.0 if icr.y >= 0.0 else -1.0
    return per_wheel(lambda i: math.atan2(side * (xs[i] - icr.x), side * (icr.y - ys[i])))


def steer_angles(
    twist: Twist,
    reference_angles: PerWheel,
    limit: float,
    parameters: VehicleParameters,
    rule: Literal['road', 'omni'] = 'omni',
) -> Steering:
    """Return steer angles and wheel speeds that make a motion.

    A wheel can roll forward, or turn by 180 deg less and roll backward. Whichever angle is nearer to the
    reference wins. With the last set-points as reference this is a hysteresis: a wheel stays with its choice
    until its limit, and noise across 90 deg does not make it flip. A wheel that hardly moves (the ICR is under
    it, or the vehicle stands) keeps its reference angle.

    Parameters
    ----------
    twist
        Motion of the centre of gravity.
    reference_angles
        Angles to stay near to [rad]: the last set-points, or the measured angles at the start.
    limit
        Largest steer angle to either side [rad].
    parameters
        The vehicle.
    rule
        'omni' as above; 'road': within 90 deg, all wheels forward, or all backward when the vehicle reverses.

    Returns
    -------
    Steering
        Wheels that have no angle within the limit are marked as not reachable.
    """
    velocities = wheel_velocities(twist, parameters)
    speeds = [math.hypot(ahead, left) for ahead, left in velocities]
    slowest = RESTING * max(speeds)
    if rule == 'road':
        limit = min(limit, 0.5 * math.pi)
    # The road rule fixes the direction of rolling by that of the vehicle.
    directions = (1.0, -1.0) if rule == 'omni' else (-1.0 if twist.vx < 0.0 else 1.0,)
    choices = [
        (reference, 0.0, True) if speed <= slowest else _steer_wheel(velocity, speed, reference, limit, directions)
        for velocity, speed, reference in zip(velocities, speeds, reference_angles, strict=True)
    ]
    fl, fr, rl, rr = choices
    return Steering((fl[0], fr[0], rl[0], rr[0]), (fl[1], fr[1], rl[1], rr[1]), (fl[2], fr[2], rl[2], rr[2]))


def _steer_wheel(
    velocity: tuple[float, float], speed: float, reference: float, limit: float, directions: tuple[float, ...]
) -> tuple[float, float, bool]:
    ahead, left = velocity
    best: tuple[float, float, bool] | None = None
    for direction in directions:
        angle = math.atan2(direction * left, direction * ahead)
        if abs(angle) > limit + ROUNDING:
            continue
        if not -limit <= angle <= limit:
            angle = max(-limit, min(limit, angle))
        if best is None or abs(angle - reference) < abs(best[0] - reference):
            best = angle, direction * speed, True
    return best or (reference, 0.0, False)
