"""The controller of one wheel: it follows its set-points, and looks after its wheel when they stop."""

import math
from typing import NamedTuple

from omni_vehicle_ros.control.actuator import DriveActuator, SteerActuator
from omni_vehicle_ros.control.failing_actuator import FailingDrive, FailingSteer
from omni_vehicle_ros.control.freshness import NANOSECONDS, CommandMonitor, Freshness
from omni_vehicle_ros.control.health import ERROR, WARN, Health, Note, health
from omni_vehicle_ros.interface import ICR_STEERING, SIDE_SLIP_CONTROLLER
from omni_vehicle_ros.parameters import WheelModuleParameters


class Setpoint(NamedTuple):
    """What a wheel is asked for: stamp [ns], steer angle [rad], wheel speed [rad/s], drive torque [N m]."""

    stamp: int
    steer_angle: float
    wheel_speed: float
    torque: float


class Trim(NamedTuple):
    """What is added to a set-point: stamp [ns], steer angle [rad], drive torque [N m]."""

    stamp: int
    steer_angle: float
    torque: float


# Age up to which a command counts in an emergency stop [ns].
_ALIVE = NANOSECONDS // 10

# Speed of a wheel at rest, which may be held against a slope [rad/s].
_AT_REST = 0.1

NO_TRIM = Trim(0, 0.0, 0.0)


class ModuleState(NamedTuple):
    """What the actuators do over the coming cycle.

    Attributes
    ----------
    steer_angle
        Steer angle at its begin [rad].
    steer_rate
        Mean steer rate [rad/s].
    drive_torque
        Mean drive torque [N m].
    """

    steer_angle: float
    steer_rate: float
    drive_torque: float


