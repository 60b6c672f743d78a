"""The one interface to the tyres: forces by pure side slip or by combined slip, whichever tyre a vehicle has."""

import math

from omni_vehicle_ros.model.constants import BRUSH, DUGOFF, MAGIC_FORMULA, Constants
from omni_vehicle_ros.model.tyres.brush import brush_force
from omni_vehicle_ros.model.tyres.dugoff import dugoff, dugoff_combined, grip
from omni_vehicle_ros.model.tyres.lugre import lugre_force
from omni_vehicle_ros.model.tyres.magic_formula import magic_force


def side_force(numerator: float, denominator: float, speed: float, capacity: float, constants: Constants) -> float:
    """Return the side force of a wheel that rolls freely with tan(alpha) = numerator / denominator [N].

    Parameters
    ----------
    numerator, denominator
        Any two numbers in the proportion of tan(alpha); denominator >= 0, and 0 stands for 90 deg.
    speed
        Speed at which the contact slides sideways [m/s]; its sign does not matter.
    capacity
        Friction coefficient times vertical load, or what the friction circle leaves of it [N], >= 0.
    constants
        The vehicle.

    Returns
    -------
    float
        At most ``capacity`` in size; 0 if both numerator and denominator are.
    """
    if constants.tyre_model == DUGOFF:
        available = grip(capacity, speed, constants.adhesion_reduction)
        return dugoff(numerator, denominator, available, constants.cornering_stiffness)
    return _slip_force((0.0, numerator), denominator, abs(speed), capacity, constants)[1]


def tyre_force(
    rim_speed: float, v_long: float, v_lat: float, capacity: float, constants: Constants
) -> tuple[float, float]:
    """Return the longitudinal and the lateral force of a wheel that may spin or lock [N].

    Parameters
    ----------
    rim_speed
        Rolling radius times spin of the wheel [m/s].
    v_long, v_lat
        Velocity of the contact along and across the wheel [m/s].
    capacity
        Friction coefficient times vertical load [N], >= 0.
    constants
        The vehicle.

    Returns
    -------
    tuple of float
        Together at most ``capacity`` in size. With a rim as fast as the contact it is `side_force`.
    """
    if constants.tyre_model == DUGOFF:
        stiffness = constants.longitudinal_stiffness, constants.cornering_stiffness
        return dugoff_combined(rim_speed, v_long, v_lat, capacity, stiffness, constants.adhesion_reduction)
    slip = rim_speed - v_long, -v_lat
    return _slip_force(slip, abs(rim_speed), math.hypot(slip[0], slip[1]), capacity, constants)


def _slip_force(
    slip: tuple[float, float], rolling: float, speed: float, capacity: float, constants: Constants
) -> tuple[float, float]:
    stiffness = constants.longitudinal_stiffness, constants.cornering_stiffness
    if constants.tyre_model == BRUSH:
        return brush_force(slip, rolling, capacity, stiffness)
    if constants.tyre_model == MAGIC_FORMULA:
        return magic_force(slip, rolling, capacity, stiffness, constants.magic_shape, constants.magic_curvature)
    return lugre_force(
        slip, rolling, speed, capacity, stiffness, constants.sliding_share, constants.stribeck_speed
    )
