"""What the vehicle still does with faulty wheel modules: where it may go, how fast, and when it has to stop."""

import math

from omni_vehicle_ros.control.commands import steer
from omni_vehicle_ros.control.driver import Demand
from omni_vehicle_ros.control.fault_tolerance.axle_line import HeldWheel, nearest_motion
from omni_vehicle_ros.control.fault_tolerance.condition import SOUND, Condition, DriveFault, SteerFault, WheelCondition
from omni_vehicle_ros.control.fault_tolerance.forces import Failed, Wheels, made_up
from omni_vehicle_ros.control.health import ERROR, WARN, Note
from omni_vehicle_ros.control.motion import Motion, length_scale, magnitude_on_the_way, twist_of_motion
from omni_vehicle_ros.model.kinematics import Steering, wheel_velocities
from omni_vehicle_ros.parameters import SteeringParameters, VehicleParameters
from omni_vehicle_ros.wheels import WHEELS, PerWheel, per_wheel

DECELERATION = 2.0
"""Of a vehicle that a fault slows down, where acceleration_limit sets none [m/s2]."""

# The vehicle has stopped when no wheel is faster [m/s].
_STOPPED = 0.05

# Wheels of a kind with which the vehicle drives on.
_MOST = {'locked': 0, 'out of control': 0, 'silent': 1, 'swinging freely': 1, 'not steered': 2, 'not driven': 2}

# A motion whose centre of gravity moves less than this share of the magnitude is a spin in place.
_SPIN = 0.3


class Reaction:
    """Changes what the driver wants into what the vehicle can do with its faults.

    A controlled stop holds the angles and brakes at the usual deceleration. It lasts until the fault is gone and the
    driver has asked for a standstill: a vehicle that has stopped by itself does not drive off by itself.

    Parameters
    ----------
    vehicle, steering
        Geometry; limits.
    """

    def __init__(self, vehicle: VehicleParameters, steering: SteeringParameters) -> None:
        self._vehicle, self._steering = vehicle, steering
        self.forget()

    def forget(self) -> None:
        """Begin anew, with no fault."""
        self._why = ''
        self._condition = SOUND
        self._angles: PerWheel = (0.0, 0.0, 0.0, 0.0)
        self._wanted: Motion | None = None
        self._answer: tuple[tuple[Motion, tuple[HeldWheel, ...]], Motion | None] | None = None
        self.notes: list[Note] = []

    def limit(self, demand: Demand, condition: Condition, angles: PerWheel, speeds: PerWheel) -> Demand:
        """Return what is left of a demand.

        Parameters
        ----------
        demand
            What the driver wants.
        condition
            What is wrong with the wheels.
        angles, speeds
            Measured [rad], [m/s].
        """
        self._condition, self._wanted, self.notes = condition, demand.motion, []
        if condition.sound and not self._why:
            return demand
        # Where side-slip control turns the wheels, the ICR is not where the set-points have it: the line is theirs.
        self._angles = per_wheel(lambda i: angles[i] - condition.trim[i])
        self._judge(demand, max(map(abs, speeds)))
        if self._why:
            self.notes.append((ERROR, f'controlled stop, {self._why}: until that is gone and speed 0 is commanded'))
            return Demand(None, 0.0)
        if condition.sound:
            return demand
        return self._slowed(self._turned(demand))

    def steer(self, steering: Steering, motion: Motion, reference: PerWheel) -> Steering:
        """Return the steering of a motion in which wheels that don't steer roll where they point.

        They are told what the driver wants: a wheel that can steer again does, and is seen to.

        Parameters
        ----------
        steering, motion
            If all wheels steered.
        reference
            The set-points before [rad].
        """
        if self._condition.sound:
            return steering
        held = per_wheel(lambda i: self._condition.wheels[i].holds_icr)
        angles = self._angles
        told = reference if self._wanted is None else steer(
            self._wanted, reference, self._vehicle, self._steering
        ).angles
        velocities = wheel_velocities(twist_of_motion(motion, 1.0, length_scale(self._vehicle)), self._vehicle)
        rolling = per_wheel(
            lambda i: velocities[i][0] * math.cos(angles[i]) + velocities[i][1] * math.sin(angles[i])
        )
        return Steering(
            per_wheel(lambda i: told[i] if held[i] else steering.angles[i]),
            per_wheel(lambda i: rolling[i] if held[i] else steering.speeds[i]),
            per_wheel(lambda i: held[i] or steering.reachable[i]),
        )

    def told(self, angles: PerWheel) -> PerWheel:
        """Return what to tell the wheels so that they have these steer angles [rad]."""
        if self._condition.sound:
            return angles
        return per_wheel(lambda i: angles[i] - self._condition.offset[i])

    def drive(self, forces: PerWheel, unit_speeds: PerWheel) -> PerWheel:
        """Return forces that make up for drives that fail [N].

        Parameters
        ----------
        forces
            Along the headings, if all drives were sound [N].
        unit_speeds
            Wheel speeds per magnitude of the motion.
        """
        if self._condition.sound:
            return forces
        failed = per_wheel(lambda i: self._condition.wheels[i].pulls_otherwise)
        if not any(failed):
            return forces
        radius, torque = self._vehicle.wheel_radius, self._condition.torque
        made = Failed(failed, per_wheel(lambda i: torque[i] / radius))
        wheels = Wheels(unit_speeds, self._angles)
        return made_up(forces, made, wheels, self._steering.maximum_drive_force, self._vehicle)

    def _judge(self, demand: Demand, fastest: float) -> None:
        """Begin or end a controlled stop."""
        why = _why_stop(self._condition)
        standstill = demand.magnitude == 0.0 and demand.traction is None and fastest < _STOPPED
        self._why = why or ('' if standstill else self._why)

    def _turned(self, demand: Demand) -> Demand:
        x, y, wheels = self._vehicle.wheel_x, self._vehicle.wheel_y, self._condition.wheels
        held = tuple(HeldWheel(x[i], y[i], self._angles[i]) for i in range(4) if wheels[i].holds_icr)
        if not held or demand.motion is None:
            return demand
        motion = self._nearest(demand.motion, held)
        names = _names([wheel.holds_icr for wheel in wheels])
        if motion is None:
            self.notes.append((ERROR, f'{names} can roll in no motion near the commanded one: the vehicle stops'))
            return Demand(None, 0.0)
        self.notes.append((WARN, f'turning about the point nearest to the ICR that lets {names} roll'))
        magnitude = magnitude_on_the_way(demand.magnitude, motion, demand.motion)
        return demand._replace(motion=motion, magnitude=magnitude)

    def _nearest(self, target: Motion, held: tuple[HeldWheel, ...]) -> Motion | None:
        if self._answer is None or self._answer[0] != (target, held):
            self._answer = (target, held), nearest_motion(target, held, self._reachable, self._vehicle)
        return self._answer[1]

    def _reachable(self, motion: Motion) -> bool:
        able = steer(motion, self._angles, self._vehicle, self._steering).reachable
        return all(can or wheel.holds_icr for can, wheel in zip(able, self._condition.wheels, strict=True))

    def _slowed(self, demand: Demand) -> Demand:
        if all(map(_as_fast, self._condition.wheels)):
            return demand
        speed, acceleration = self._steering.fault_speed, self._steering.fault_lateral_acceleration
        limit = _largest_magnitude(demand.motion, speed, acceleration, self._vehicle)
        if abs(demand.magnitude) <= limit and demand.traction is None:
            return demand
        self.notes.append((WARN, f'slower with a fault: to {speed:g} m/s and {acceleration:g} m/s2 to the side'))
        return demand._replace(magnitude=min(max(demand.magnitude, -limit), limit), limit=limit)


