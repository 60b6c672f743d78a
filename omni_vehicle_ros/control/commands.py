"""Driver commands at the door: what may be followed, what is clamped, and what is refused with the reason.

A refused command raises a `CommandError`; the caller keeps the last good one.
"""

import math
from typing import Literal, NamedTuple, Protocol, cast

from omni_vehicle_ros.control.motion import Motion, length_scale, motion_of_icr, motion_of_twist, twist_of_motion
from omni_vehicle_ros.errors import CommandError
from omni_vehicle_ros.model.kinematics import Steering, steer_angles, wheel_velocities
from omni_vehicle_ros.parameters import SteeringParameters, VehicleParameters
from omni_vehicle_ros.wheels import WHEELS, PerWheel

# A twist slower than this is none [m/s]: the noise of a joystick doesn't swing the wheels.
NO_MOTION = 1e-3

_FRAMES = ('', 'base_link')
_STRAIGHT_WHEELS: PerWheel = (0.0, 0.0, 0.0, 0.0)


class PointCommand(Protocol):
    """An ICR in the plane [m]."""

    @property
    def stamp(self) -> int:
        """When it was said [ns]; 0 means now."""
    @property
    def x(self) -> float:
        """Ahead of the centre of gravity."""
    @property
    def y(self) -> float:
        """To the left of it."""
    @property
    def frame(self) -> str:
        """base_link, or empty."""


class TwistCommand(Protocol):
    """A twist in the plane, or a speed with ``vx`` alone [m/s, rad/s]."""

    @property
    def stamp(self) -> int:
        """When it was said [ns]; 0 means now."""
    @property
    def vx(self) -> float:
        """Forward."""
    @property
    def vy(self) -> float:
        """To the left."""
    @property
    def yaw_rate(self) -> float:
        """Anticlockwise."""
    @property
    def frame(self) -> str:
        """base_link, or empty."""


class WrenchCommand(Protocol):
    """Total traction and yaw moment [N, N m]."""

    @property
    def stamp(self) -> int:
        """When it was said [ns]; 0 means now."""
    @property
    def fx(self) -> float:
        """Traction (+) or brake (-)."""
    @property
    def tz(self) -> float:
        """Yaw moment, anticlockwise."""
    @property
    def frame(self) -> str:
        """base_link, or empty."""


class SpeedDemand(NamedTuple):
    """Signed speed of the centre of gravity [m/s], and what had to be clamped."""

    speed: float
    warning: str


class TractionDemand(NamedTuple):
    """Total force [N] and yaw moment [N m], and what had to be clamped."""

    force: float
    yaw_moment: float
    warning: str


class TwistDemand(NamedTuple):
    """Direction (None: no motion) and signed magnitude [m/s] of a motion, and what had to be clamped."""

    motion: Motion | None
    magnitude: float
    warning: str


def steer(motion: Motion, reference: PerWheel, vehicle: VehicleParameters, steering: SteeringParameters) -> Steering:
    """Return steer angles and wheel speeds of a motion with a magnitude of 1 m/s.

    Parameters
    ----------
    motion
        Its direction.
    reference
        Steer angles to stay near to [rad].
    vehicle, steering
        Geometry; rule and limit.
    """
    twist = twist_of_motion(motion, 1.0, length_scale(vehicle))
    rule = cast("Literal['road', 'omni']", steering.steering_rule)
    return steer_angles(twist, reference, steering.steer_limit, vehicle, rule)


def check_icr(command: PointCommand, vehicle: VehicleParameters, steering: SteeringParameters) -> Motion:
    """Return the direction of motion about a commanded ICR.

    Raises
    ------
    CommandError
        Not finite, in another frame, at the centre of gravity, or out of the wheels' reach.
    """
    _check_numbers('driver/icr', command.frame, x=command.x, y=command.y)
    try:
        motion = motion_of_icr(command.x, command.y, length_scale(vehicle), steering.straight_radius)
    except CommandError as error:
        raise CommandError(f'driver/icr: {error}') from None
    _check_reach('driver/icr', motion, vehicle, steering)
    return motion


def check_speed(command: TwistCommand, steering: SteeringParameters) -> SpeedDemand:
    """Return the commanded speed, clamped to the largest one.

    Raises
    ------
    CommandError
        Not finite or in another frame.
    """
    _check_numbers('driver/speed', command.frame, vx=command.vx)
    limit = steering.maximum_speed
    if abs(command.vx) <= limit:
        return SpeedDemand(command.vx, '')
    warning = _clamped('driver/speed', command.vx, 'maximum_speed', limit, 'm/s')
    return SpeedDemand(math.copysign(limit, command.vx), warning)


