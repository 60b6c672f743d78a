"""What the physics needs of the parameters, worked out once for the inner loop."""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from omni_vehicle_ros.model.tyres import brush, dugoff, lugre, magic_formula
from omni_vehicle_ros.parameters import TYRE_MODELS, VehicleParameters
from omni_vehicle_ros.wheels import PerWheel

Table = tuple[float, ...] | npt.NDArray[np.float64]  # an array in the compiled physics, whatever its length
DUGOFF, BRUSH, MAGIC_FORMULA, LUGRE = range(len(TYRE_MODELS))
HOLDING_TIME = 0.1  # s, in which a vehicle that hardly rolls any more comes to rest


class Constants(NamedTuple):
    """Plain numbers, SI; made by `constants`.

    The names of `VehicleParameters` keep their meaning. ``front_load`` and ``rear_load`` are the static loads
    of one wheel on a level road [N], ``front_transfer`` and ``rear_transfer`` the load that moves from the left
    to the right wheel of the axle per lateral acceleration [N s2/m], ``roll_per_acceleration`` the roll angle
    per lateral acceleration [rad s2/m], ``tyre_model`` the place in `TYRE_MODELS`, ``sliding_share`` and
    ``stribeck_speed`` those of the LuGre tyre, ``full_stretch`` the slip of a tyre that uses 7/8 of its grip,
    in units of friction times load over cornering stiffness, ``low_speed_damping`` the time by which the rate
    of a tyre's deflection counts beside the deflection itself at standstill [s], ``rolling_hold`` the rolling
    resistance of one wheel per speed at standstill [N s/m].
    """

    mass: float
    yaw_inertia: float
    gravity: float
    wheel_x: PerWheel
    wheel_y: PerWheel
    front_load: float
    rear_load: float
    front_transfer: float
    rear_transfer: float
    roll_per_acceleration: float
    front_roll_steer: float
    rear_roll_steer: float
    tyre_model: int
    cornering_stiffness: float
    longitudinal_stiffness: float
    adhesion_reduction: float
    magic_shape: float
    magic_curvature: float
    sliding_share: float
    stribeck_speed: float
    full_stretch: float
    friction_circle: bool
    relaxation_length: float
    low_speed_damping: float
    rolling_hold: float
    air_density: float
    side_area: float
    airflow_angles: Table
    side_force_coefficients: Table
    aerodynamic_centre: float


def constants(parameters: VehicleParameters) -> Constants:
    """Work out the constants of the model.

    Parameters
    ----------
    parameters
        The vehicle.

    Returns
    -------
    Constants
        Loads after thesis sec. 2.6, load transfer after eq. 2.6 and 2.7, roll after eq. 2.8.
    """
    p = parameters
    length, weight = p.wheelbase, p.mass * p.gravity
    front_transfer, rear_transfer = _load_transfers(p)
    return Constants(
        mass=p.mass,
        yaw_inertia=p.yaw_inertia,
        gravity=p.gravity,
        wheel_x=p.wheel_x,
        wheel_y=p.wheel_y,
        front_load=0.5 * weight * p.cg_to_rear_axle / length,
        rear_load=0.5 * weight * p.cg_to_front_axle / length,
        front_transfer=front_transfer,
        rear_transfer=rear_transfer,
        roll_per_acceleration=p.sprung_mass * p.roll_arm / _net_roll_stiffness(p),
        front_roll_steer=p.front_roll_steer,
        rear_roll_steer=p.rear_roll_steer,
        tyre_model=TYRE_MODELS.index(p.tyre_model),
        cornering_stiffness=p.cornering_stiffness,
        longitudinal_stiffness=p.longitudinal_stiffness,
        adhesion_reduction=p.adhesion_reduction,
        magic_shape=p.magic_shape,
        magic_curvature=p.magic_curvature,
        sliding_share=p.lugre_sliding_share,
        stribeck_speed=p.lugre_stribeck_speed,
        full_stretch=_full_stretch(p),
        friction_circle=p.friction_circle,
        relaxation_length=p.relaxation_length,
        low_speed_damping=_critical_damping(p),
        rolling_hold=0.25 * p.mass / HOLDING_TIME,
        air_density=p.air_density,
        side_area=p.side_area,
        airflow_angles=p.airflow_angles,
        side_force_coefficients=p.side_force_coefficients,
        aerodynamic_centre=p.aerodynamic_centre,
    )


def _net_roll_stiffness(p: VehicleParameters) -> float:
    return p.roll_stiffness - p.sprung_mass * p.gravity * p.roll_arm


def _load_transfers(p: VehicleParameters) -> tuple[float, float]:
    if not p.load_transfer:
        return 0.0, 0.0
    front_stiffness = p.front_roll_stiffness_share * p.roll_stiffness
    rear_stiffness = p.roll_stiffness - front_stiffness
    arm = p.roll_arm / _net_roll_stiffness(p)
    front = front_stiffness * arm + p.cg_to_rear_axle / p.wheelbase * p.front_roll_centre_height
    rear = rear_stiffness * arm + p.cg_to_front_axle / p.wheelbase * p.rear_roll_centre_height
    return p.sprung_mass * front / p.front_track, p.sprung_mass * rear / p.rear_track


def _full_stretch(p: VehicleParameters) -> float:
    if p.tyre_model == 'magic_formula':
        return magic_formula.full_stretch(p.magic_shape, p.magic_curvature)
    stretches = {'dugoff': dugoff.FULL_STRETCH, 'brush': brush.FULL_STRETCH, 'lugre': lugre.FULL_STRETCH}
    return stretches[p.tyre_model]


def _critical_damping(p: VehicleParameters) -> float:
    # Four tyre springs C / sigma under the mass: damping c C / sigma is critical at c = 2 / omega.
    lateral_stiffness = 4.0 * p.cornering_stiffness / p.relaxation_length
    return 2.0 * math.sqrt(p.mass / lateral_stiffness)
