"""ICR steering: from what the driver wants to the set-points of the four wheels."""

import math
from typing import NamedTuple

from omni_vehicle_ros.control.commands import PointCommand, TractionDemand, TwistCommand, WrenchCommand, steer
from omni_vehicle_ros.control.driver import Demand, Driver
from omni_vehicle_ros.control.emergency_stop import EmergencyBrake, EmergencyStop
from omni_vehicle_ros.control.fault_tolerance.condition import SOUND, Condition, DriveFault
from omni_vehicle_ros.control.fault_tolerance.reaction import DECELERATION, Reaction
from omni_vehicle_ros.control.freshness import NANOSECONDS, Freshness
from omni_vehicle_ros.control.health import ERROR, WARN, Health, health
from omni_vehicle_ros.control.motion import (
    STRAIGHT,
    Motion,
    angle_between,
    length_scale,
    magnitude_on_the_way,
    nearest,
    opposite,
    turn_towards,
    twist_of_motion,
)
from omni_vehicle_ros.control.odometry import magnitude_along, measured_twist, sideways_speed
from omni_vehicle_ros.control.speed import SpeedController
from omni_vehicle_ros.control.traction import (
    STOPPING_RATE,
    clipped,
    moment_forces,
    stopping_forces,
    traction_forces,
)
from omni_vehicle_ros.model.kinematics import Twist
from omni_vehicle_ros.parameters import SteeringParameters, VehicleParameters
from omni_vehicle_ros.wheels import WHEELS, PerWheel, as_four, per_wheel, scaled

# Actuator lag and side-slip trims are within this of the set-points [rad], and no reason to slow down.
_ALIGNED = 0.35

# With a wheel so far off [rad] the vehicle would be dragged, not driven: it waits.
_MISALIGNED = 0.8

# Wheel speeds of a vehicle at rest [m/s].
_REST_SPEED = 0.05

# Below this an emergency stop ends as any stop does, and then holds the vehicle where it stands [m/s].
_CREEPING = 0.3

# A wheel slower than this share of the fastest is near the ICR: where it points hardly matters.
_SLOW_WHEEL = 0.05

# Across their headings over along them, in the mean of the wheels: from here on the vehicle slides sideways, and
# so long; and the least speed across [m/s].
_SLIDING = math.tan(0.6)
_SLIDING_ON = math.tan(0.25)
_SLIDING_SPEED = 0.7

# Share of the speed at which it began to slide that the vehicle drives afterwards, and the angle between directions
# of motion from which on another one is commanded [rad].
_AFTER_SLIDING = 0.8
_OTHER_MOTION = 0.2

# A magnitude below this is rest when it is to become 0 [m/s].
_REST = 0.01

# No vehicle is faster [m/s]; keeps the sums below finite.
_FASTEST = 1e3

LONGEST_STEP = 20
"""A longer gap between two cycles counts as so many periods, and the speed starts anew from what is measured."""

_ZERO: PerWheel = (0.0, 0.0, 0.0, 0.0)
STILL = Twist(0.0, 0.0, 0.0)


class Setpoints(NamedTuple):
    """Set-points of the four wheels.

    Attributes
    ----------
    steer_angle
        [rad].
    wheel_speed
        [rad/s].
    torque
        Drive torque [N m].
    twist
        The rigid motion that they belong to; no motion before any command.
    """

    steer_angle: PerWheel
    wheel_speed: PerWheel
    torque: PerWheel
    twist: Twist


