"""ICR steering: driver commands in, set-points of the four wheel modules out."""

import math
from dataclasses import replace

from omni_vehicle_ros.components.component import ERROR, NANOSECONDS, WARN, Output, Reporter
from omni_vehicle_ros.components.joints import ZEROS, VehicleJoints, module_joints, vehicle_joints
from omni_vehicle_ros.control.fault_tolerance.condition import SOUND, Condition
from omni_vehicle_ros.control.fault_tolerance.joint_check import JointCheck
from omni_vehicle_ros.control.fault_tolerance.joint_check import Joints as Measurement
from omni_vehicle_ros.control.fault_tolerance.monitor import Heard, Measured, ModuleMonitor
from omni_vehicle_ros.control.fault_tolerance.word_check import Word, WordCheck
from omni_vehicle_ros.control.icr_steering import LONGEST_STEP, STILL, Setpoints
from omni_vehicle_ros.control.icr_steering import IcrSteering as Law
from omni_vehicle_ros.control.wheel_module import Trim
from omni_vehicle_ros.messages import Flag, Joints, Point, Twist, Value, Wrench
from omni_vehicle_ros.parameters import SteeringParameters, VehicleParameters, WheelModuleParameters
from omni_vehicle_ros.wheels import WHEELS, per_wheel

STATES = tuple(f'{wheel}/state' for wheel in WHEELS)
TRIMS = tuple(f'{wheel}/trim' for wheel in WHEELS)

SILENCE = 0.1
"""After which a module counts as silent where it has no ``module_timeout`` [s]."""

UNBELIEVED = "joint_states can't be believed: they don't fit each other, or not what the wheel modules say"

_JUMPED = 'joint_states comes {:g} s after the last one, not {:g} s: the clock jumped ahead, or cycles were lost'

START_UP = 2 * NANOSECONDS
"""Simulated time that the first state of a module may take [ns]."""


