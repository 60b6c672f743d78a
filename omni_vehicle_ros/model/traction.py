"""Sharing traction and brake among the wheels (thesis sec. 2.10, 3.2.2, 4.3, 4.6)."""

from omni_vehicle_ros.model.tyre import limited_drive_force
from omni_vehicle_ros.parameters import VehicleParameters
from omni_vehicle_ros.wheels import PerWheel, per_wheel

FOUR_WHEEL_DRIVE: PerWheel = (0.25, 0.25, 0.25, 0.25)
FRONT_WHEEL_DRIVE: PerWheel = (0.5, 0.5, 0.0, 0.0)
REAR_WHEEL_DRIVE: PerWheel = (0.0, 0.0, 0.5, 0.5)

# A wheel may take half of its quarter of the momentum in a cycle: turning about any centre, where the yaw
# inertia makes less of it than the mass does, the speed still falls to 0 from one side.
STOPPING_SHARE = 0.125


def share_force(force: float, shares: PerWheel) -> PerWheel:
    """Return the drive force of each wheel [N].

    Parameters
    ----------
    force
        Total traction (+) or brake (-) [N].
    shares
        Share of each wheel; they sum to 1.
    """
    return per_wheel(lambda i: force * shares[i])


def yaw_moment_forces(moment: float, parameters: VehicleParameters) -> PerWheel:
    """Return equal and opposite forces of the left and the right wheels that make a yaw moment [N].

    Each axle makes Mz = T / 2 (right - left) (thesis sec. 2.10), exact for wheels that point straight ahead.

    Parameters
    ----------
    moment
        Yaw moment, anticlockwise [N m].
    parameters
        The vehicle.
    """
    force = moment / (parameters.front_track + parameters.rear_track)
    return -force, force, -force, force


def within_grip(forces: PerWheel, loads: PerWheel, friction: PerWheel) -> PerWheel:
    """Return the drive forces, each within +- friction times load [N] (thesis eq. 4.1, 4.2).

    Parameters
    ----------
    forces
        Wanted drive forces [N].
    loads
        Vertical loads [N].
    friction
        Friction coefficient under each wheel.
    """
    return per_wheel(lambda i: limited_drive_force(forces[i], friction[i] * loads[i]))


def brake_forces(brake: PerWheel, wheel_speeds: PerWheel, mass: float, period: float) -> PerWheel:
    """Return brake forces that oppose each wheel's motion and never turn it round [N].

    A force that is held for a control cycle must not reverse the vehicle within it, so near standstill it is
    limited to what takes half of the wheel's momentum: the vehicle comes to rest without chatter.

    Parameters
    ----------
    brake
        Wanted size of the brake force of each wheel [N], >= 0.
    wheel_speeds
        Signed speed of each wheel along its heading [m/s].
    mass
        Mass of the vehicle [kg].
    period
        Time for which the force is held [s], > 0.
    """
    firmness = STOPPING_SHARE * mass / period
    return per_wheel(lambda i: limited_drive_force(-firmness * wheel_speeds[i], brake[i]))
