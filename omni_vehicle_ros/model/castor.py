"""A wheel that nothing steers: it trails behind its steering axis."""

import math


def castored(angle: float, velocity: tuple[float, float], trail: float, time: float) -> float:
    """Return the steer angle of a free-castering wheel after a while.

    Its contact follows the steering axis at the distance of the trail t without sliding, so that the angle e
    between wheel and velocity v falls by de/dt = -(v / t) sin(e), which tan(e / 2) solves exactly. The yaw of
    the vehicle meanwhile, an angle of t over the radius of the turn, is left out.

    Parameters
    ----------
    angle
        Steer angle [rad].
    velocity
        Of the steering axis over ground, ahead and to the left, held [m/s].
    trail
        Of the contact behind the axis, above 0 [m].
    time
        How long [s].
    """
    along, across = velocity
    speed = math.hypot(along, across)
    if speed == 0.0:
        return angle
    off = math.remainder(angle - math.atan2(across, along), math.tau)
    left = 2.0 * math.atan(math.tan(0.5 * off) * math.exp(-speed * time / trail))
    return angle - off + left