class IcrSteering:
    """Turns driver commands into one rigid motion, and that into set-points; never raises on a command.

    The direction of the motion turns towards the commanded one at a limited rate, and its magnitude follows
    at a limited acceleration, so in every cycle all wheels share one ICR. Steer angles are held where
    there is no direction: at zero twist, and before any command those that were measured first. An ICR at
    speed 0 does steer. A stale command ramps the speed to 0 and holds the angles.

    Parameters
    ----------
    vehicle, steering
        Geometry and mass; limits and gains.
    control_period
        Time from one cycle to the next [s].
    """

    def __init__(self, vehicle: VehicleParameters, steering: SteeringParameters, control_period: float) -> None:
        self._vehicle = vehicle
        self._steering = steering
        self._period = control_period
        self._driver = Driver(vehicle, steering)
        self._speed_controller = SpeedController(vehicle, steering)
        self._stop = EmergencyStop()
        self._emergency_brake = EmergencyBrake(vehicle, steering)
        self._reaction = Reaction(vehicle, steering)
        self._measured_angles = self._measured_speeds = _ZERO
        self._start()

    def _start(self) -> None:
        self._driver.forget()
        self._speed_controller.reset()
        self._reaction.forget()
        self._condition = SOUND
        self._now: int | None = None
        self._motion: Motion | None = None
        self._magnitude: float | None = None
        self._twist = STILL
        self._sliding = False
        self._too_fast: tuple[float, Motion] | None = None
        self._angles: PerWheel | None = None
        self._setpoints = Setpoints(_ZERO, _ZERO, _ZERO, STILL)
        self._notes: list[tuple[int, str]] = []

    def icr(self, command: PointCommand, now: int) -> None:
        """Take a message of driver/icr that came in at ``now`` [ns]."""
        self._driver.icr(command, now)

    def speed(self, command: TwistCommand, now: int) -> None:
        """Take a message of driver/speed that came in at ``now`` [ns]."""
        self._driver.speed(command, now)

    def traction(self, command: WrenchCommand, now: int) -> None:
        """Take a message of driver/traction that came in at ``now`` [ns]."""
        self._driver.traction(command, now)

    def cmd_vel(self, command: TwistCommand, now: int) -> None:
        """Take a message of cmd_vel that came in at ``now`` [ns]."""
        self._driver.cmd_vel(command, now)

    def teleop(self, command: TwistCommand, now: int) -> None:
        """Take a message of teleop/cmd_vel that came in at ``now`` [ns]."""
        self._driver.teleop(command, now)

    def emergency_stop(self, stop: bool) -> None:
        """Take a message of emergency_stop."""
        self._stop.say(stop)

    def update(
        self, now: int, steer_angles: PerWheel, wheel_speeds: PerWheel, condition: Condition = SOUND
    ) -> Setpoints:
        """Return the set-points of a cycle.

        Parameters
        ----------
        now
            Stamp of the cycle [ns]. The same stamp again gives the same answer; a clock that jumped back
            starts anew, with no command.
        steer_angles
            Measured steer angles [rad].
        wheel_speeds
            Measured wheel speeds [rad/s].
        condition
            What is wrong with the wheel modules.
        """
        if now == self._now:
            return self._setpoints
        back = self._now is not None and now < self._now
        if back:
            self._start()
        dt = self._period if self._now is None else (now - self._now) / NANOSECONDS
        ahead = dt > LONGEST_STEP * self._period
        if ahead:
            self._speed_controller.reset()
            self._magnitude, dt = None, LONGEST_STEP * self._period
        self._now = now
        self._measure(steer_angles, wheel_speeds)
        if back or ahead:
            self._notes.append((WARN, 'the clock went back: no command holds' if back else 'the clock jumped ahead'))
        self._condition = condition
        wanted = self._allowed(self._driver.demand(now), now)
        demand = self._reaction.limit(wanted, condition, self._measured_angles, self._measured_speeds)
        sense = self._turn(demand.motion, dt)
        rolling = as_four([float(wheel.drive is not DriveFault.LOCKED) for wheel in condition.wheels])
        self._twist = measured_twist(
            self._measured_speeds, self._measured_angles, self._motion or STRAIGHT, self._vehicle, rolling
        )
        self._setpoints = self._follow(demand, sense, dt)
        return self._setpoints

    @property
    def status(self) -> Health:
        """How ICR steering is doing, as of the last update."""
        now, source = self._now or 0, self._driver.source
        state = self._driver.state(now)
        doing = f'following {source}' if source else 'no speed command yet: speed 0'
        values = ('source', source or 'none'), ('state', state.name.lower())
        return health(self._driver.notes(now) + self._reaction.notes + self._notes, doing, values)

    def _measure(self, steer_angles: PerWheel, wheel_speeds: PerWheel) -> None:
        self._notes = []
        if all(map(math.isfinite, (*steer_angles, *wheel_speeds))):
            radius = self._vehicle.wheel_radius
            self._measured_angles = steer_angles
            self._measured_speeds = clipped(scaled(radius, wheel_speeds), _FASTEST)
        else:
            self._notes.append((ERROR, 'a measured steer angle or wheel speed is not finite: the last good ones count'))
        if self._angles is None:
            limit = self._steering.steer_limit
            self._angles = per_wheel(lambda i: min(max(self._measured_angles[i], -limit), limit))

    def _allowed(self, demand: Demand, now: int) -> Demand:
        """Return what may be done of a demand: nothing but to stand in an emergency stop."""
        fresh = self._driver.state(now) is Freshness.FRESH
        standing = max(map(abs, self._measured_speeds)) < _REST_SPEED
        if not self._stop.update(standing=standing, rest_commanded=fresh and demand.rest):
            return demand
        self._notes.append((ERROR, f'emergency stop: {self._stop.remedy}'))
        return Demand(None, 0.0)

    def _turn(self, target: Motion | None, dt: float) -> float:
        """Turn the motion towards a target; return -1 if the motion is to be driven backwards for it, else 1."""
        if target is None:
            return 1.0
        if self._motion is None:
            # Wheels that point ahead begin there; from any other angles the set-points go over at once.
            self._motion = STRAIGHT if max(map(abs, self._measured_angles)) < _ALIGNED else target
        sense = 1.0 if self._steering.steering_rule == 'road' else nearest(target, self._motion)
        # A vehicle at rest need not pass through all the motions in between: the wheels turn first, then it goes.
        rate = 0.0 if self._at_rest() else self._steering.motion_rate_limit
        aim = target if sense > 0.0 else opposite(target)
        self._motion = turn_towards(self._motion, aim, rate * dt if rate else math.inf)
        return sense

    def _at_rest(self) -> bool:
        return (
            self._steering.alignment_slowdown
            and not self._magnitude
            and max(map(abs, self._measured_speeds)) < _REST_SPEED
        )

    def _follow(self, demand: Demand, sense: float, dt: float) -> Setpoints:
        halting = self._stop.engaged and max(map(abs, self._measured_speeds)) > _CREEPING
        if self._motion is None or self._angles is None:
            return self._halt(_ZERO) if halting else self._rest(dt)
        steering = steer(self._motion, self._angles, self._vehicle, self._steering)
        steering = self._reaction.steer(steering, self._motion, self._angles)
        self._angles = steering.angles
        if halting:
            return self._halt(steering.speeds)
        if not all(steering.reachable):
            wheel, limit = WHEELS[steering.reachable.index(False)], self._steering.steer_limit
            self._notes.append((WARN, f'{wheel} would pass steer_limit, {limit:g} rad, on the way: speed goes to 0'))
            demand = demand._replace(magnitude=0.0, traction=None)
        magnitude = demand.magnitude
        if demand.traction is not None:
            if demand.traction.force <= 0.0 or abs(self._measured_magnitude(steering.speeds)) <= demand.limit:
                return self._pull(demand.traction, steering.speeds, sense)
            magnitude = demand.limit
        if demand.motion is not None:
            magnitude = magnitude_on_the_way(magnitude, self._motion, demand.motion)
        magnitude = self._after_sliding(magnitude, demand.motion)
        return self._drive(sense * magnitude, steering.speeds, dt)

    def _halt(self, unit_speeds: PerWheel) -> Setpoints:
        """Brake in an emergency, with the angles held."""
        self._speed_controller.reset()
        self._magnitude = None
        forces = self._emergency_brake.forces(self._twist, self._measured_speeds)
        return self._set(self._measured_magnitude(unit_speeds), unit_speeds, forces)

    def _rest(self, dt: float) -> Setpoints:
        """Keep the angles; before any command give no torque, at zero twist stand."""
        never = self._driver.state(self._now or 0) is Freshness.NEVER and not self._stop.engaged
        forces = _ZERO if never else self._speed_controller.stand(self._measured_speeds, dt)
        return self._set(0.0, _ZERO, forces)

    def _pull(self, traction: TractionDemand, unit_speeds: PerWheel, sense: float) -> Setpoints:
        self._speed_controller.reset()
        self._magnitude = None
        ahead, speeds = per_wheel(lambda i: sense * unit_speeds[i]), self._measured_speeds
        along = traction_forces(traction.force, ahead, speeds, self._vehicle, self._steering)
        turning = moment_forces(traction.yaw_moment, self._measured_angles, self._vehicle)
        forces = clipped(per_wheel(lambda i: along[i] + turning[i]), self._steering.maximum_drive_force)
        return self._set(self._measured_magnitude(unit_speeds), unit_speeds, forces)

    def _drive(self, wanted: float, unit_speeds: PerWheel, dt: float) -> Setpoints:
        speeds, measured = self._measured_speeds, self._measured_magnitude(unit_speeds)
        before = measured if self._magnitude is None else self._magnitude
        if self._slides(before):
            self._speed_controller.reset()
            self._magnitude = math.copysign(min(abs(measured), abs(before)), before)
            return self._set(self._magnitude, unit_speeds, self._brake())
        most = self._largest_magnitude(unit_speeds)
        # While the motion turns, the limit of the fastest wheel may come down faster than the speed may
        # change.
        before = min(max(before, -most), most)
        if abs(wanted) > most:
            fastest = self._steering.maximum_wheel_speed
            text = f'a wheel would be faster than maximum_wheel_speed, {fastest:g} m/s: all are slowed down'
            self._notes.append((WARN, text))
        aligned = self._alignment(unit_speeds)
        if aligned < 1.0 and abs(measured) > _SLIDING_SPEED:
            text = f'a wheel is more than {_ALIGNED:g} rad off its set-point: the vehicle slows down'
            self._notes.append((WARN, text))
        wanted = min(max(wanted, -most), most) * aligned
        limit = self._steering.acceleration_limit or (0.0 if self._condition.sound else DECELERATION)
        magnitude = self._magnitude = _ramp(before, wanted, limit, dt)
        if magnitude == 0.0 or (wanted * magnitude <= 0.0 and STOPPING_RATE * abs(magnitude) < limit):
            forces = self._speed_controller.stand(speeds, dt)
        else:
            forces = self._speed_controller.drive(magnitude, measured, (magnitude - before) / dt, unit_speeds, dt)
        return self._set(magnitude, unit_speeds, forces)

    def _largest_magnitude(self, unit_speeds: PerWheel) -> float:
        """Return the magnitude at which the fastest wheel is at its limit: scaling all keeps the ICR."""
        return self._steering.maximum_wheel_speed / (max(map(abs, unit_speeds)) or 1.0)

    def _measured_magnitude(self, unit_speeds: PerWheel) -> float:
        most = self._largest_magnitude(unit_speeds)
        return min(max(magnitude_along(self._twist, self._motion or STRAIGHT, self._vehicle), -most), most)

    def _slides(self, magnitude: float) -> bool:
        """Return whether the wheels go across their headings rather than along them, as in a spin."""
        across, along = sideways_speed(self._twist, self._measured_angles, self._vehicle)
        share, before = _SLIDING_ON if self._sliding else _SLIDING, self._sliding
        self._sliding = across > max(share * along, _SLIDING_SPEED)
        if self._sliding and not before:
            self._too_fast = _AFTER_SLIDING * abs(magnitude), self._motion or STRAIGHT
        if self._sliding:
            self._notes.append((WARN, 'the vehicle slides sideways: its wheels brake until they roll again'))
        return self._sliding

    def _after_sliding(self, magnitude: float, motion: Motion | None) -> float:
        """Return what may be driven of a magnitude: not again what made the vehicle slide."""
        if self._too_fast is None or self._sliding:
            return magnitude
        most, slid = self._too_fast
        if abs(magnitude) <= most or motion is None or angle_between(motion, slid) > _OTHER_MOTION:
            self._too_fast = None
            return magnitude
        self._notes.append((WARN, 'slower after a slide, until a slower or another motion is commanded'))
        return math.copysign(most, magnitude)

    def _brake(self) -> PerWheel:
        mass = self._vehicle.mass
        rate = self._steering.acceleration_limit
        most = 0.25 * mass * rate if rate else self._steering.maximum_drive_force
        return stopping_forces((most,) * 4, self._measured_speeds, mass)

    def _alignment(self, unit_speeds: PerWheel) -> float:
        """Return 1 if the wheels point where they should, down to 0 if one of them is far off."""
        if not self._steering.alignment_slowdown or self._angles is None:
            return 1.0
        errors = [abs(angle - told) for angle, told in zip(self._measured_angles, self._angles, strict=True)]
        if max(errors) <= _ALIGNED:
            return 1.0
        relevant, wheels = _SLOW_WHEEL * max(map(abs, unit_speeds)), self._condition.wheels
        judged = (error for i, error in enumerate(errors) if abs(unit_speeds[i]) >= relevant and wheels[i].steers)
        error = max(judged, default=0.0)
        return min(max((_MISALIGNED - error) / (_MISALIGNED - _ALIGNED), 0.0), 1.0)

    def _set(self, magnitude: float, unit_speeds: PerWheel, forces: PerWheel) -> Setpoints:
        radius = self._vehicle.wheel_radius
        forces = self._reaction.drive(forces, unit_speeds)
        return Setpoints(
            self._reaction.told(self._angles or _ZERO),
            as_four([magnitude * speed / radius for speed in unit_speeds]),
            scaled(radius, forces),
            twist_of_motion(self._motion or STRAIGHT, magnitude, length_scale(self._vehicle)),
        )


def _ramp(value: float, target: float, limit: float, dt: float) -> float:
    """Move towards a target at a limited rate, coming to rest on the way to 0 and to the other side.

    The deceleration fades with the speed: a brake that lags would else go on past standstill.
    """
    if limit == 0.0:
        return target
    step = limit * dt
    if value != 0.0 and value * target <= 0.0:
        if abs(value) < _REST:
            return 0.0
        target, step = 0.0, min(step, STOPPING_RATE * abs(value) * dt)
    return min(max(target, value - step), value + step)