def _as_fast(wheel: WheelCondition) -> bool:
    """Return whether the vehicle may be as fast as without the fault of a wheel: the others pull for a dead one."""
    return wheel in (SOUND.wheels[0], WheelCondition(drive=DriveFault.DEAD))


def _largest_magnitude(motion: Motion | None, speed: float, acceleration: float, vehicle: VehicleParameters) -> float:
    """Return the magnitude at which the vehicle has a speed, or an acceleration to the side, if that is smaller."""
    if motion is None:
        return speed
    along = math.hypot(motion.ux, motion.uy)
    sideways = along * abs(motion.ur) / length_scale(vehicle)
    return min(speed / max(along, _SPIN), math.sqrt(acceleration / sideways) if sideways else math.inf)


def _why_stop(condition: Condition) -> str:
    """Return why the vehicle has to stop; empty if it may drive on."""
    if condition.blind:
        return "joint_states can't be believed"
    wheels = condition.wheels
    kinds = {
        'locked': [wheel.drive is DriveFault.LOCKED for wheel in wheels],
        'out of control': [wheel.steer is SteerFault.ERRATIC for wheel in wheels],
        'silent': [wheel.silent for wheel in wheels],
        'swinging freely': [wheel.steer is SteerFault.FREE for wheel in wheels],
        'not steered': [not wheel.steers for wheel in wheels],
        'not driven': [wheel.pulls_otherwise for wheel in wheels],
    }
    return next((f'{_names(which)} {kind}' for kind, which in kinds.items() if sum(which) > _MOST[kind]), '')


def _names(which: list[bool]) -> str:
    return ' and '.join(wheel for wheel, named in zip(WHEELS, which, strict=True) if named)
