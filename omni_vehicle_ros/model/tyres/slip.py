"""Slip angles and ratios from velocities."""

import math


def side_slip_angle(v_long: float, v_lat: float) -> float:
    """Return the side-slip angle [rad], within +-pi/2, 0 at standstill; folded when rolling backward.

    Parameters
    ----------
    v_long, v_lat
        Velocity of the contact along and across the wheel [m/s].
    """
    return math.atan2(-v_lat, abs(v_long))


def slip_ratio(rim_speed: float, v_long: float) -> float:
    """Return the longitudinal slip (R w - u) / max(abs(R w), abs(u)), within +-2, 0 at standstill (Boada 2005).

    Parameters
    ----------
    rim_speed
        Rolling radius times spin of the wheel [m/s].
    v_long
        Velocity of the contact along the wheel [m/s].
    """
    scale = max(abs(rim_speed), abs(v_long))
    return (rim_speed - v_long) / scale if scale > 0.0 else 0.0
