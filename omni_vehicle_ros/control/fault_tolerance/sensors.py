"""Whether the sensors of the side-slip controller agree, and what stands in for one that does not.

The yaw rate is measured three times, by odometry, by the IMU and by the wheels, so that the one that disagrees with
the other two is at fault. So are the speeds of the wheels, by odometry, joint_states and the sensor of side slip. Its
slips are compared with odometry and the steer angles: which of these is wrong nobody knows, and it is taken for the
one. A sensor that repeats itself is seen when the others change, odometry by its position as soon as the wheels roll.
"""

import math
from collections.abc import Collection
from enum import Enum
from typing import NamedTuple

from omni_vehicle_ros.control.fault_tolerance.debounce import Debounce
from omni_vehicle_ros.control.fault_tolerance.steering_check import LIFTED_AFTER, SEEN_AFTER
from omni_vehicle_ros.control.health import ERROR, WARN, Note
from omni_vehicle_ros.control.motion import STRAIGHT, length_scale, motion_of_twist
from omni_vehicle_ros.control.odometry import measured_twist
from omni_vehicle_ros.control.trim import NO_TRIMS, Sensed, Trims
from omni_vehicle_ros.model.constants import constants
from omni_vehicle_ros.model.kinematics import Twist, wheel_velocities
from omni_vehicle_ros.model.loads import roll_angle, roll_steer_angles
from omni_vehicle_ros.parameters import VehicleParameters
from omni_vehicle_ros.wheels import PerWheel, per_wheel

YAW_RATE_TOLERANCE = 0.1
"""Difference of two measured yaw rates that is no fault [rad/s]."""

SPEED_TOLERANCE = 0.5
"""Difference of a wheel's speed and that of its place on the vehicle that is no fault [m/s], and ..."""

SPEED_SHARE = 0.2
"""... per speed: tyres that drive or brake slip."""

ACCELERATION_TOLERANCE = 8.0
"""Difference of two lateral accelerations that is no fault [m/s2]: a banked road and wind are no acceleration."""

SLIP_TOLERANCE = 0.03
"""Difference of two side-slip angles that is no fault [rad]."""

SLIP_STEP = 0.03
"""Change of a side-slip angle in one cycle that is no fault, if it comes again and again [rad]."""

FADE = 0.3
"""Time in which the trims go to 0, or come back [s]."""

# Slower than this, wheels say nothing about side slip, and whether odometry moves [m/s].
_SLOWEST = 2.0
_MOVES = 0.3

# Torque that no wheel slips by, be it on ice [N m].
_FREE = 50.0


class Sensor(str, Enum):
    """A sensor, by its topic."""

    ODOM = 'odom'
    IMU = 'imu'
    SIDE_SLIP = 'tyres/side_slip'


SENSORS = tuple(sensor.value for sensor in Sensor)


class Seen(NamedTuple):
    """What the sensors say in one cycle.

    Attributes
    ----------
    sensed
        What a controller would take of it.
    yaw_rate
        Of the IMU [rad/s].
    place
        Position by odometry [m].
    rolling
        Speeds of the wheels by joint_states [m/s].
    """

    sensed: Sensed
    yaw_rate: float
    place: tuple[float, float]
    rolling: PerWheel


