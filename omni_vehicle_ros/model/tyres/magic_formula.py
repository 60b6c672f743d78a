"""The Magic Formula with one shape for both directions (Bakker, Nyborg & Pacejka 1987; Pacejka 2012, ch. 4).

    F = D sin(C atan(B s - E (B s - atan(B s)))),   B C D = stiffness,   D = mu Fz

Combined slip by normalised slip, the similarity method (Pacejka 2012, sec. 4.2.2): the size of the force is that
of pure slip at the demand norm(C_x sigma_x, C_y sigma_y), and its direction that of the demand. The default
factors, C = 1.193 and E = -1.003, are those of the side force of a 205/60 R15 tyre (Pacejka 2012, app. 3).
"""

import math

from omni_vehicle_ros.model.arithmetic import norm, positive
from omni_vehicle_ros.model.lanes import select

LARGEST_DEMAND = 1e9  # B s; the force has reached its limit long before
STRETCH, HALVINGS = 0.875, 60


def magic_share(demand: float, shape: float, curvature: float) -> float:
    """Return the force over its peak D, sin(C atan(x - E (x - atan x))).

    Parameters
    ----------
    demand
        x = B s, that is stiffness times slip over C D, >= 0.
    shape, curvature
        The factors C and E.
    """
    return math.sin(shape * math.atan(_bracket(demand, curvature)))


def _bracket(demand: float, curvature: float) -> float:
    # As in the formula, but without its difference of large numbers.
    return (1.0 - curvature) * demand + curvature * math.atan(demand)


def past_peak(demand: float, shape: float, curvature: float) -> bool:
    """Return whether the force falls with more slip; parameters as in `magic_share`."""
    return shape * math.atan(_bracket(demand, curvature)) > 0.5 * math.pi


def magic_force(
    slip: tuple[float, float],
    rolling: float,
    capacity: float,
    stiffness: tuple[float, float],
    shape: float,
    curvature: float,
) -> tuple[float, float]:
    """Return the longitudinal and the lateral force of a tyre [N]; together at most ``capacity``.

    Parameters
    ----------
    slip, rolling, capacity, stiffness
        As in `brush.brush_force`.
    shape, curvature
        The factors C, 1 .. 2, and E, at most 1.
    """
    demand_long, demand_lat = stiffness[0] * slip[0], stiffness[1] * slip[1]
    demand, limit = norm(demand_long, demand_lat), shape * capacity * rolling
    normalised = select(demand < LARGEST_DEMAND * limit, demand / positive(limit), LARGEST_DEMAND)
    force, demand = capacity * magic_share(normalised, shape, curvature), positive(demand)
    return force * (demand_long / demand), force * (demand_lat / demand)


def full_stretch(shape: float, curvature: float) -> float:
    """Return the slip, in units of capacity over stiffness, at which the tyre first gives 7/8 of its grip.

    Parameters
    ----------
    shape, curvature
        As in `magic_force`.
    """
    # The share rises up to its peak, and the bracket rises for all x: so this is the root of the bracket.
    wanted = math.tan(math.asin(STRETCH) / shape)
    low, high = 0.0, 1.0
    while _bracket(high, curvature) < wanted and high < LARGEST_DEMAND:
        high *= 2.0
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if _bracket(middle, curvature) < wanted else (low, middle)
    return shape * high
