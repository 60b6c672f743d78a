"""Vertical loads and roll, quasi-static (thesis sec. 2.6-2.8, B.4-B.8).

Past wheel lift the model has no roll dynamics to tell the truth with: the inner wheel stays at 0, the outer one
carries the whole axle, and the moment beyond that is dropped. Every axle keeps its load.
"""

from omni_vehicle_ros.model.arithmetic import cos_sin
from omni_vehicle_ros.model.constants import Constants
from omni_vehicle_ros.wheels import PerWheel

LIFT_TOLERANCE = 1e-9  # share of the static load


def static_loads(constants: Constants, bank: float = 0.0) -> PerWheel:
    """Return the loads at standstill or straight on [N], before any lateral acceleration.

    Parameters
    ----------
    constants
        The vehicle.
    bank
        Bank angle of the road [rad]; loads scale with its cosine (thesis sec. 4.4.1).
    """
    share = max(0.0, cos_sin(bank)[0])
    front, rear = constants.front_load * share, constants.rear_load * share
    return front, front, rear, rear


def vertical_loads(acceleration: float, front: float, rear: float, constants: Constants) -> PerWheel:
    """Return the wheel loads [N], none below 0; each axle's sum does not depend on the acceleration.

    Parameters
    ----------
    acceleration
        Lateral acceleration by the tyre forces [m/s2]; positive in a left turn, loads the right wheels.
    front, rear
        Static load of one front and of one rear wheel [N]; see `static_loads`.
    constants
        The vehicle; load transfer as in thesis eq. 2.6 and 2.7, in SI.
    """
    return shifted_loads(constants.front_transfer * acceleration, constants.rear_transfer * acceleration, front, rear)


def shifted_loads(front_shift: float, rear_shift: float, front: float, rear: float) -> PerWheel:
    """Return the wheel loads [N], none below 0, after some load has moved from the left to the right wheels.

    Parameters
    ----------
    front_shift, rear_shift
        Load that moves on the front and on the rear axle [N].
    front, rear
        Static load of one front and of one rear wheel [N]; see `static_loads`.
    """
    front_shift = max(-front, min(front, front_shift))
    rear_shift = max(-rear, min(rear, rear_shift))
    return front - front_shift, front + front_shift, rear - rear_shift, rear + rear_shift


def lifted(loads: PerWheel, constants: Constants) -> tuple[bool, bool, bool, bool]:
    """Return which wheels carry nothing any more: a rollover warning.

    Parameters
    ----------
    loads
        Wheel loads [N].
    constants
        The vehicle.
    """
    front, rear = LIFT_TOLERANCE * constants.front_load, LIFT_TOLERANCE * constants.rear_load
    return loads[0] <= front, loads[1] <= front, loads[2] <= rear, loads[3] <= rear


def roll_angle(acceleration: float, constants: Constants) -> float:
    """Return the roll angle [rad], positive (to the right) in a left turn (thesis eq. 2.8).

    Parameters
    ----------
    acceleration
        Lateral acceleration by the tyre forces [m/s2].
    constants
        The vehicle.
    """
    return constants.roll_per_acceleration * acceleration


def roll_steer_angles(roll: float, constants: Constants) -> PerWheel:
    """Return what a roll angle adds to the steer angles [rad] (thesis sec. 2.8).

    Parameters
    ----------
    roll
        Roll angle [rad].
    constants
        The vehicle.
    """
    front, rear = constants.front_roll_steer * roll, constants.rear_roll_steer * roll
    return front, front, rear, rear
