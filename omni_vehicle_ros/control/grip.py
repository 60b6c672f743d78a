"""What the controllers reckon that tyres can do: Dugoff's law, quasi-static loads, a friction estimate."""

import math

from omni_vehicle_ros.model.constants import constants
from omni_vehicle_ros.model.loads import roll_angle, roll_steer_angles, vertical_loads
from omni_vehicle_ros.model.tyres.dugoff import lateral_force, second_critical_slip
from omni_vehicle_ros.parameters import VehicleParameters
from omni_vehicle_ros.wheels import PerWheel, per_wheel


class Grip:
    """The tyres of a vehicle on a road of estimated friction.

    Parameters
    ----------
    vehicle
        Loads, roll and tyres.
    friction
        Estimated friction coefficient of the road.
    """

    def __init__(self, vehicle: VehicleParameters, friction: float) -> None:
        self._model = constants(vehicle)
        self._stiffness, self._reduction = vehicle.cornering_stiffness, vehicle.adhesion_reduction
        self._friction = friction
        self._mean_capacity = 0.25 * friction * vehicle.mass * vehicle.gravity

    def capacities(self, lateral_acceleration: float) -> PerWheel:
        """Return friction times load of every tyre at a lateral acceleration [N] (thesis eq. 2.6, 2.7)."""
        model = self._model
        loads = vertical_loads(lateral_acceleration, model.front_load, model.rear_load, model)
        return per_wheel(lambda i: self._friction * loads[i])

    def roll_steer(self, lateral_acceleration: float) -> PerWheel:
        """Return what roll adds to the steer angles at a lateral acceleration [rad] (thesis eq. 2.8)."""
        return roll_steer_angles(roll_angle(lateral_acceleration, self._model), self._model)

    def side_force(self, slip: float, speed: float, capacity: float) -> float:
        """Return the side force of a tyre [N].

        Parameters
        ----------
        slip
            Side-slip angle [rad].
        speed
            Of the wheel over ground [m/s], >= 0.
        capacity
            Friction times load, or what traction leaves of it [N].
        """
        along, across = speed * math.cos(slip), -speed * math.sin(slip)
        return lateral_force(along, across, capacity, self._stiffness, self._reduction)

    def slip_limit(self, speed: float) -> float:
        """Return half the slip of a mean tyre's largest side force [rad]; it gives more than 93 % of that.

        Parameters
        ----------
        speed
            Along the wheel [m/s].
        """
        return 0.5 * second_critical_slip(speed, self._mean_capacity, self._stiffness, self._reduction)


def traction_share(wanted: PerWheel, present: PerWheel, room: PerWheel) -> float:
    """Return the largest share of added forces, 0 to 1, that leaves every tyre within its room.

    Parameters
    ----------
    wanted
        Added forces [N].
    present
        Forces that are there already [N].
    room
        Largest force of each tyre along its heading, to either side [N].
    """
    shares = (
        max(room[i] - math.copysign(1.0, wanted[i]) * present[i], 0.0) / abs(wanted[i])
        for i in range(4) if wanted[i] != 0.0
    )
    return min(1.0, min(shares, default=1.0))
