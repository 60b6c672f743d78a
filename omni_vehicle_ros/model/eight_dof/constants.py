"""What the model with 8 degrees of freedom needs of the parameters, beyond the constants of the plane."""

import math
from typing import NamedTuple

from omni_vehicle_ros.model.constants import Constants
from omni_vehicle_ros.model.constants import constants as plane_constants
from omni_vehicle_ros.model.contact import WALKING_PACE
from omni_vehicle_ros.parameters import VehicleParameters

# The slip of a wheel dies away at the rate C_s (R^2 / Iw + 4 / m) / u. Just below walking pace, braked, that is
# a fifth more than at walking pace. The Runge-Kutta method of order 4 is stable up to 2.78 over the rate.
STIFFENING, STABLE_RATE = 1.2, 2.5


class EightDofConstants(NamedTuple):
    """Plain numbers, SI; made by `eight_dof_constants`.

    ``plane``: masses, geometry, tyres and air. ``roll_inertia``: of the rolling vehicle about its centre of
    gravity; ``roll_yaw_inertia``: product of inertia, the integral of x z dm; ``roll_coupling``: sprung mass
    times roll arm [kg m]; ``roll_shift``: how far the body moves to the left of the centre of gravity per
    roll angle [m]; ``net_roll_stiffness``: of the springs less that of gravity [N m/rad]; ``roll_damping`` [N
    m s/rad]; ``front_spring``, ``rear_spring``, ``front_damper``, ``rear_damper`` and ``front_link``,
    ``rear_link``: load that moves from the left to the right wheel of the axle per roll angle [N], per roll
    rate [N s] and, by the forces in the roll centre, per lateral acceleration [N s2/m]; ``long_damping``: as
    ``low_speed_damping``, along the wheel; ``longest_step``: in which slip and roll can be followed [s].
    """

    plane: Constants
    roll_inertia: float
    roll_yaw_inertia: float
    roll_coupling: float
    roll_shift: float
    net_roll_stiffness: float
    roll_damping: float
    front_spring: float
    rear_spring: float
    front_damper: float
    rear_damper: float
    front_link: float
    rear_link: float
    wheel_inertia: float
    wheel_radius: float
    long_damping: float
    longest_step: float


def eight_dof_constants(parameters: VehicleParameters) -> EightDofConstants:
    """Work out the constants of the model.

    Parameters
    ----------
    parameters
        The vehicle; its front axle has the same share of the roll damping as of the roll stiffness.
    """
    p = parameters
    coupling = p.sprung_mass * p.roll_arm
    acting = 1.0 if p.load_transfer else 0.0
    front, rear = acting / p.front_track, acting / p.rear_track
    front_share, rear_share = p.front_roll_stiffness_share, 1.0 - p.front_roll_stiffness_share
    sprung_front = p.sprung_mass * p.cg_to_rear_axle / p.wheelbase
    return EightDofConstants(
        plane=plane_constants(p),
        roll_inertia=p.roll_inertia - coupling * coupling / p.mass,
        roll_yaw_inertia=p.roll_yaw_inertia,
        roll_coupling=coupling,
        roll_shift=coupling / p.mass,
        net_roll_stiffness=p.roll_stiffness - coupling * p.gravity,
        roll_damping=p.roll_damping,
        front_spring=front * front_share * p.roll_stiffness,
        rear_spring=rear * rear_share * p.roll_stiffness,
        front_damper=front * front_share * p.roll_damping,
        rear_damper=rear * rear_share * p.roll_damping,
        front_link=front * sprung_front * p.front_roll_centre_height,
        rear_link=rear * (p.sprung_mass - sprung_front) * p.rear_roll_centre_height,
        wheel_inertia=p.wheel_inertia,
        wheel_radius=p.wheel_radius,
        long_damping=2.0 * math.sqrt(p.mass * p.relaxation_length / (4.0 * p.longitudinal_stiffness)),
        longest_step=_longest_step(p),
    )


def _longest_step(p: VehicleParameters) -> float:
    compliance = p.wheel_radius**2 / p.wheel_inertia + 4.0 / p.mass
    slipping = STIFFENING * p.longitudinal_stiffness * compliance / WALKING_PACE
    inertia = p.roll_inertia - (p.sprung_mass * p.roll_arm) ** 2 / p.mass - p.roll_yaw_inertia**2 / p.yaw_inertia
    rolling = p.roll_damping / inertia + math.sqrt(p.roll_stiffness / inertia)
    return STABLE_RATE / max(slipping, rolling)
