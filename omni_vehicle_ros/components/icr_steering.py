"""ICR steering: driver commands in, set-points of the four wheel modules out."""

from omni_vehicle_ros.components.component import ERROR, Output, Reporter
from omni_vehicle_ros.components.joints import VehicleJoints, module_joints, vehicle_joints
from omni_vehicle_ros.control.icr_steering import IcrSteering as Law
from omni_vehicle_ros.messages import Flag, Joints, Point, Twist, Value, Wrench
from omni_vehicle_ros.parameters import SteeringParameters, VehicleParameters
from omni_vehicle_ros.wheels import WHEELS


class IcrSteering:
    """Turns what the driver asks for into one rigid motion, and that into four set-points."""

    beat = 'joint_states'
    sources: tuple[str, ...] = ()

    def __init__(
        self,
        vehicle: VehicleParameters,
        steering: SteeringParameters,
        control_period: float,
        *,
        name: str = '/icr_steering',
    ) -> None:
        self.name = name
        self._law = Law(vehicle, steering, control_period)
        law = self._law
        self._twists = {'driver/speed': law.speed, 'teleop/cmd_vel': law.teleop, 'cmd_vel': law.cmd_vel}
        self._joints = VehicleJoints()
        self._blind = False
        self._reporter = Reporter(name)

    def receive(self, topic: str, value: Value, now: int) -> None:
        """Take the measured joints or a driver command."""
        if isinstance(value, Joints):
            joints = vehicle_joints(value)
            self._blind = joints is None
            self._joints = joints or self._joints
        elif isinstance(value, Point):
            self._law.icr(value, now)
        elif isinstance(value, Wrench):
            self._law.traction(value, now)
        elif isinstance(value, Twist):
            self._twists[topic](value, now)
        elif isinstance(value, Flag):
            self._law.emergency_stop(value.data)

    def step(self, stamp: int, missing: tuple[str, ...] = ()) -> list[Output]:
        """Return the set-points that belong to ``stamp`` [ns]."""
        setpoints = self._law.update(stamp, self._joints.steer_angle, self._joints.wheel_speed)
        state = self._law.status
        if self._blind:
            state = state.with_notes((ERROR, 'joint_states lacks joints or is not finite; the last one is kept'))
        outputs = self._reporter.report(stamp, state)
        outputs.append(Output('commanded_twist', Twist(stamp, *setpoints.twist)))
        for i, wheel in enumerate(WHEELS):
            steer, drive = (setpoints.steer_angle[i], 0.0), (setpoints.wheel_speed[i], setpoints.torque[i])
            outputs.append(Output(f'{wheel}/command', module_joints(wheel, stamp, steer, drive)))
        return outputs
