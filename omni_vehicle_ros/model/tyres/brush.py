"""The brush tyre with a parabolic pressure over its patch (Pacejka 2012, sec. 3.2).

Bristles stick to the road from the front edge of the patch on until friction can't hold them, and slide from
there to the rear edge, along the slip. With the demand psi = norm(C_x sigma_x, C_y sigma_y) / (3 mu Fz) below 1
the share 1 - psi of the patch sticks, and (Svendenius & Wittenmark 2003)

    F = (1 - psi)^2 (C_x sigma_x, C_y sigma_y) + psi^2 (3 - 2 psi) mu Fz sigma / norm(sigma)

which in one direction is mu Fz (3 psi - 3 psi^2 + psi^3). From psi = 1 on all of it slides and F = mu Fz.
"""

import math

from omni_vehicle_ros.model.arithmetic import norm, positive
from omni_vehicle_ros.model.lanes import select

FULL_STRETCH = 1.5  # slip, in units of capacity over stiffness, at 7/8 of the grip: psi = 1/2


def brush_force(
    slip: tuple[float, float], rolling: float, capacity: float, stiffness: tuple[float, float]
) -> tuple[float, float]:
    """Return the longitudinal and the lateral force of a tyre [N]; together at most ``capacity``.

    Parameters
    ----------
    slip, rolling
        Slips along and across the wheel, and the speed of the rim; any three numbers in their proportion, the
        last one >= 0.
    capacity
        Friction coefficient times vertical load [N], >= 0.
    stiffness
        Longitudinal stiffness per unit slip [N] and cornering stiffness [N/rad].
    """
    slip_long, slip_lat = slip
    size = positive(norm(slip_long, slip_lat))
    demand_long, demand_lat = stiffness[0] * slip_long, stiffness[1] * slip_lat
    demand, limit = norm(demand_long, demand_lat), 3.0 * capacity * rolling
    slides, psi = demand >= limit, demand / positive(limit)
    sticking = (1.0 - psi) * (1.0 - psi) / positive(rolling)
    sliding = psi * psi * (3.0 - 2.0 * psi) * capacity / size
    return (
        select(slides, capacity * (slip_long / size), sticking * demand_long + sliding * slip_long),
        select(slides, capacity * (slip_lat / size), sticking * demand_lat + sliding * slip_lat),
    )


def demand(slip: float, capacity: float, stiffness: float) -> float:
    """Return psi at tan(alpha) = ``slip``; the tyre slides fully from 1 on. Infinite where there is no capacity.

    Parameters
    ----------
    slip
        tan(alpha), >= 0.
    capacity, stiffness
        As in `brush_force`, of one direction.
    """
    return stiffness * slip / (3.0 * capacity) if capacity > 0.0 else math.inf