def check_traction(command: WrenchCommand, vehicle: VehicleParameters, steering: SteeringParameters) -> TractionDemand:
    """Return the commanded traction, clamped to what the wheels may give.

    Raises
    ------
    CommandError
        Not finite or in another frame.
    """
    _check_numbers('driver/traction', command.frame, fx=command.fx, tz=command.tz)
    most_force = steering.maximum_drive_force / max(steering.drive_shares)
    most_moment = steering.maximum_drive_force * (vehicle.front_track + vehicle.rear_track)
    source, limit = 'driver/traction', 'the reach of maximum_drive_force'
    warnings = []
    if abs(command.fx) > most_force:
        warnings.append(_clamped(source, command.fx, limit, most_force, 'N'))
    if abs(command.tz) > most_moment:
        warnings.append(_clamped(source, command.tz, limit, most_moment, 'N m'))
    return TractionDemand(
        min(max(command.fx, -most_force), most_force),
        min(max(command.tz, -most_moment), most_moment),
        '; '.join(warnings),
    )


def check_cmd_vel(
    command: TwistCommand, vehicle: VehicleParameters, steering: SteeringParameters, source: str = 'cmd_vel'
) -> TwistDemand:
    """Return direction and magnitude of a commanded twist; too fast a one is slowed down and keeps its ICR.

    Raises
    ------
    CommandError
        Not finite, in another frame, or out of the wheels' reach.
    """
    vx, vy, yaw_rate = command.vx, command.vy, command.yaw_rate
    _check_numbers(source, command.frame, vx=vx, vy=vy, yaw_rate=yaw_rate)
    found = motion_of_twist(vx, vy, yaw_rate, length_scale(vehicle))
    if found is None or abs(found[1]) < NO_MOTION:
        return TwistDemand(None, 0.0, '')
    motion, magnitude = found
    _check_reach(source, motion, vehicle, steering)
    limit, speed = steering.maximum_speed, math.hypot(vx, vy)
    if speed <= limit:
        return TwistDemand(motion, magnitude, '')
    slowed = math.copysign(limit / math.hypot(motion.ux, motion.uy), magnitude)
    return TwistDemand(motion, slowed, _clamped(source, speed, 'maximum_speed', limit, 'm/s'))


def _check_numbers(source: str, frame: str, **numbers: float) -> None:
    if frame not in _FRAMES:
        raise CommandError(f'{source}: frame {frame!r} is not base_link; transform it first, or leave the frame empty')
    for name, number in numbers.items():
        if not math.isfinite(number):
            raise CommandError(f'{source}: {name} = {number} must be a finite number')


def _clamped(source: str, value: float, name: str, limit: float, unit: str) -> str:
    return f'{source}: {value:g} {unit} is beyond {name}, {limit:g} {unit}: clamped to it'


def _check_reach(source: str, motion: Motion, vehicle: VehicleParameters, steering: SteeringParameters) -> None:
    """Refuse a motion that asks more of a wheel than its range."""
    reachable = steer(motion, _STRAIGHT_WHEELS, vehicle, steering).reachable
    if all(reachable):
        return
    road = steering.steering_rule == 'road'
    half_track = 0.5 * max(vehicle.front_track, vehicle.rear_track)
    side = motion.ux * length_scale(vehicle) / motion.ur if motion.ur else math.inf
    if road and abs(side) < half_track:
        raise CommandError(
            f'{source}: ICR {side:.3f} m to the side is nearer than {half_track:.3f} m, half the track, which '
            'steering_rule road allows; move it out or set steering_rule omni'
        )
    wheel = reachable.index(False)
    angle = _needed_angle(motion, wheel, vehicle, road)
    raise CommandError(
        f'{source}: {WHEELS[wheel]} would have to steer by {angle:.3f} rad, beyond steer_limit, '
        f'{steering.steer_limit:g} rad; move the ICR away from it'
    )


def _needed_angle(motion: Motion, wheel: int, vehicle: VehicleParameters, road: bool) -> float:
    ahead, left = wheel_velocities(twist_of_motion(motion, 1.0, length_scale(vehicle)), vehicle)[wheel]
    return math.atan2(left, ahead if road else abs(ahead))
