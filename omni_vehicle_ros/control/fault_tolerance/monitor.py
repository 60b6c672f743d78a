"""Watches the four wheel modules: what they do against what sound ones would."""

import math
from typing import NamedTuple

from omni_vehicle_ros.control.fault_tolerance.actuator_twin import ActuatorTwin
from omni_vehicle_ros.control.fault_tolerance.condition import SOUND, Condition, DriveFault, SteerFault, WheelCondition
from omni_vehicle_ros.control.fault_tolerance.drive_check import STANDS, TORQUE_TOLERANCE, DriveCheck
from omni_vehicle_ros.control.fault_tolerance.steering_check import ANGLE_TOLERANCE, SteeringCheck, lateness
from omni_vehicle_ros.control.fault_tolerance.word_check import SETTLING
from omni_vehicle_ros.control.freshness import NANOSECONDS
from omni_vehicle_ros.control.health import ERROR, WARN, Note
from omni_vehicle_ros.control.motion import motion_of_twist
from omni_vehicle_ros.control.odometry import measured_twist, rolling_twist
from omni_vehicle_ros.control.wheel_module import Trim
from omni_vehicle_ros.model.kinematics import Twist, wheel_velocities
from omni_vehicle_ros.parameters import VehicleParameters, WheelModuleParameters
from omni_vehicle_ros.wheels import WHEELS, PerWheel, per_wheel

# A wheel slower than this tells no direction [m/s].
_SLOWEST = 1.0

# A longer gap between two cycles tells nothing about the actuators [cycles].
_LONGEST_GAP = 20

# Age of an answer that is in time; cycles in a row without one that say that a module can't be judged.
_TIMELY = 2
_UNJUDGED = 200

_SOUND = SOUND.wheels[0]

# Time over which trims are averaged: far slower than side-slip control [s].
_TRIM_TIME = 1.0


class Measured(NamedTuple):
    """What joint_states say of the wheels: steer angles [rad], wheel speeds [rad/s], drive torques [N m]."""

    steer_angle: PerWheel
    wheel_speed: PerWheel
    torque: PerWheel


class Heard(NamedTuple):
    """What a wheel module and its trimmer have said since the last cycle.

    Attributes
    ----------
    begun
        Whether the module has ever said anything.
    silent
        Whether it says nothing though it should.
    age
        Age of what it has said last [ns].
    trim
        The trim that came in, if any.
    """

    begun: bool
    silent: bool = False
    age: int = 0
    trim: Trim | None = None


class ModuleMonitor:
    """Says what is wrong with the four wheel modules, by what they measure and what they were told.

    Parameters
    ----------
    vehicle
        Places and radius of the wheels.
    module
        The actuators of a sound module.
    control_period
        Time from one cycle to the next [s].
    trim_limit
        Largest steer angle that a trim adds [rad].
    """

    def __init__(
        self, vehicle: VehicleParameters, module: WheelModuleParameters, control_period: float, trim_limit: float
    ) -> None:
        self._vehicle = vehicle
        self._wheels = per_wheel(lambda i: _WheelMonitor(i, module, control_period, trim_limit))
        self._told: _Told | None = None
        self._now: int | None = None
        self._condition = SOUND

    def told(self, stamp: int, twist: Twist, steer_angle: PerWheel, torque: PerWheel) -> None:
        """Note the set-points of a cycle, and the motion that they belong to."""
        self._told = _Told(stamp, twist, steer_angle, torque)

    def update(self, stamp: int, measured: Measured, heard: tuple[Heard, Heard, Heard, Heard]) -> Condition:
        """Take one cycle and return what is wrong.

        Parameters
        ----------
        stamp
            Of the cycle [ns]; the same one again gives the same answer.
        measured
            At its begin.
        heard
            What the modules said of the cycle before; fl, fr, rl, rr.
        """
        if stamp == self._now:
            return self._condition
        told, self._now = self._told, stamp
        if not all(map(math.isfinite, (*measured.steer_angle, *measured.wheel_speed))):
            return self._condition
        watched = self._wheels
        if told is None:
            for wheel, angle in zip(watched, measured.steer_angle, strict=True):
                wheel.begin_at(angle)
            return self._condition
        ground = _Ground(self._vehicle, told.twist, measured)
        wheels = per_wheel(lambda i: watched[i].update(stamp, told, heard[i], measured, ground))
        fl, fr, rl, rr = watched
        trims, offsets = (fl.trim, fr.trim, rl.trim, rr.trim), (fl.offset, fr.offset, rl.offset, rr.offset)
        self._condition = Condition(wheels, measured.torque, trims, offsets)
        return self._condition

    @property
    def notes(self) -> list[Note]:
        """What is wrong, wheel by wheel."""
        return [
            (level, f'{name} {text}')
            for name, wheel, now in zip(WHEELS, self._wheels, self._condition.wheels, strict=True)
            for level, text in wheel.says(now)
        ]


