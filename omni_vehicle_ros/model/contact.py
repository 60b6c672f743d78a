"""A tyre on the road at any speed: Dugoff's tyre above walking pace, a spring with a memory below.

At standstill a slip angle means nothing, and just above it the tyre is stiffer than any step can follow. Below
walking pace the slip is therefore taken from the tyre's lateral deflection z, which lags by the relaxation
length (Bernard & Clover 1995, SAE 950311), with a damping that fades out with speed (Pacejka 2012, sec. 8.6):

    dz/dt = -v_lat - max(abs(v_long) / sigma, abs(v_lat) / z_max) z,   tan(alpha) = (z + c dz/dt) / sigma

A rolling wheel settles at tan(alpha) = -v_lat / abs(v_long), the slip of the tyre above walking pace. The second
rate is Dahl's: a tyre dragged sideways stops stretching at z_max, so that it does not spring back from afar. The
weight of all this is exactly 0 from `WALKING_PACE` on.
"""

import math
from typing import NamedTuple

from omni_vehicle_ros.model.constants import Constants
from omni_vehicle_ros.model.tyre import dugoff, grip, lateral_capacity, limited_drive_force, side_slip_angle

WALKING_PACE = 1.2  # m/s, speed of the contact over ground
CREEPING_PACE = 0.3  # m/s, below it the deflection alone counts
FULL_STRETCH = 0.25  # Dugoff's lambda of a tyre that stretches no more: 7/8 of its grip
LARGEST_SLIP, SMALLEST_SLIP = 1.0, 1e-4  # bounds of tan(alpha) at full stretch, for very soft or bare ground
HOLDING_PACE = 0.02  # m/s, below it rolling is damped, so that nothing creeps away for ever
FASTEST_RELAXATION = 200.0  # 1/s, slow enough for the longest step, 10 ms; reached far above walking pace
WALKING_PACE_SQUARED, HOLDING_PACE_SQUARED = WALKING_PACE**2, HOLDING_PACE**2


class Contact(NamedTuple):
    """One wheel as its tyre sees it, roll steer apart.

    ``v_long``, ``v_lat``: velocity along and across the wheel [m/s]; ``deflection``: state of the tyre [m];
    ``drive_force``: demanded traction [N]; ``load``: vertical load without lateral transfer [N]; ``friction``:
    coefficient of the road; ``cos_steer``, ``sin_steer``: of the steer angle.
    """

    v_long: float
    v_lat: float
    deflection: float
    drive_force: float
    load: float
    friction: float
    cos_steer: float
    sin_steer: float


def low_speed_weight(speed: float) -> float:
    """Return how much of the slip comes from the deflection: 1 when creeping, 0 from walking pace on.

    Parameters
    ----------
    speed
        Speed of the contact over ground [m/s], >= 0.
    """
    if speed >= WALKING_PACE:
        return 0.0
    if speed <= CREEPING_PACE:
        return 1.0
    share = (WALKING_PACE - speed) / (WALKING_PACE - CREEPING_PACE)
    return share * share * (3.0 - 2.0 * share)


def rolling_hold(v_long: float, speed: float, constants: Constants) -> float:
    """Return the force along the wheel that ends what is left of a roll at standstill [N].

    Parameters
    ----------
    v_long, speed
        Velocity along the wheel and speed over ground of the contact [m/s].
    constants
        The vehicle.
    """
    if speed >= HOLDING_PACE:
        return 0.0
    share = 1.0 - speed / HOLDING_PACE
    return -constants.rolling_hold * share * share * v_long


def largest_slip(contact: Contact, constants: Constants) -> float:
    """Return tan(alpha) of the fully stretched tyre, by its load without lateral transfer."""
    slip = contact.friction * contact.load / (2.0 * FULL_STRETCH * constants.cornering_stiffness)
    if slip > LARGEST_SLIP:
        return LARGEST_SLIP
    return slip if slip > SMALLEST_SLIP else SMALLEST_SLIP


