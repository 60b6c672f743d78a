"""A tyre on the road at any speed: the law of the tyre above walking pace, a spring with a memory below.

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

from omni_vehicle_ros.model.arithmetic import cos_sin, norm
from omni_vehicle_ros.model.constants import Constants
from omni_vehicle_ros.model.lanes import anywhere, select
from omni_vehicle_ros.model.tyres.force import side_force
from omni_vehicle_ros.model.tyres.friction_circle import lateral_capacity, limited_drive_force
from omni_vehicle_ros.model.tyres.slip import side_slip_angle

WALKING_PACE = 1.2  # m/s, speed of the contact over ground
CREEPING_PACE = 0.3  # m/s, below it the deflection alone counts
LARGEST_SLIP, SMALLEST_SLIP = 1.0, 1e-4  # bounds of tan(alpha) at full stretch, for very soft or bare ground
HOLDING_PACE = 0.02  # m/s, below it rolling is damped, so that nothing creeps away for ever
FASTEST_RELAXATION = 200.0  # 1/s, slow enough for the longest step, 10 ms; reached far above walking pace
WALKING_PACE_SQUARED, HOLDING_PACE_SQUARED = WALKING_PACE**2, HOLDING_PACE**2


class Contact(NamedTuple):
    """One wheel as its tyre sees it, roll steer apart.

    ``v_long``, ``v_lat``: velocity along and across the wheel [m/s]; ``deflection``: state of the tyre [m];
    ``drive_force``: demanded traction [N]; ``load``: vertical load without lateral transfer [N]; ``friction``:
    coefficient of the road; ``cos_steer``, ``sin_steer``: of the steer angle; ``trim_share``: see the function.
    """

    v_long: float
    v_lat: float
    deflection: float
    drive_force: float
    load: float
    friction: float
    cos_steer: float
    sin_steer: float
    trim_share: float


def low_speed_weight(speed: float) -> float:
    """Return how much of the slip comes from the deflection: 1 when creeping, 0 from walking pace on.

    Parameters
    ----------
    speed
        Speed of the contact over ground [m/s], >= 0.
    """
    share = max(0.0, min(1.0, (WALKING_PACE - speed) / (WALKING_PACE - CREEPING_PACE)))
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
    share = max(0.0, 1.0 - speed / HOLDING_PACE)
    return -constants.rolling_hold * share * share * v_long


def largest_slip(contact: Contact, stiffness: float, constants: Constants) -> float:
    """Return the slip of the fully stretched tyre, 7/8 of its grip, by its load without lateral transfer.

    Parameters
    ----------
    contact
        The wheel.
    stiffness
        Of the tyre in the direction of the slip [N].
    constants
        The vehicle.
    """
    slip = constants.full_stretch * contact.friction * contact.load / stiffness
    return max(SMALLEST_SLIP, min(LARGEST_SLIP, slip))


def turned(contact: Contact, cos_roll: float, sin_roll: float) -> tuple[float, float]:
    """Return the velocity along and across the wheel as roll has turned it [m/s]."""
    along, across = contact.v_long, contact.v_lat
    return along * cos_roll + across * sin_roll, across * cos_roll - along * sin_roll


def trim_share(slip_gain: float, speed: float) -> float:
    """Return the share K / (1 + K) of its side slip that a controlled wheel steers away.

    The gain fades out below walking pace, where a slip angle means little, as the slip by velocity itself does.

    Parameters
    ----------
    slip_gain
        Proportional gain K of the side-slip controller; below 0 it counts as 0.
    speed
        Speed of the contact over ground [m/s], >= 0.
    """
    gain = max(0.0, slip_gain) * (1.0 - low_speed_weight(speed))
    return gain / (1.0 + gain)


def trim(contact: Contact, cos_roll: float, sin_roll: float) -> float:
    """Return the steer angle -K alpha by which a controlled wheel leaves its set-point [rad].

    The slip of the set-point, delta0 + roll steer - theta, is folded into +-90 deg: it counts from the direction
    in which the wheel would roll at its set-point, forward or backward. No trim turns a wheel past that.

    Parameters
    ----------
    contact
        The wheel at its set-point.
    cos_roll, sin_roll
        Of the angle by which roll turns the wheel.
    """
    v_long, v_lat = turned(contact, cos_roll, sin_roll)
    slip = math.atan2(select(v_long >= 0.0, -v_lat, v_lat), abs(v_long))
    return -contact.trim_share * slip


def trimmed(contact: Contact, cos_roll: float, sin_roll: float) -> Contact:
    """Return the wheel at its real steer angle; parameters as in `trim`."""
    cos, sin = cos_sin(trim(contact, cos_roll, sin_roll))
    v_long, v_lat = turned(contact, cos, sin)
    return Contact(
        v_long,
        v_lat,
        contact.deflection,
        contact.drive_force,
        contact.load,
        contact.friction,
        contact.cos_steer * cos - contact.sin_steer * sin,
        contact.sin_steer * cos + contact.cos_steer * sin,
        contact.trim_share,
    )


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
    dragging = abs(v_lat) / largest_slip(contact, constants.cornering_stiffness, constants)
    return relaxing(-v_lat, max(abs(v_long), dragging) / constants.relaxation_length, contact.deflection)


def relaxing(velocity: float, rate: float, deflection: float) -> float:
    """Return the rate of a deflection [m/s] that a velocity stretches and rolling or dragging lets go.

    Parameters
    ----------
    velocity
        Speed of the slip [m/s].
    rate
        At which the deflection relaxes [1/s], >= 0.
    deflection
        Of the tyre [m].
    """
    approach = velocity - rate * deflection
    fast = rate > FASTEST_RELAXATION
    if anywhere(fast):
        # The same steady deflection, approached no faster than the integrator can follow.
        approach = select(fast, FASTEST_RELAXATION * (velocity / rate - deflection), approach)
    return approach


def deflection_slip(contact: Contact, v_long: float, v_lat: float, weight: float, constants: Constants) -> float:
    """Return tan(alpha) that the deflection of a slow tyre stands for.

    Parameters
    ----------
    contact, v_long, v_lat, constants
        As in `deflection_rate`.
    weight
        From `low_speed_weight`; the damping fades out with it.
    """
    limit, length = largest_slip(contact, constants.cornering_stiffness, constants), constants.relaxation_length
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
    v_long, v_lat = turned(contact, cos_roll, sin_roll)
    traction, capacity = contact.drive_force, contact.friction * load
    square = v_long * v_long + v_lat * v_lat
    if anywhere(square < HOLDING_PACE_SQUARED):
        traction = traction + rolling_hold(v_long, math.sqrt(square), constants)
    if anywhere(traction != 0.0):
        traction = limited_drive_force(traction, capacity)
        if constants.friction_circle:
            capacity = lateral_capacity(capacity, traction)
    lateral = side_force(-v_lat, abs(v_long), v_lat, capacity, constants)
    if anywhere(square < WALKING_PACE_SQUARED):
        weight = low_speed_weight(math.sqrt(square))
        slip = deflection_slip(contact, v_long, v_lat, weight, constants)
        lateral = (1.0 - weight) * lateral + weight * side_force(slip, 1.0, v_lat, capacity, constants)
    return traction, lateral


def side_slip(contact: Contact, cos_roll: float, sin_roll: float, constants: Constants) -> float:
    """Return the side-slip angle that makes the side force [rad]; from the deflection when creeping.

    Parameters
    ----------
    contact, cos_roll, sin_roll, constants
        As in `wheel_force`.
    """
    v_long, v_lat = turned(contact, cos_roll, sin_roll)
    angle, weight = side_slip_angle(v_long, v_lat), low_speed_weight(norm(v_long, v_lat))
    if anywhere(weight > 0.0):
        slow = math.atan(deflection_slip(contact, v_long, v_lat, weight, constants))
        angle = (1.0 - weight) * angle + weight * slow
    return angle