class _Told(NamedTuple):
    """What the wheels were told: stamp [ns], motion, steer angles [rad], drive torques [N m]."""

    stamp: int
    twist: Twist
    steer_angle: PerWheel
    torque: PerWheel


class _Ground:
    """How the places of the wheels move over ground; worked out only where it matters.

    Wheels that stand may be locked, and are left out. The two or more that roll tell it together with the motion that
    all were told; one alone may as well spin, and tells nothing of the others.
    """

    def __init__(self, vehicle: VehicleParameters, told: Twist, measured: Measured) -> None:
        self._vehicle, self._told, self._angles = vehicle, told, measured.steer_angle
        radius, rates = vehicle.wheel_radius, measured.wheel_speed
        self.speed: PerWheel = (radius * rates[0], radius * rates[1], radius * rates[2], radius * rates[3])
        self._rolling = [abs(speed) >= STANDS for speed in self.speed]

    def along(self, wheel: int) -> float:
        """Return how fast a wheel moves along its heading [m/s]."""
        if self._rolling[wheel] or sum(self._rolling) < 2:
            return self.speed[wheel]
        ahead, left = self._velocity(wheel)
        return ahead * math.cos(self._angles[wheel]) + left * math.sin(self._angles[wheel])

    def direction(self, wheel: int) -> float | None:
        """Return in which direction a wheel moves [rad], as the others that roll tell it; None if it hardly moves."""
        weights = per_wheel(lambda i: float(self._rolling[i] and i != wheel))
        if sum(weights) < 2.0:
            return None
        twist = rolling_twist(self.speed, self._angles, self._vehicle, weights)
        ahead, left = wheel_velocities(twist, self._vehicle)[wheel]
        return math.atan2(left, ahead) if math.hypot(ahead, left) > _SLOWEST else None

    def _velocity(self, wheel: int) -> tuple[float, float]:
        guess = motion_of_twist(*self._told, 0.5 * self._vehicle.wheelbase)
        if guess is None:
            return 0.0, 0.0
        weights = per_wheel(lambda i: float(self._rolling[i]))
        twist = measured_twist(self.speed, self._angles, guess[0], self._vehicle, weights)
        return wheel_velocities(twist, self._vehicle)[wheel]


