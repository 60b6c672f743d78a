"""Where on its curve of side force a tyre works: in its linear region, nonlinear up to the peak, or sliding.

A tyre slides where more side slip makes no more side force. It leaves its linear region

- by its own definition at lambda = 1 if it is Dugoff's (thesis sec. 2.5): up to there the force is C tan(alpha);
- where the force has fallen 5 % below C tan(alpha) if it has no such kink (brush, Magic Formula, LuGre).

The brush slides from psi = 1 on, where no bristle sticks any more; the others from the peak of their force on.

Of a wheel with spin the same is said of both its slips together.
"""

import math
from enum import IntEnum

from omni_vehicle_ros.model.constants import BRUSH, DUGOFF, MAGIC_FORMULA, Constants
from omni_vehicle_ros.model.tyres import brush, lugre, magic_formula
from omni_vehicle_ros.model.tyres.dugoff import first_critical_slip, second_critical_slip
from omni_vehicle_ros.model.tyres.force import side_force
from omni_vehicle_ros.model.tyres.slip import slip_ratio

DEPARTURE = 0.05  # of the force that the cornering stiffness alone would make


class Region(IntEnum):
    """Where on its curve a tyre works."""

    LINEAR = 0
    NONLINEAR = 1
    SLIDING = 2


def region(side_slip: float, speed: float, capacity: float, constants: Constants) -> Region:
    """Return where on its curve a tyre with this side slip works.

    Parameters
    ----------
    side_slip
        Side-slip angle, within +-pi/2 [rad].
    speed
        Speed of the contact along the wheel [m/s]; its sign does not matter.
    capacity
        Friction coefficient times vertical load, or what the friction circle leaves of it [N].
    constants
        The vehicle.
    """
    size, speed, stiffness = abs(side_slip), abs(speed), constants.cornering_stiffness
    if constants.tyre_model == DUGOFF:
        limits = speed, capacity, stiffness, constants.adhesion_reduction
        if size <= first_critical_slip(*limits):
            return Region.LINEAR
        return Region.NONLINEAR if size <= second_critical_slip(*limits) else Region.SLIDING
    slip = math.tan(size)
    if size == 0.0 or capacity <= 0.0:
        return Region.LINEAR if size == 0.0 else Region.SLIDING
    if side_force(slip, 1.0, slip * speed, capacity, constants) >= (1.0 - DEPARTURE) * stiffness * slip:
        return Region.LINEAR
    return Region.SLIDING if _sliding(slip, speed, capacity, constants) else Region.NONLINEAR


def _sliding(slip: float, speed: float, capacity: float, constants: Constants) -> bool:
    stiffness = constants.cornering_stiffness
    if constants.tyre_model == BRUSH:
        return brush.demand(slip, capacity, stiffness) >= 1.0
    if constants.tyre_model == MAGIC_FORMULA:
        normalised = stiffness * slip / (constants.magic_shape * capacity)
        return magic_formula.past_peak(normalised, constants.magic_shape, constants.magic_curvature)
    return lugre.past_peak(
        slip, speed, capacity, stiffness, constants.sliding_share, constants.stribeck_speed
    )


def combined_region(side_slip: float, rim_speed: float, speed: float, capacity: float, constants: Constants) -> Region:
    """Return where on its curve a tyre of a wheel with spin works (Dugoff as in Boada et al. 2005).

    All tyres take both slips together, each times its stiffness: it is where a tyre works that rolls freely, slides as
    fast, and whose side slip alone asks for as much. So it slides where, at the same speed of rolling, more slip gives
    no more force.

    Parameters
    ----------
    side_slip
        Side-slip angle, within +-pi/2 [rad].
    rim_speed
        Rolling radius times spin of the wheel [m/s].
    speed
        Speed of the contact along the wheel, not 0 [m/s].
    capacity
        Friction coefficient times vertical load [N].
    constants
        The vehicle.
    """
    slipping, sideways = rim_speed - speed, speed * math.tan(side_slip)
    ratio, rolling = slipping, abs(rim_speed)
    if constants.tyre_model == DUGOFF:
        share = slip_ratio(rim_speed, speed)
        ratio, rolling = share * speed, (1.0 - abs(share)) * abs(speed)
    demand = math.hypot(constants.longitudinal_stiffness * ratio, constants.cornering_stiffness * sideways)
    if demand == 0.0:
        return Region.LINEAR
    if rolling <= 0.0:
        return Region.SLIDING
    slip = demand / (rolling * constants.cornering_stiffness)
    return region(math.atan(slip), math.hypot(ratio, sideways) / slip, capacity, constants)