def turned(contact: Contact, cos_roll: float, sin_roll: float) -> tuple[float, float]:
    """Return the velocity along and across the wheel as roll has turned it [m/s]."""
    along, across = contact.v_long, contact.v_lat
    return along * cos_roll + across * sin_roll, across * cos_roll - along * sin_roll


def deflection_rate(contact: Contact, v_long: float, v_lat: float, constants: Constants) -> float:
    """Return the rate of the tyre's lateral deflection [m/s].

    Parameters
    ----------
    contact
        The wheel.
    v_long, v_lat
        Velocity along and across the wheel, roll steer included [m/s].
    constants
        The vehicle.
    """
    rolling, dragging = abs(v_long), abs(v_lat) / largest_slip(contact, constants)
    rate = (rolling if rolling > dragging else dragging) / constants.relaxation_length
    if rate <= FASTEST_RELAXATION:
        return -v_lat - rate * contact.deflection
    # The same steady deflection, approached no faster than the integrator can follow.
    return -FASTEST_RELAXATION * (v_lat / rate + contact.deflection)


def deflection_slip(contact: Contact, v_long: float, v_lat: float, weight: float, constants: Constants) -> float:
    """Return tan(alpha) that the deflection of a slow tyre stands for.

    Parameters
    ----------
    contact, v_long, v_lat, constants
        As in `deflection_rate`.
    weight
        From `low_speed_weight`; the damping fades out with it.
    """
    limit, length = largest_slip(contact, constants), constants.relaxation_length
    stretch = max(-limit, min(limit, contact.deflection / length))
    rate = deflection_rate(contact, v_long, v_lat, constants)
    return stretch + constants.low_speed_damping * weight * rate / length


def wheel_force(
    contact: Contact, cos_roll: float, sin_roll: float, load: float, constants: Constants
) -> tuple[float, float]:
    """Return the longitudinal and the lateral force of a tyre in the wheel frame [N].

    Parameters
    ----------
    contact
        The wheel.
    cos_roll, sin_roll
        Of the angle by which roll turns the wheel.
    load
        Vertical load [N].
    constants
        The vehicle; its ``friction_circle`` says whether traction costs side force (thesis eq. 4.1, 4.2).
    """
    v_long, v_lat, _, traction, _, friction, _, _ = contact
    if sin_roll != 0.0:
        v_long, v_lat = v_long * cos_roll + v_lat * sin_roll, v_lat * cos_roll - v_long * sin_roll
    capacity = friction * load
    square = v_long * v_long + v_lat * v_lat
    if square < HOLDING_PACE_SQUARED:
        traction += rolling_hold(v_long, math.sqrt(square), constants)
    if traction != 0.0:
        traction = limited_drive_force(traction, capacity)
        if constants.friction_circle:
            capacity = lateral_capacity(capacity, traction)
    available = grip(capacity, v_lat, constants.adhesion_reduction)
    stiffness = constants.cornering_stiffness
    if square >= WALKING_PACE_SQUARED:
        return traction, dugoff(-v_lat, abs(v_long), available, stiffness)
    weight = low_speed_weight(math.sqrt(square))
    slip = deflection_slip(contact, v_long, v_lat, weight, constants)
    lateral = weight * dugoff(slip, 1.0, available, stiffness)
    if weight < 1.0:
        lateral += (1.0 - weight) * dugoff(-v_lat, abs(v_long), available, stiffness)
    return traction, lateral


def side_slip(contact: Contact, cos_roll: float, sin_roll: float, constants: Constants) -> float:
    """Return the side-slip angle that makes the side force [rad]; from the deflection when creeping.

    Parameters
    ----------
    contact, cos_roll, sin_roll, constants
        As in `wheel_force`.
    """
    v_long, v_lat = turned(contact, cos_roll, sin_roll)
    weight = low_speed_weight(math.hypot(v_long, v_lat))
    rolling = side_slip_angle(v_long, v_lat) if weight < 1.0 else 0.0
    if weight == 0.0:
        return rolling
    slow = math.atan(deflection_slip(contact, v_long, v_lat, weight, constants))
    return (1.0 - weight) * rolling + weight * slow