class WheelModule:
    """One wheel module.

    Before its first command it is passive: it keeps the angle and gives no torque. A command older than
    ``module_timeout`` is stale: the module holds the angle that it has then and brakes its own wheel to rest.
    A fresh command resumes at once. A trim that is too old is dropped, its angle and its torque; what a trim
    steers is bounded, whoever says it. What is not finite is not taken.

    In an emergency stop it brakes with ``emergency_torque`` at least, whatever it is commanded, and trusts a
    command no longer than 0.1 s, whatever ``module_timeout`` says.

    Parameters
    ----------
    parameters
        Actuators and time-out.
    control_period
        Time from one cycle to the next [s].
    trim_limit
        Largest steer angle that a trim adds, to either side [rad].
    steer, drive
        The actuators; healthy ones if none are given.
    """

    def __init__(
        self,
        parameters: WheelModuleParameters,
        control_period: float,
        trim_limit: float,
        steer: SteerActuator | FailingSteer | None = None,
        drive: DriveActuator | FailingDrive | None = None,
    ) -> None:
        self._parameters = parameters
        self._period, self._trim_limit = control_period, trim_limit
        self._steer = steer or SteerActuator(parameters)
        self._drive = drive or DriveActuator(parameters)
        self._commands = CommandMonitor(parameters.module_timeout)
        self._trims = CommandMonitor(parameters.module_timeout)
        self._new_command: Setpoint | None = None
        self._new_trim: Trim | None = None
        self._command = Setpoint(0, 0.0, 0.0, 0.0)
        self._trim = NO_TRIM
        self._held_angle: float | None = None
        self._now: int | None = None
        self._refused: dict[str, str] = {}
        self._notes: list[Note] = []
        self._state = Freshness.NEVER
        self._stop = False

    def emergency_stop(self, stop: bool) -> None:
        """Take a message of emergency_stop; here the last one counts."""
        self._stop = stop

    def start_at(self, angle: float) -> None:
        """Take over a wheel that points somewhere [rad]; once it acts, it knows by itself."""
        if self._now is None:
            self._steer.rest_at(angle)

    def rest(self) -> None:
        """Begin anew, from where the wheel points then, without torque: what was commanded before is forgotten."""
        self._commands.forget()
        self._trims.forget()
        self._new_command = self._new_trim = self._held_angle = self._now = None
        self._drive.rest_at(0.0)

    def command(self, command: Setpoint) -> None:
        """Take a set-point; one with NaN or inf is refused and the last good one kept."""
        if self._finite('command', command.steer_angle, command.wheel_speed, command.torque):
            self._new_command = command

    def trim(self, trim: Trim) -> None:
        """Take a trim; one with NaN or inf is refused and the last good one kept."""
        if self._finite('trim', trim.steer_angle, trim.torque):
            self._new_trim = trim

    def update(self, now: int, wheel_speed: float) -> ModuleState:
        """Act on the present cycle.

        Parameters
        ----------
        now
            Stamp of the cycle [ns].
        wheel_speed
            Measured speed of the wheel [rad/s].
        """
        self._accept(now)
        self._notes = [(ERROR, text) for text in self._refused.values()] if self._refused else []
        if not math.isfinite(wheel_speed):
            self._notes.append((ERROR, f'wheel speed {wheel_speed} is not finite: no brake torque without it'))
            wheel_speed = 0.0
        self._state = self._commands.state(now)
        alive = self._state is Freshness.FRESH and not (self._stop and self._commands.age(now) > _ALIVE)
        steer_angle, torque = self._follow(now) if alive else self._hold(now, wheel_speed)
        if self._stop:
            self._notes.append((ERROR, 'emergency stop: wheel braked'))
            torque = self._brake(torque, wheel_speed)
        angle, rate = self._steer.update(now, steer_angle, self._period)
        return ModuleState(angle, rate, self._drive.update(torque, self._period))

    @property
    def status(self) -> Health:
        """How the module is doing, as of the last update."""
        doing = 'no command yet: passive' if self._state is Freshness.NEVER else 'following its set-points'
        return health(self._notes, doing)

    def _finite(self, source: str, *values: float) -> bool:
        if all(map(math.isfinite, values)):
            self._refused.pop(source, None)
            return True
        bad = ', '.join(str(value) for value in values if not math.isfinite(value))
        self._refused[source] = f'{source} refused: {bad} is not finite; the last good one holds'
        return False

    def _accept(self, now: int) -> None:
        if self._now is not None and now < self._now:
            self._commands.forget()
            self._trims.forget()
        self._now = now
        if self._new_command is not None:
            self._command, self._new_command = self._new_command, None
            self._commands.received(self._command.stamp, now)
        if self._new_trim is not None:
            self._trim, self._new_trim = self._new_trim, None
            self._trims.received(self._trim.stamp, now)

    def _follow(self, now: int) -> tuple[float, float]:
        self._held_angle = None
        trim = self._fresh_trim(now)
        added = trim.steer_angle
        if abs(added) > self._trim_limit:
            added = math.copysign(self._trim_limit, added)
            self._notes.append((WARN, f'trim is beyond trim_limit, {self._trim_limit:g} rad: clipped'))
        angle, torque = self._command.steer_angle + added, self._command.torque + trim.torque
        if abs(angle) > self._parameters.steer_limit:
            limit = self._parameters.steer_limit
            self._notes.append((WARN, f'steer angle and trim are beyond steer_limit, {limit:g} rad: clipped'))
        if abs(torque) > self._parameters.drive_torque_limit:
            limit = self._parameters.drive_torque_limit
            self._notes.append((WARN, f'torque is beyond drive_torque_limit, {limit:g} N m: clipped'))
        if self._commands.warning:
            self._notes.append((WARN, f'command: {self._commands.warning}'))
        return angle, torque

    def _fresh_trim(self, now: int) -> Trim:
        if self._trims.fresh(now):
            return self._trim
        if self._trims.state(now) is Freshness.STALE:
            limit = self._parameters.module_timeout
            self._notes.append(
                (WARN, f'no trim from {SIDE_SLIP_CONTROLLER} for module_timeout, {limit:g} s: set-point alone')
            )
        return NO_TRIM

    def _brake(self, torque: float, wheel_speed: float) -> float:
        """Return a torque that brakes as much as the commanded one, and enough [N m]; at rest, what holds."""
        if abs(wheel_speed) < _AT_REST:
            return torque
        own = min(self._parameters.emergency_torque, self._parameters.brake_gain * abs(wheel_speed))
        return min(torque, -own) if wheel_speed > 0.0 else max(torque, own)

    def _hold(self, now: int, wheel_speed: float) -> tuple[float, float]:
        if self._held_angle is None:
            self._held_angle = self._steer.reach(now)
        if self._state is Freshness.NEVER and not self._stop:
            return self._held_angle, 0.0
        limit = self._parameters.module_timeout or _ALIVE / NANOSECONDS
        self._notes.append(
            (ERROR, f'no command from {ICR_STEERING} for module_timeout, {limit:g} s: angle held, wheel braked')
        )
        return self._held_angle, -self._parameters.brake_gain * wheel_speed
