"""A spinning wheel on the road at any speed: combined slip above walking pace, a spring with a memory below.

At standstill the slip ratio means no more than the slip angle does, and dividing by a small speed makes the
spin stiffer than any step can follow. Below walking pace both slips are therefore taken from the deflections
(zx, zy) of the tyre, which lag by the relaxation length (Bernard & Clover 1995, SAE 950311, for both
directions), with a damping that fades out with speed (Pacejka 2012, sec. 8.6). It is the method of `contact`
with one direction more:

    dzx/dt = R w - u - n zx / sigma,   dzy/dt = -v - n zy / sigma
    n = max(abs(R w), abs(u), sliding speed / slip at full stretch)

A wheel that rolls steadily settles at the slips of its velocities, to the first order; one that slides
settles fully stretched, against the direction in which it slides. The weight of all this is exactly 0 from
`WALKING_PACE` on.
"""

import math
from typing import NamedTuple

from omni_vehicle_ros.model.contact import HOLDING_PACE, Contact, largest_slip, low_speed_weight, relaxing, rolling_hold
from omni_vehicle_ros.model.eight_dof.constants import EightDofConstants
from omni_vehicle_ros.model.tyres.force import tyre_force
from omni_vehicle_ros.model.tyres.slip import side_slip_angle

LARGEST_RATIO = 0.5  # of a slow wheel, damping included


class Wheel(NamedTuple):
    """A wheel as its tyre sees it: contact, roll steer included, rim speed [m/s], longitudinal deflection [m]."""

    contact: Contact
    rim_speed: float
    long_deflection: float


class Deflecting(NamedTuple):
    """Rates of both deflections [m/s] and both slips at full stretch."""

    long_rate: float
    lat_rate: float
    long_limit: float
    lat_limit: float


def deflecting(wheel: Wheel, constants: EightDofConstants) -> Deflecting:
    """Return how the deflections of a tyre change.

    Parameters
    ----------
    wheel
        Velocities and deflections.
    constants
        The vehicle.
    """
    contact, plane = wheel.contact, constants.plane
    long_limit = largest_slip(contact, plane.longitudinal_stiffness, plane)
    lat_limit = largest_slip(contact, plane.cornering_stiffness, plane)
    slipping = wheel.rim_speed - contact.v_long
    sliding = math.hypot(slipping, contact.v_lat)
    sweep = max(abs(wheel.rim_speed), abs(contact.v_long))
    length = plane.relaxation_length
    return Deflecting(
        relaxing(slipping, max(sweep, sliding / long_limit) / length, wheel.long_deflection),
        relaxing(-contact.v_lat, max(sweep, sliding / lat_limit) / length, contact.deflection),
        long_limit,
        lat_limit,
    )


def slow_slips(wheel: Wheel, weight: float, constants: EightDofConstants) -> tuple[float, float]:
    """Return the slip ratio and tan(side slip) that the deflections of a slow tyre stand for.

    Parameters
    ----------
    wheel, constants
        As in `deflecting`.
    weight
        From `low_speed_weight`; the damping fades out with it.
    """
    rate, length = deflecting(wheel, constants), constants.plane.relaxation_length
    ratio = _within(wheel.long_deflection / length, rate.long_limit)
    slip = _within(wheel.contact.deflection / length, rate.lat_limit)
    ratio += constants.long_damping * weight * rate.long_rate / length
    slip += constants.plane.low_speed_damping * weight * rate.lat_rate / length
    return _within(ratio, LARGEST_RATIO), slip


def _within(value: float, limit: float) -> float:
    return max(-limit, min(limit, value))


def tyre_forces(wheel: Wheel, load: float, constants: EightDofConstants) -> tuple[float, float]:
    """Return the longitudinal and the lateral force of a tyre in the wheel frame [N].

    Parameters
    ----------
    wheel
        Velocities and deflections.
    load
        Vertical load [N].
    constants
        The vehicle.
    """
    contact = wheel.contact
    capacity = contact.friction * load
    weight = low_speed_weight(math.hypot(contact.v_long, contact.v_lat))
    if weight == 0.0:
        return tyre_force(wheel.rim_speed, contact.v_long, contact.v_lat, capacity, constants.plane)
    ratio, slip = slow_slips(wheel, weight, constants)
    # A driven tyre as the mirror image of a braked one: nothing depends on how a wheel at rest will roll.
    pace = max(HOLDING_PACE, abs(wheel.rim_speed), abs(contact.v_long))
    brake, lateral = tyre_force(pace * (1.0 - abs(ratio)), pace, -pace * slip, capacity, constants.plane)
    longitudinal, lateral = weight * math.copysign(brake, ratio), weight * lateral
    if weight < 1.0:
        fast = tyre_force(wheel.rim_speed, contact.v_long, contact.v_lat, capacity, constants.plane)
        longitudinal += (1.0 - weight) * fast[0]
        lateral += (1.0 - weight) * fast[1]
    return longitudinal, lateral


def side_slip(wheel: Wheel, constants: EightDofConstants) -> float:
    """Return the side-slip angle that makes the side force [rad]; from the deflection when creeping.

    Parameters
    ----------
    wheel, constants
        As in `tyre_forces`.
    """
    v_long, v_lat = wheel.contact.v_long, wheel.contact.v_lat
    weight = low_speed_weight(math.hypot(v_long, v_lat))
    rolling = side_slip_angle(v_long, v_lat) if weight < 1.0 else 0.0
    if weight == 0.0:
        return rolling
    return (1.0 - weight) * rolling + weight * math.atan(slow_slips(wheel, weight, constants)[1])


def spin_rate(wheel: Wheel, drive_force: float, longitudinal_force: float, constants: EightDofConstants) -> float:
    """Return the angular acceleration of a wheel, Iw dw/dt = torque - R Fx [rad/s2].

    Parameters
    ----------
    wheel
        The wheel.
    drive_force
        Torque of drive or brake over the radius [N].
    longitudinal_force
        Force of the road along the wheel [N].
    constants
        The vehicle.
    """
    rim, contact = wheel.rim_speed, wheel.contact
    pace = max(abs(rim), math.hypot(contact.v_long, contact.v_lat))
    force = drive_force + rolling_hold(rim, pace, constants.plane) - longitudinal_force
    return constants.wheel_radius * force / constants.wheel_inertia
