"""One wheel module: set-point and trim in, what its actuators do out."""

from omni_vehicle_ros.components.component import ERROR, NANOSECONDS, WARN, Output, Reporter
from omni_vehicle_ros.components.joints import module_joints, wheel_joints
from omni_vehicle_ros.control.failing_actuator import FailingDrive, FailingSteer
from omni_vehicle_ros.control.fault_tolerance.order_check import OrderCheck
from omni_vehicle_ros.control.health import Note, health
from omni_vehicle_ros.control.wheel_module import Setpoint, Trim
from omni_vehicle_ros.control.wheel_module import WheelModule as Law
from omni_vehicle_ros.faults import Fault
from omni_vehicle_ros.interface import PLANT, SIDE_SLIP_CONTROLLER
from omni_vehicle_ros.messages import Flag, Joints, Value
from omni_vehicle_ros.parameters import WheelModuleParameters
from omni_vehicle_ros.wheels import WHEELS

START_UP = 2 * NANOSECONDS
"""Simulated time that the first trim may take [ns]."""


class WheelModule:
    """The controller and the actuators of one wheel.

    Parameters
    ----------
    wheel
        One of the four names.
    parameters
        The actuators, and when it stops trusting its command.
    control_period
        Time from one cycle to the next [s].
    trim_limit
        Largest steer angle that a trim adds [rad].
    trimmed
        Whether a side-slip controller answers in every cycle.
    """

    beat = 'joint_states'

    def __init__(
        self,
        wheel: str,
        parameters: WheelModuleParameters,
        control_period: float,
        trim_limit: float,
        *,
        trimmed: bool = True,
        name: str | None = None,
    ) -> None:
        self.name = name or f'/{wheel}/wheel_module'
        self.wheel = wheel
        self._command, trim = f'{wheel}/command', f'{wheel}/trim'
        self.sources: tuple[str, ...] = (self._command, trim) if trimmed else (self._command,)
        self._index = WHEELS.index(wheel)
        self._steer, self._drive = FailingSteer(parameters), FailingDrive(parameters)
        self._law = Law(parameters, control_period, trim_limit, self._steer, self._drive)
        self._begun: int | None = None
        self._awaits_trim = trimmed
        self._wheel_speed = self._steer_angle = 0.0
        self._malformed = ''
        self._deaf = (
            f'no joint_states from {PLANT} for module_timeout, {parameters.module_timeout:g} s: angle held, no torque'
        )
        cycle = round(control_period * NANOSECONDS)
        self._orders = {topic: OrderCheck(topic, cycle) for topic in (self._command, trim)}
        self._reporter = Reporter(self.name)

    def receive(self, topic: str, value: Value, now: int) -> None:
        """Take the measured joints, a set-point, a trim or an emergency stop."""
        if not isinstance(value, Joints):
            if isinstance(value, Flag):
                self._law.emergency_stop(value.data)
        elif topic == 'joint_states':
            joints = wheel_joints(value, self._index)
            if joints is not None:
                self._steer_angle, self._wheel_speed = joints
                self._law.start_at(self._steer_angle)
                self._steer.measured = self._steer_angle
        elif not len(value.position) == len(value.velocity) == len(value.effort) == 2:
            self._malformed = f'{topic} needs position, velocity and effort of steer and drive; the last one is kept'
        elif not self._orders[topic].take(value.stamp, now):
            return
        elif topic == self._command:
            self._law.command(Setpoint(value.stamp, value.position[0], value.velocity[1], value.effort[1]))
        else:
            self._awaits_trim = False
            self._law.trim(Trim(value.stamp, value.position[0], value.effort[1]))

    def fail(self, fault: Fault, now: int) -> None:
        """Let an actuator of this wheel fail, or be ok again."""
        if fault.component == f'{self.wheel}/steering':
            self._steer.fail(fault)
        elif fault.component == f'{self.wheel}/drive':
            self._drive.fail(fault)

    def step(self, stamp: int, missing: tuple[str, ...] = ()) -> list[Output]:
        """Return what the actuators do from ``stamp`` [ns] to the next cycle."""
        angle, rate, torque = self._law.update(stamp, self._wheel_speed)
        outputs = self._reporter.report(stamp, self._law.status.with_notes(*self._own_notes(stamp)))
        joints = module_joints(self.wheel, stamp, angle, rate, self._wheel_speed, torque)
        outputs.append(Output(f'{self.wheel}/state', joints))
        return outputs

    def rest(self, stamp: int) -> list[Output]:
        """Return what the actuators do when the module acts no more: they hold the angle, without torque."""
        self._law.rest()
        joints = module_joints(self.wheel, stamp, self._steer_angle, 0.0, self._wheel_speed, 0.0)
        return [Output(f'{self.wheel}/state', joints)]

    def fall_back(self, stamp: int) -> list[Output]:
        """Rest, as there is no beat after ``stamp`` [ns]: without the speed of the wheel it can't be braked."""
        return self._reporter.report(stamp, health([(ERROR, self._deaf)], '')) + self.rest(stamp)

    def _own_notes(self, stamp: int) -> list[Note]:
        """Return what is wrong beside what the law says."""
        notes = [(WARN, self._malformed)] if self._malformed else []
        self._malformed = ''
        for order in self._orders.values():
            if wrong := order.wrong():
                notes.append((WARN, wrong))
        if self._begun is None or stamp < self._begun:
            self._begun = stamp
        if self._awaits_trim and stamp - self._begun >= START_UP:
            notes.append((WARN, f'no trim from {SIDE_SLIP_CONTROLLER} yet: set-point alone'))
        return notes