class IcrSteering:
    """Turns what the driver asks for into one rigid motion, and that into four set-points.

    It watches the wheel modules, too: by what they said and did in the cycle before, against what sound ones would
    have.

    Parameters
    ----------
    vehicle, steering
        Geometry; limits.
    module
        The actuators of a sound wheel module; their range is taken to be that of ``steering``.
    control_period
        Time from one cycle to the next [s].
    trim_limit
        Largest steer angle that a trim adds [rad].
    lockstep
        Whether every cycle is served, so that stamps are one period apart; in real time beats may be lost.
    name
        Full name of the node, for diagnostics.
    """

    beat = 'joint_states'
    sources: tuple[str, ...] = ()

    def __init__(
        self,
        vehicle: VehicleParameters,
        steering: SteeringParameters,
        module: WheelModuleParameters,
        control_period: float,
        trim_limit: float,
        *,
        lockstep: bool = False,
        name: str = '/icr_steering',
    ) -> None:
        self.name = name
        self._longest_gap = round(control_period * NANOSECONDS) if lockstep else math.inf
        self._law = Law(vehicle, steering, control_period)
        law = self._law
        self._twists = {'driver/speed': law.speed, 'teleop/cmd_vel': law.teleop, 'cmd_vel': law.cmd_vel}
        self._takers = {
            'joint_states': self._take_joints,
            **dict.fromkeys(STATES, self._take_state),
            **dict.fromkeys(TRIMS, self._take_trim),
        }
        module = replace(module, steer_limit=steering.steer_limit)
        self._joint_check = JointCheck(math.inf if module.ideal_actuators else module.steer_rate_limit)
        # Ideal actuators are where they are told to be, and with exact side-slip control their trims are in the plant.
        self._word_check = None if module.ideal_actuators else WordCheck(control_period)
        self._words: dict[str, Word] = {}
        self._period = control_period
        self._blind = False
        self._monitor = ModuleMonitor(vehicle, module, control_period, trim_limit)
        self._reacts = steering.fault_reaction
        self._joints = self._latest = VehicleJoints()
        self._lacking = False
        self._setpoints = Setpoints(ZEROS, ZEROS, ZEROS, STILL)
        self._said: dict[str, int] = {}
        self._trims: dict[str, Trim] = {}
        self._begun: int | None = None
        self._watched = 0
        # Without a time-out the modules wait for ever; ICR steering does not wait for them.
        self._silence = round((module.module_timeout or SILENCE) * NANOSECONDS)
        self._reporter = Reporter(name)

    def receive(self, topic: str, value: Value, now: int) -> None:
        """Take the measured joints, what the modules were and are about to do, or a driver command."""
        if isinstance(value, Joints):
            self._takers[topic](topic, value, now)
        elif isinstance(value, Point):
            self._law.icr(value, now)
        elif isinstance(value, Wrench):
            self._law.traction(value, now)
        elif isinstance(value, Twist):
            self._twists[topic](value, now)
        elif isinstance(value, Flag):
            self._law.emergency_stop(value.data)

    def _take_state(self, topic: str, value: Joints, now: int) -> None:
        self._said[topic] = max(self._said.get(topic, 0), min(value.stamp or now, now))
        if len(value.position) == len(value.velocity) == len(value.effort) == 2:
            word = Word(value.stamp, value.position[0] + value.velocity[0] * self._period, value.effort[1])
            if math.isfinite(word.steer_angle + word.torque):
                self._words[topic] = word

    def _take_trim(self, topic: str, value: Joints, now: int) -> None:
        if len(value.position) == len(value.effort) == 2 and math.isfinite(value.position[0] + value.effort[1]):
            self._trims[topic] = Trim(value.stamp, value.position[0], value.effort[1])

    def _take_joints(self, topic: str, value: Joints, now: int) -> None:
        joints = vehicle_joints(value)
        self._lacking = joints is None
        self._latest = joints or self._latest

    def step(self, stamp: int, missing: tuple[str, ...] = ()) -> list[Output]:
        """Return the set-points that belong to ``stamp`` [ns]."""
        gap = stamp - self._watched if self._begun is not None else 0
        setpoints = self._setpoints = self._steer(stamp)
        state = self._law.status.with_notes(*self._monitor.notes)
        if self._longest_gap < gap <= LONGEST_STEP * self._period * NANOSECONDS:
            state = state.with_notes((WARN, _JUMPED.format(gap / NANOSECONDS, self._period)))
        if self._lacking:
            state = state.with_notes((ERROR, 'joint_states lacks joints or is not finite; the last one is kept'))
        if self._blind:
            state = state.with_notes((ERROR, UNBELIEVED))
        outputs = self._reporter.report(stamp, state)
        outputs.append(Output('commanded_twist', Twist(stamp, *setpoints.twist)))
        for i, wheel in enumerate(WHEELS):
            angle, speed, torque = setpoints.steer_angle[i], setpoints.wheel_speed[i], setpoints.torque[i]
            outputs.append(Output(f'{wheel}/command', module_joints(wheel, stamp, angle, 0.0, speed, torque)))
        return outputs

    def _steer(self, stamp: int) -> Setpoints:
        fits = self._check_joints(stamp)
        if fits or not self._reacts:
            self._joints = self._latest
        condition = self._watch(stamp, self._joints if fits else self._as_said())
        # Blind, it goes by what it has told the wheels, as if they had done it.
        by = self._setpoints if self._blind and self._reacts else self._joints
        setpoints = self._law.update(stamp, by.steer_angle, by.wheel_speed, condition if self._reacts else SOUND)
        self._monitor.told(stamp, setpoints.twist, setpoints.steer_angle, setpoints.torque)
        return setpoints

    def _check_joints(self, stamp: int) -> bool:
        """Return whether joint_states can be taken for what the wheels do."""
        latest = self._latest
        contradicted = self._word_check is not None and self._word_check.update(
            stamp, latest.steer_angle, latest.torque, [self._words.get(topic) for topic in STATES]
        )
        measured = None if self._lacking else Measurement(latest.steer_angle, latest.rotation, latest.wheel_speed)
        self._blind = self._joint_check.update(stamp, measured, contradicted=contradicted)
        return self._joint_check.fits and not self._blind

    def _as_said(self) -> VehicleJoints:
        """Return what the modules say of their wheels; these are taken to turn as they were told."""
        angle, torque = self._joints.steer_angle, self._joints.torque
        words = [self._words.get(topic) for topic in STATES]
        return VehicleJoints(
            steer_angle=per_wheel(lambda i: word.steer_angle if (word := words[i]) else angle[i]),
            wheel_speed=self._setpoints.wheel_speed,
            torque=per_wheel(lambda i: word.torque if (word := words[i]) else torque[i]),
        )

    def _watch(self, stamp: int, joints: VehicleJoints) -> Condition:
        """Return what is wrong with the modules."""
        if self._begun is None or stamp < self._begun:
            self._begun = stamp
            self._said.clear()
        elif stamp - self._watched > self._silence:  # nobody could answer to cycles that were not
            self._said = dict.fromkeys(self._said, stamp)
        self._watched = stamp
        late = stamp - self._begun >= START_UP

        def heard(i: int) -> Heard:
            said, trim = self._said.get(STATES[i]), self._trims.pop(TRIMS[i], None)
            if said is None:
                return Heard(begun=False, silent=late)
            return Heard(True, stamp - said > self._silence, stamp - said, trim)

        measured = Measured(joints.steer_angle, joints.wheel_speed, joints.torque)
        condition = self._monitor.update(stamp, measured, per_wheel(heard))
        return condition._replace(blind=True) if self._blind else condition
