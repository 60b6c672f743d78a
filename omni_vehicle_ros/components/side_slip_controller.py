"""The side-slip controller: what the vehicle does and should do in, trims of steering and drive out."""

from typing import Any

from omni_vehicle_ros.components.component import ERROR, Output, Reporter
from omni_vehicle_ros.components.joints import module_joints, vehicle_joints
from omni_vehicle_ros.control.controllers import make_controller
from omni_vehicle_ros.control.trim import Sensed
from omni_vehicle_ros.messages import Imu, Joints, Odometry, Twist, Value
from omni_vehicle_ros.model import kinematics
from omni_vehicle_ros.parameters import SideSlipParameters, VehicleParameters
from omni_vehicle_ros.wheels import WHEELS, PerWheel, per_wheel

_NO_NUMBER = float('nan')


class SideSlipController:
    """The controller that the parameter ``controller`` selects; all of them are wired alike.

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
        self._sensed = Sensed()
        self._fresh: dict[str, Any] = {}
        self._blind = False
        self._reporter = Reporter(name)

    def configure(self, parameters: SideSlipParameters) -> None:
        """Go on with other gains and limits; integrals start anew."""
        self._law = make_controller(parameters, self._vehicle)

    def receive(self, topic: str, value: Value, now: int) -> None:
        """Take what was measured or commanded; side slips that are missing count as no number."""
        fresh = self._fresh
        if isinstance(value, Odometry | Imu) and not value.frame:
            return  # a sensor that sees nothing
        if isinstance(value, Odometry):
            fresh['twist'] = kinematics.Twist(value.vx, value.vy, value.yaw_rate)
        elif isinstance(value, Imu):
            fresh['lateral_acceleration'] = value.ay
        elif isinstance(value, Twist):
            fresh['commanded'] = kinematics.Twist(value.vx, value.vy, value.yaw_rate)
        elif isinstance(value, Joints) and topic == 'joint_states':
            joints = vehicle_joints(value)
            self._blind = joints is None
            if joints is not None:
                fresh['steer_angle'], fresh['drive_torque'] = joints.steer_angle, joints.torque
        elif isinstance(value, Joints):
            fresh['side_slip'] = _by_wheel(value.names, value.position)
            fresh['wheel_speed'] = _by_wheel(value.names, value.velocity)

    def step(self, stamp: int, missing: tuple[str, ...] = ()) -> list[Output]:
        """Return the trims that belong to ``stamp`` [ns]."""
        self._sensed = self._sensed._replace(**self._fresh)
        trims = self._law.update(stamp, self._sensed)
        state = self._law.status
        if self._blind:
            state = state.with_notes((ERROR, 'joint_states lacks joints or is not finite; the last one is kept'))
        outputs = self._reporter.report(stamp, state)
        for i, wheel in enumerate(WHEELS):
            joints = module_joints(wheel, stamp, (trims.steer_angle[i], 0.0), (0.0, trims.torque[i]))
            outputs.append(Output(f'{wheel}/trim', joints))
        return outputs


def _by_wheel(names: tuple[str, ...], numbers: tuple[float, ...]) -> PerWheel:
    if names == WHEELS and len(numbers) == 4:
        return numbers
    found = dict(zip(names, numbers, strict=False))
    return per_wheel(lambda i: found.get(WHEELS[i], _NO_NUMBER))
