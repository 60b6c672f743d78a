"""Dugoff's tyre: side force, its critical slips, and the combined slip of a spinning wheel (thesis sec. 2.5).

The adhesion reduction factor belongs to this tyre: the faster it slides, the less the road gives.
"""

import math

from omni_vehicle_ros.model.lanes import select
from omni_vehicle_ros.model.tyres.slip import slip_ratio

FULL_STRETCH = 2.0  # slip, in units of grip over stiffness, at 7/8 of the grip: lambda = 1/4


def grip(capacity: float, v_lat: float, adhesion_reduction: float) -> float:
    """Return what the road still gives a tyre that slides sideways [N], never below 0 (thesis eq. B.2).

    The bracket 1 - eps_r v abs(tan alpha) is written as 1 - eps_r abs(v_lat), finite at every slip angle. So v is
    the speed of the contact along the heading of its own wheel, not the forward speed vx of the body, as one may
    read the thesis: of a wheel that is turned it is another one.

    Parameters
    ----------
    capacity
        Friction coefficient times vertical load, or what the friction circle leaves of it [N].
    v_lat
        Velocity of the contact across the wheel [m/s].
    adhesion_reduction
        Road adhesion reduction factor eps_r [s/m].
    """
    return capacity * max(0.0, 1.0 - adhesion_reduction * abs(v_lat))


def dugoff(numerator: float, denominator: float, grip: float, stiffness: float) -> float:
    """Return the side force of a tyre whose slip is tan(alpha) = numerator / denominator (thesis eq. B.1-B.3).

    Parameters
    ----------
    numerator, denominator
        Any two numbers in the proportion of tan(alpha); denominator >= 0, and 0 stands for 90 deg.
    grip
        Largest force that the road gives now [N], >= 0; see `grip`.
    stiffness
        Cornering stiffness of the tyre [N/rad].

    Returns
    -------
    float
        Side force [N], at most ``grip`` in size; 0 if both numerator and denominator are.
    """
    available = grip * denominator
    needed = 2.0 * stiffness * abs(numerator)
    linear = available >= needed
    # One division for both sides: of C tan(alpha), and of half of lambda = available / needed.
    divisor = select(linear, denominator, needed)
    quotient = select(linear, stiffness * numerator, 0.5 * available) / select(divisor > 0.0, divisor, 1.0)
    return select(linear, quotient, math.copysign(grip * (1.0 - quotient), numerator))


def lateral_force(
    v_long: float, v_lat: float, capacity: float, stiffness: float, adhesion_reduction: float
) -> float:
    """Return the side force of a rolling tyre [N] (thesis eq. B.1-B.3).

    Parameters
    ----------
    v_long, v_lat
        Velocity of the contact along and across the wheel [m/s].
    capacity
        Friction coefficient times vertical load, or what the friction circle leaves of it [N].
    stiffness
        Cornering stiffness [N/rad].
    adhesion_reduction
        Road adhesion reduction factor eps_r [s/m].
    """
    return dugoff(-v_lat, abs(v_long), grip(capacity, v_lat, adhesion_reduction), stiffness)


def first_critical_slip(speed: float, capacity: float, stiffness: float, adhesion_reduction: float) -> float:
    """Return the side slip at which the tyre leaves its linear region [rad]: lambda = 1.

    Parameters
    ----------
    speed
        Speed of the contact along the wheel [m/s]; its sign does not matter.
    capacity, stiffness, adhesion_reduction
        As in `lateral_force`.
    """
    reduction = adhesion_reduction * abs(speed)
    return math.atan2(capacity, 2.0 * stiffness + reduction * capacity)


def second_critical_slip(speed: float, capacity: float, stiffness: float, adhesion_reduction: float) -> float:
    """Return the side slip of the largest side force [rad]: pi/2 if the force never falls.

    With k = eps_r v, t = tan(alpha) and the capacity N the force is N (1 - k t) - (N (1 - k t))**2 / (4 C t);
    its derivative is 0 at t = 1 / sqrt(k**2 + 4 C k / N).

    Parameters
    ----------
    speed, capacity, stiffness, adhesion_reduction
        As in `first_critical_slip`.
    """
    reduction = adhesion_reduction * abs(speed)
    if capacity <= 0.0:
        return 0.0
    return math.atan2(1.0, math.sqrt(reduction * reduction + 4.0 * stiffness * reduction / capacity))


def dugoff_combined(
    rim_speed: float,
    v_long: float,
    v_lat: float,
    capacity: float,
    stiffnesses: tuple[float, float],
    adhesion_reduction: float,
) -> tuple[float, float]:
    """Return both forces of a tyre with wheel spin (Dugoff as in Boada et al. 2005).

    Parameters
    ----------
    rim_speed
        Rolling radius times spin of the wheel [m/s].
    v_long, v_lat
        Velocity of the contact along and across the wheel [m/s].
    capacity
        Friction coefficient times vertical load [N].
    stiffnesses
        Longitudinal stiffness per unit slip [N] and cornering stiffness [N/rad].
    adhesion_reduction
        Road adhesion reduction factor eps_r [s/m].

    Returns
    -------
    tuple of float
        Longitudinal and lateral force [N]; together at most ``capacity``.
    """
    ratio, speed = slip_ratio(rim_speed, v_long), abs(v_long)
    available = grip(capacity, math.hypot(ratio * speed, v_lat), adhesion_reduction)
    # Demands C_s S and C_alpha tan(alpha), both times the speed, so that tan(90 deg) is no trouble.
    long_demand, lat_demand = stiffnesses[0] * ratio * speed, -stiffnesses[1] * v_lat
    demand = math.hypot(long_demand, lat_demand)
    if demand == 0.0:
        # Spinning on the spot; rolling freely has ratio 0.
        return (math.copysign(available, ratio) if ratio != 0.0 else 0.0), 0.0
    rolling = max(0.0, 1.0 - abs(ratio)) * speed
    ease = available * rolling / (2.0 * demand)
    if ease >= 1.0:
        return long_demand / rolling, lat_demand / rolling
    factor = available * (1.0 - 0.5 * ease) / demand
    return long_demand * factor, lat_demand * factor
