"""The limit speed of the turn that a run was, if it was one at a held speed about an ICR that stands still."""

import math
from typing import TYPE_CHECKING

import numpy as np

from omni_vehicle_ros.analysis.topics import friction, has, truth
from omni_vehicle_ros.bags import Bag
from omni_vehicle_ros.errors import CommandError
from omni_vehicle_ros.model.dynamics import Environment
from omni_vehicle_ros.parameters import VehicleParameters
from omni_vehicle_ros.wheels import PerWheel, per_wheel

if TYPE_CHECKING:
    from omni_vehicle_ros.model.steady_turn import Limit
    from omni_vehicle_ros.model.turning import Turning

ALIGNED = 1e-4  # rad, of the wheels with what the ICR wants
NEAR = 0.02  # of the forward speed, that of the wheels across it


def turn_limit(bag: Bag, vehicle: VehicleParameters) -> 'Limit | None':
    """Return the limit of the turn that a run ends in; None if it is of another kind.

    It must have held its forward speed, above 0, to the last bit; the driver must have asked for an ICR beside the
    centre of gravity; and the wheels must stand in the end as that ICR wants, without a controller's trim.

    Parameters
    ----------
    bag
        A bag with odom.
    vehicle
        The vehicle of the run.
    """
    held = _held(bag, vehicle)
    if held is None:
        return None
    from omni_vehicle_ros.model.steady_turn import limit_speed

    return limit_speed(vehicle, held.radius, held.environment)


def ends_in_a_turn(bag: Bag, vehicle: VehicleParameters) -> bool:
    """Tell whether the motion at the end of a run whose limit is known is that of a stable steady turn.

    Just past a fold a vehicle creeps past where the turn was, more slowly than anything settles.
    """
    from omni_vehicle_ros.model.kinematics import Twist

    held, odom = _held(bag, vehicle), truth(bag, 'odom')
    end = Twist(float(odom.vx[-1]), float(odom.vy[-1]), float(odom.yaw_rate[-1]))
    turn = held.near(end) if held else None
    if held is None or turn is None or not turn.stable:
        return False
    gaps = turn.twist.vy - end.vy, held.wheelbase * (turn.twist.r - end.r)
    return max(map(abs, gaps)) <= NEAR * end.vx


def _held(bag: Bag, vehicle: VehicleParameters) -> 'Turning | None':
    """Return the vehicle as it stands in the end of a turn whose limit is known, None of a run of another kind."""
    vx = truth(bag, 'odom').vx
    if not (vx[0] > 0.0 and np.all(vx == vx[0]) and has(bag, 'driver/icr') and has(bag, 'joint_states')):
        return None
    icr, angles = bag['driver/icr'], truth(bag, 'joint_states').position[-1, :4]
    x, radius = float(icr.x[-1]), float(icr.y[-1])
    if x != 0.0 or not math.isfinite(radius) or np.all(np.abs(angles) <= ALIGNED):
        return None
    # The compiled physics takes a second to import; a run that needs no limit should not pay for it.
    from omni_vehicle_ros.model.turning import turning

    try:
        held = turning(vehicle, radius, _road(bag))
    except CommandError:
        return None
    return held if np.allclose(angles, held.inputs.steer_angle, rtol=0.0, atol=ALIGNED) else None


def _road(bag: Bag) -> Environment:
    """Return bank, wind and friction in the end."""
    bank = float(bag['environment/bank'].x[-1]) if has(bag, 'environment/bank') else 0.0
    wind = float(bag['environment/wind'].y[-1]) if has(bag, 'environment/wind') else 0.0
    grips: PerWheel = per_wheel(lambda i: float(friction(bag)[1][-1, i]))
    return Environment(bank, wind, grips)