class SensorMonitor:
    """Says which sensors can't be believed, puts others in their place, and takes the trims back where none is left.

    Parameters
    ----------
    vehicle
        Places of the wheels.

    Attributes
    ----------
    faulty
        The sensors that can't be believed.
    """

    def __init__(self, vehicle: VehicleParameters) -> None:
        self.faulty: tuple[Sensor, ...] = ()
        self._vehicle = vehicle
        self._debounce = {sensor: Debounce(SEEN_AFTER, LIFTED_AFTER) for sensor in Sensor}
        self._why = dict.fromkeys(Sensor, '')
        self._before: Seen | None = None
        self._share = 1.0
        self._blind = False
        self._model = constants(vehicle)

    def update(self, seen: Seen, silent: Collection[str], *, blind: bool = False) -> Sensed:
        """Take one cycle and return what a controller may believe.

        Parameters
        ----------
        seen
            What the sensors say.
        silent
            Topics of sensors that said nothing.
        blind
            Whether joint_states can't be believed: nothing is left then to compare with.
        """
        self._blind = blind
        wrong = {} if blind else self._disagreements(seen)
        wrong.update(self._alone(seen.sensed.side_slip))
        if silent:
            wrong.update((sensor, 'says nothing') for sensor in Sensor if sensor.value in silent)
        self._why.update(wrong)
        self.faulty = tuple([sensor for sensor, debounce in self._debounce.items() if debounce.update(sensor in wrong)])
        self._before = seen
        return self._stand_in(seen)

    def contradicts_joints(self, seen: Seen) -> bool:
        """Return whether odometry and the sensor of side slip say of most wheels another speed than joint_states.

        Parameters
        ----------
        seen
            What the sensors say.
        """
        wrong = 0
        for told, along, rolling in zip(seen.sensed.wheel_speed, self._along(seen), seen.rolling, strict=True):
            wrong += abs(told - rolling) > SPEED_TOLERANCE and abs(told - along) < abs(rolling - along)
        return wrong > 2

    @property
    def notes(self) -> list[Note]:
        """What is wrong."""
        notes = [(ERROR, f'{sensor.value} {self._why[sensor]}') for sensor in self.faulty]
        if self._blind:
            notes.append((ERROR, "joint_states can't be believed"))
        if self._lost:
            notes.append((WARN, 'too few sensors can be believed: no trims'))
        return notes

    def fade(self, trims: Trims, dt: float) -> Trims:
        """Return the share of trims that the sensors are good for.

        Parameters
        ----------
        trims
            Of the control law.
        dt
            Time since the last cycle [s].
        """
        goal = 0.0 if self._lost else 1.0
        self._share += min(max(goal - self._share, -dt / FADE), dt / FADE)
        if self._share == 1.0:
            return trims
        if self._share == 0.0:
            return NO_TRIMS
        share = self._share
        return Trims(
            per_wheel(lambda i: share * trims.steer_angle[i]), per_wheel(lambda i: share * trims.torque[i])
        )

    @property
    def _lost(self) -> bool:
        return self._blind or len(self.faulty) > 1

    def _disagreements(self, seen: Seen) -> dict[Sensor, str]:
        """Return which sensors disagree with the others, and in what."""
        wrong: dict[Sensor, str] = {}
        twist, sensed = seen.sensed.twist, seen.sensed
        if not all(map(math.isfinite, (*twist, *seen.rolling, *sensed.steer_angle, seen.yaw_rate))):
            return wrong
        if abs(seen.yaw_rate - twist.r) > YAW_RATE_TOLERANCE:
            wheels = self._by_wheels(seen).r
            liar = Sensor.IMU if abs(seen.yaw_rate - wheels) > abs(twist.r - wheels) else Sensor.ODOM
            wrong[liar] = f'has another yaw rate than the other sensors, by more than {YAW_RATE_TOLERANCE:g} rad/s'
        elif abs(sensed.lateral_acceleration - twist.vx * twist.r) > ACCELERATION_TOLERANCE:
            wrong[Sensor.IMU] = f'has an acceleration that odometry has not, by {ACCELERATION_TOLERANCE:g} m/s2'
        if self._stands_still(seen):
            wrong[Sensor.ODOM] = 'stands still while the wheels roll'
        elif self._another_speed(seen):
            wrong[Sensor.ODOM] = f'has another speed than the wheels, by more than {SPEED_TOLERANCE:g} m/s'
        elif Sensor.ODOM not in wrong and not self._debounce[Sensor.ODOM].on and self._another_slip(seen):
            wrong[Sensor.SIDE_SLIP] = f'does not fit odom and joint_states, by more than {SLIP_TOLERANCE:g} rad'
        return wrong

    def _alone(self, slips: PerWheel) -> dict[Sensor, str]:
        """Return what is wrong with side slips by themselves."""
        if not all(map(math.isfinite, slips)):
            return {Sensor.SIDE_SLIP: 'has no number'}
        before = self._before.sensed.side_slip if self._before else slips
        for now, then in zip(slips, before, strict=True):
            if abs(now - then) > SLIP_STEP:
                return {Sensor.SIDE_SLIP: f'jumps by more than {SLIP_STEP:g} rad in a cycle'}
        return {}

    def _stands_still(self, seen: Seen) -> bool:
        there = self._before is not None and seen.place == self._before.place
        return there and sorted(map(abs, seen.rolling))[2] > _MOVES

    def _another_speed(self, seen: Seen) -> bool:
        """Return whether most wheels roll at another speed than odometry says of their places.

        Wheels that drive or brake may spin or lock on ice, and tell nothing.
        """
        wrong = 0
        for along, speed, torque in zip(self._along(seen), seen.rolling, seen.sensed.drive_torque, strict=True):
            wrong += abs(torque) < _FREE and abs(along - speed) > SPEED_TOLERANCE + SPEED_SHARE * abs(speed)
        return wrong > 2

    def _along(self, seen: Seen) -> PerWheel:
        """Return how fast the places of the wheels move along these, by odometry [m/s]."""
        velocities, angles = wheel_velocities(seen.sensed.twist, self._vehicle), seen.sensed.steer_angle
        return per_wheel(lambda i: velocities[i][0] * math.cos(angles[i]) + velocities[i][1] * math.sin(angles[i]))

    def _another_slip(self, seen: Seen) -> bool:
        sensed = seen.sensed
        for slip, told, speed, rolling in zip(
            sensed.side_slip, self._slips(sensed), sensed.wheel_speed, seen.rolling, strict=True
        ):
            if abs(rolling) > _SLOWEST and (
                abs(slip - told) > SLIP_TOLERANCE or abs(speed - rolling) > SPEED_TOLERANCE
            ):
                return True
        return False

    def _slips(self, sensed: Sensed) -> PerWheel:
        """Return the side slips by odometry and steer angles [rad], roll steer included.

        It goes by the smaller of two lateral accelerations: a vehicle that slides turns more than it accelerates, and
        an IMU that lies is not to be believed.
        """
        twist, angles = sensed.twist, sensed.steer_angle
        velocities = wheel_velocities(twist, self._vehicle)
        acceleration = min(twist.vx * twist.r, sensed.lateral_acceleration, key=abs)
        roll = roll_steer_angles(roll_angle(acceleration, self._model), self._model)

        def slip(i: int) -> float:
            (ahead, left), angle = velocities[i], angles[i] + roll[i]
            cos, sin = math.cos(angle), math.sin(angle)
            return -math.atan2(left * cos - ahead * sin, abs(ahead * cos + left * sin))

        return per_wheel(slip)

    def _by_wheels(self, seen: Seen) -> Twist:
        told = motion_of_twist(*seen.sensed.commanded, length_scale(self._vehicle))
        return measured_twist(seen.rolling, seen.sensed.steer_angle, told[0] if told else STRAIGHT, self._vehicle)

    def _stand_in(self, seen: Seen) -> Sensed:
        sensed, faulty = seen.sensed, self.faulty
        if len(faulty) != 1:
            return sensed
        if faulty[0] is Sensor.ODOM:
            return sensed._replace(twist=self._by_wheels(seen)._replace(r=seen.yaw_rate))
        if faulty[0] is Sensor.IMU:
            return sensed._replace(lateral_acceleration=sensed.twist.vx * sensed.twist.r)
        return sensed._replace(side_slip=self._slips(sensed), wheel_speed=seen.rolling)
