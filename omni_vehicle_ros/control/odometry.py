"""The motion of the vehicle as its wheels tell it: steer angles and wheel speeds, nothing else.

Every wheel measures the part of its velocity along its heading, v = (vx - y r) cos delta + (vy + x r) sin delta.
Four of them tell the three numbers of the motion, side slip or not, unless they are parallel: then what lies across
them can't be seen, and the commanded motion stands in.
"""

import math

from omni_vehicle_ros.control.motion import Motion, length_scale
from omni_vehicle_ros.model.kinematics import Twist, wheel_velocities
from omni_vehicle_ros.parameters import VehicleParameters
from omni_vehicle_ros.wheels import PerWheel, per_wheel

# Weight of the command beside one wheel. Of what lies across the wheels little is seen by those that are turned
# little; without this weight, one wheel that runs unlike the others would be taken for a motion several times as
# fast.
_PRIOR = 0.05

# Keeps the equations regular where all wheels stand across the commanded motion.
_REGULAR = 1e-6

# Weight of the yaw rate in the speed of a motion that is not a spin in place: a path that is not quite the
# commanded one is no other speed.
_YAW = 0.05


def measured_twist(
    speeds: PerWheel,
    steer_angles: PerWheel,
    motion: Motion,
    vehicle: VehicleParameters,
    weights: PerWheel = (1.0, 1.0, 1.0, 1.0),
) -> Twist:
    """Return the motion that fits the wheels best, by least squares.

    Parameters
    ----------
    speeds
        Measured speeds of the wheels over ground along their headings [m/s].
    steer_angles
        Measured [rad].
    motion
        Direction of the commanded motion.
    vehicle
        Positions of the wheels.
    weights
        How much each wheel counts; 0 for one that does not roll.
    """
    length = length_scale(vehicle)
    (ux, uy, ur), plain = motion, _PRIOR + _REGULAR
    xx, yy, rr = plain - _PRIOR * ux * ux, plain - _PRIOR * uy * uy, plain - _PRIOR * ur * ur
    xy, xr, yr = -_PRIOR * ux * uy, -_PRIOR * ux * ur, -_PRIOR * uy * ur
    bx = by = br = 0.0
    places = vehicle.wheel_x, vehicle.wheel_y
    for speed, angle, weight, x, y in zip(speeds, steer_angles, weights, *places, strict=True):
        cos, sin = math.cos(angle), math.sin(angle)
        arm = (x * sin - y * cos) / length
        c, s, a = weight * cos, weight * sin, weight * arm
        xx, yy, rr = xx + c * cos, yy + s * sin, rr + a * arm
        xy, xr, yr = xy + c * sin, xr + c * arm, yr + s * arm
        bx, by, br = bx + c * speed, by + s * speed, br + a * speed
    # The inverse of a symmetric matrix by its cofactors.
    cx, cy, cr = yy * rr - yr * yr, xr * yr - xy * rr, xy * yr - xr * yy
    dy, dr, er = xx * rr - xr * xr, xy * xr - xx * yr, xx * yy - xy * xy
    determinant = xx * cx + xy * cy + xr * cr
    return Twist(
        (cx * bx + cy * by + cr * br) / determinant,
        (cy * bx + dy * by + dr * br) / determinant,
        (cr * bx + dr * by + er * br) / determinant / length,
    )


def rolling_twist(speeds: PerWheel, steer_angles: PerWheel, vehicle: VehicleParameters, weights: PerWheel) -> Twist:
    """Return the motion that fits wheels best that roll where they point, by least squares.

    Wheels that are nearly parallel tell little of what lies across them by their speeds. That they slip little to the
    side, a few hundredths of a radian, tells more.

    Parameters
    ----------
    speeds
        Measured speeds of the wheels over ground along their headings [m/s].
    steer_angles
        Measured [rad].
    vehicle
        Positions of the wheels.
    weights
        How much each wheel counts; two or more have to.
    """
    # The velocity of a wheel is its speed along its heading: (vx - y r, vy + x r). Both parts count alike, so that
    # the sums have no angles in them but in the velocities.
    x, y = vehicle.wheel_x, vehicle.wheel_y
    ahead = per_wheel(lambda i: speeds[i] * math.cos(steer_angles[i]))
    left = per_wheel(lambda i: speeds[i] * math.sin(steer_angles[i]))

    def mean(numbers: PerWheel) -> float:
        return sum(w * number for w, number in zip(weights, numbers, strict=True)) / sum(weights)

    mx, my, vx, vy = mean(x), mean(y), mean(ahead), mean(left)
    square = mean(per_wheel(lambda i: (x[i] - mx) ** 2 + (y[i] - my) ** 2))
    r = mean(per_wheel(lambda i: (x[i] - mx) * left[i] - (y[i] - my) * ahead[i])) / square
    return Twist(vx + my * r, vy - mx * r, r)


def magnitude_along(twist: Twist, motion: Motion, vehicle: VehicleParameters) -> float:
    """Return the signed magnitude of a commanded motion at which the vehicle is as fast as it is [m/s].

    Parameters
    ----------
    twist
        Of the vehicle.
    motion
        The commanded direction.
    vehicle
        Its wheelbase.
    """
    ux, uy, ur = motion
    along = ux * twist.vx + uy * twist.vy + _YAW * ur * twist.r * length_scale(vehicle)
    return along / (ux * ux + uy * uy + _YAW * ur * ur)


def sideways_speed(twist: Twist, steer_angles: PerWheel, vehicle: VehicleParameters) -> tuple[float, float]:
    """Return how fast the wheels move across their headings, and along them, in the mean [m/s].

    Parameters
    ----------
    twist
        Of the vehicle.
    steer_angles
        [rad].
    vehicle
        Positions of the wheels.
    """
    across = along = 0.0
    for angle, (ahead, left) in zip(steer_angles, wheel_velocities(twist, vehicle), strict=True):
        cos, sin = math.cos(angle), math.sin(angle)
        across += abs(left * cos - ahead * sin)
        along += abs(ahead * cos + left * sin)
    return 0.25 * across, 0.25 * along