class _WheelMonitor:
    """One wheel."""

    def __init__(self, wheel: int, module: WheelModuleParameters, control_period: float, trim_limit: float) -> None:
        self._wheel = wheel
        self._module, self._period, self._trim_limit = module, control_period, trim_limit
        self._lateness = lateness(control_period)
        self._step = round(control_period * NANOSECONDS)
        self._timely, self._unjudged = self._lateness, 0
        self._gain = 1.0 - math.exp(-control_period / _TRIM_TIME)
        self._delay = math.ceil(module.steer_delay / control_period)
        self._before = 0.0
        self._last_trim = self.trim = 0.0
        self._begin()

    def _begin(self) -> None:
        self._twin: ActuatorTwin | None = None
        self._settling = self._alike = 0
        self._steering, self._drive = SteeringCheck(self._lateness), DriveCheck(self._lateness)

    def begin_at(self, angle: float) -> None:
        """Note where the wheel points before anybody has told it anything [rad]."""
        self._before = angle

    def update(self, now: int, told: _Told, heard: Heard, measured: Measured, ground: _Ground) -> WheelCondition:
        wheel, (begun, silent, age, trim), told_at = self._wheel, heard, told.stamp
        angle, torque = measured.steer_angle[wheel], measured.torque[wheel]
        before, self._before = self._before, angle
        self._last_trim = trim.steer_angle if trim else self._last_trim
        self.trim += self._gain * (self._last_trim - self.trim)
        cycles = (now - told_at) // self._step
        if not begun or silent or not 0 < cycles <= _LONGEST_GAP:
            self._begin()
            return WheelCondition(silent=silent)
        if self._twin is None:
            self._twin = ActuatorTwin(self._module, self._period, self._trim_limit, before)
            self._begin_to_settle()
        if cycles > self._lateness:
            self._begin_to_settle()
        set_angle, set_torque = told.steer_angle[wheel], told.torque[wheel]
        expected_angle, expected_torque = self._twin.update(told_at, set_angle, set_torque, trim)
        for cycle in range(1, cycles):
            stamp = told_at + cycle * self._step
            expected_angle, expected_torque = self._twin.update(stamp, set_angle, set_torque, None)
        if self._settling:
            self._settle(angle - expected_angle, torque - expected_torque)
            return WheelCondition(self._steering.fault, self._drive.fault)
        # What came late, or followed on what did, is no measure of an actuator.
        self._timely = self._timely + 1 if cycles == 1 and age <= _TIMELY * self._step else 0
        if self._timely < self._lateness:
            self._unjudged += 1
            return WheelCondition(self._steering.fault, self._drive.fault)
        self._unjudged = 0
        steer = self._steering.update(angle, expected_angle, lambda: ground.direction(wheel))
        drive = self._drive.update(torque, expected_torque, ground.speed[wheel], ground.along(wheel))
        return _SOUND if steer is SteerFault.NONE and drive is DriveFault.NONE else WheelCondition(steer, drive)

    def _begin_to_settle(self) -> None:
        """Not judge the wheel until its twin is where it is.

        A twin does not know what was under way to its wheel when it began. When that is through, delay after, both
        are told the same, and come nearer and nearer.
        """
        self._settling, self._alike = self._delay + SETTLING, -self._delay

    def _settle(self, angle: float, torque: float) -> None:
        near = abs(angle) <= ANGLE_TOLERANCE and abs(torque) <= TORQUE_TOLERANCE
        self._alike = self._alike + 1 if near else min(self._alike + 1, 0)
        self._settling = 0 if self._alike > self._lateness else self._settling - 1

    @property
    def offset(self) -> float:
        """By how much the wheel is off its set-points, where that is constant [rad]."""
        return self._steering.offset

    def says(self, now: WheelCondition) -> list[Note]:
        if now is _SOUND and self._unjudged < _UNJUDGED:
            return []
        if now.silent:
            return [(ERROR, 'wheel module is silent')]
        texts = []
        if now.steer is not SteerFault.NONE:
            at, limit = self._steering.at, ANGLE_TOLERANCE
            texts.append(f'steering {now.steer.value}, at {at:.3f} rad: more than {limit:g} rad from its set-points')
        if now.drive is DriveFault.LOCKED:
            texts.append('wheel is locked: it stands where it should roll')
        elif now.drive is not DriveFault.NONE:
            at, limit = self._drive.at, TORQUE_TOLERANCE
            texts.append(f'drive {now.drive.value}, at {at:.0f} N m: more than {limit:g} N m from its set-points')
        notes = [(ERROR, text) for text in texts]
        if self._unjudged >= _UNJUDGED:
            notes.append((WARN, 'wheel module answers late, again and again: its actuators are not judged'))
        return notes
