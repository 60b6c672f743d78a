"""The side-slip controller: what the vehicle does and should do in, trims of steering and drive out."""

import math
from typing import Any

from omni_vehicle_ros.components.component import ERROR, Output, Reporter
from omni_vehicle_ros.components.joints import module_joints, vehicle_joints
from omni_vehicle_ros.control.controllers import make_controller
from omni_vehicle_ros.control.fault_tolerance.joint_check import JointCheck
from omni_vehicle_ros.control.fault_tolerance.joint_check import Joints as Measurement
from omni_vehicle_ros.control.fault_tolerance.sensors import SENSORS, Seen, SensorMonitor
from omni_vehicle_ros.control.trim import NO_WHEEL, Cycles, Sensed, Trims
from omni_vehicle_ros.messages import Imu, Joints, Odometry, Twist, Value
from omni_vehicle_ros.model import kinematics
from omni_vehicle_ros.parameters import SideSlipParameters, VehicleParameters
from omni_vehicle_ros.wheels import WHEELS, PerWheel, per_wheel, scaled

_NO_NUMBER = float('nan')

SILENCE = 0.1
"""Time without a message after which a sensor says nothing [s]."""


class SideSlipController:
    """The controller that the parameter ``controller`` selects; all of them are wired alike.

    Sensors that can't be believed are named, and their values left out.

    Parameters
    ----------
    parameters, vehicle
        Which one, its gains and limits; what it controls.
    name
        Full name of the node, for diagnostics.
    """

    beat = 'joint_states'
    sources: tuple[str, ...] = ('odom', 'imu', 'tyres/side_slip', 'commanded_twist')

    def __init__(
        self, parameters: SideSlipParameters, vehicle: VehicleParameters, *, name: str = '/side_slip_controller'
    ) -> None:
        self.name = name
        self._vehicle = vehicle
        self._law = make_controller(parameters, vehicle)
        self._reacts = parameters.fault_reaction
        self._monitor = SensorMonitor(vehicle)
        self._joint_check = JointCheck(math.inf)
        self._sensed: dict[str, Any] = Sensed()._asdict()
        self._beside: dict[str, Any] = {'yaw_rate': 0.0, 'place': (0.0, 0.0), 'rolling': NO_WHEEL}
        self._quiet = dict.fromkeys(SENSORS, 0.0)
        self._measured = Measurement(NO_WHEEL, NO_WHEEL, NO_WHEEL)
        self._cycles = Cycles()
        self._trims = Trims()
        self._blind = False
        self._reporter = Reporter(name)

    def configure(self, parameters: SideSlipParameters) -> None:
        """Go on with other gains and limits; integrals start anew."""
        self._law = make_controller(parameters, self._vehicle)
        self._reacts = parameters.fault_reaction

    def receive(self, topic: str, value: Value, now: int) -> None:
        """Take what was measured or commanded; side slips that are missing count as no number."""
        sensed, beside = self._sensed, self._beside
        if isinstance(value, Joints):
            self._take_joints(topic, value)
        elif isinstance(value, Twist):
            sensed['commanded'] = kinematics.Twist(value.vx, value.vy, value.yaw_rate)
        elif isinstance(value, Odometry) and value.frame:
            sensed['twist'] = kinematics.Twist(value.vx, value.vy, value.yaw_rate)
            beside['place'] = value.x, value.y
        elif isinstance(value, Imu) and value.frame:
            sensed['lateral_acceleration'] = value.ay
            beside['yaw_rate'] = value.yaw_rate
        else:
            return  # no frame: a sensor that sees nothing
        self._quiet[topic] = 0.0

    def _take_joints(self, topic: str, value: Joints) -> None:
        sensed = self._sensed
        if topic != 'joint_states':
            sensed['side_slip'] = _by_wheel(value.names, value.position)
            sensed['wheel_speed'] = _by_wheel(value.names, value.velocity)
            return
        joints = vehicle_joints(value)
        self._blind = joints is None
        if joints is not None:
            sensed['steer_angle'], sensed['drive_torque'] = joints.steer_angle, joints.torque
            self._beside['rolling'] = scaled(self._vehicle.wheel_radius, joints.wheel_speed)
            self._measured = Measurement(joints.steer_angle, joints.rotation, joints.wheel_speed)

    def step(self, stamp: int, missing: tuple[str, ...] = ()) -> list[Output]:
        """Return the trims that belong to ``stamp`` [ns]."""
        trims = self._control(stamp)
        state = self._law.status.with_notes(*self._monitor.notes)
        if self._blind:
            state = state.with_notes((ERROR, 'joint_states lacks joints or is not finite; the last one is kept'))
        outputs = self._reporter.report(stamp, state)
        for i, wheel in enumerate(WHEELS):
            joints = module_joints(wheel, stamp, trims.steer_angle[i], 0.0, 0.0, trims.torque[i])
            outputs.append(Output(f'{wheel}/trim', joints))
        return outputs

    def _control(self, stamp: int) -> Trims:
        dt = self._cycles.next(stamp)
        if dt is None:
            return self._trims
        silent = [topic for topic, quiet in self._quiet.items() if quiet > SILENCE]
        self._quiet = {topic: quiet + dt for topic, quiet in self._quiet.items()}
        seen = Seen(Sensed(**self._sensed), **self._beside)
        contradicted = self._monitor.contradicts_joints(seen)
        blind = self._joint_check.update(stamp, None if self._blind else self._measured, contradicted=contradicted)
        sensed = self._monitor.update(seen, silent, blind=blind)
        if self._reacts:
            self._trims = self._monitor.fade(self._law.update(stamp, sensed), dt)
        else:
            self._trims = self._law.update(stamp, seen.sensed)
        return self._trims


def _by_wheel(names: tuple[str, ...], numbers: tuple[float, ...]) -> PerWheel:
    if names == WHEELS and len(numbers) == 4:
        return numbers
    found = dict(zip(names, numbers, strict=False))
    return per_wheel(lambda i: found.get(WHEELS[i], _NO_NUMBER))
