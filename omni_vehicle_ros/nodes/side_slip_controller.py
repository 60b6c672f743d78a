"""Node ``side_slip_controller``."""

import sys
from dataclasses import replace

from rclpy.context import Context

from omni_vehicle_ros import interface
from omni_vehicle_ros.components.side_slip_controller import SideSlipController
from omni_vehicle_ros.control.loop_check import check_gains
from omni_vehicle_ros.errors import ParameterError
from omni_vehicle_ros.nodes.declare import declare, on_change
from omni_vehicle_ros.nodes.exchange import Exchange
from omni_vehicle_ros.nodes.process import run
from omni_vehicle_ros.nodes.shell import Shell
from omni_vehicle_ros.parameters import (
    PlantParameters,
    SideSlipParameters,
    VehicleParameters,
    WheelModuleParameters,
)

FIXED = ('controller', 'allocation_traction')
"""Parameters that select the law; its gains and limits may change while it runs."""

ACTUATORS = ('ideal_actuators', 'steer_delay', 'steer_time_constant', 'drive_time_constant')
"""Of the wheel modules: what the gains are checked against."""


class SideSlipControllerNode(Shell):
    """What the vehicle does and should do in, trims of steering and drive out."""

    def __init__(self, context: Context, exchange: Exchange, namespace: str | None = None) -> None:
        super().__init__(interface.SIDE_SLIP_CONTROLLER, context=context, exchange=exchange, namespace=namespace)

    def build(self) -> None:
        """Read the parameters and make component and ports."""
        vehicle = declare(self, VehicleParameters)
        parameters = declare(self, SideSlipParameters, only=FIXED)
        names = tuple(name for name in parameters.as_dict() if name not in FIXED)
        live = declare(self, SideSlipParameters, only=names, changeable=True)
        parameters = replace(live, **{name: getattr(parameters, name) for name in FIXED})
        module = declare(self, WheelModuleParameters, only=ACTUATORS)
        period = declare(self, PlantParameters, only=('control_period',)).control_period
        check_gains(parameters, vehicle, module, period)
        component = SideSlipController(parameters, vehicle, name=self.full_name)
        bound = parameters.trim_limit

        def configure(changed: SideSlipParameters) -> None:
            if changed.trim_limit > bound:
                raise ParameterError(
                    f'trim_limit: {changed.trim_limit:g} is above {bound:g} rad, to which the wheel modules hold every '
                    'trim since their start; start the vehicle with more'
                )
            check_gains(changed, vehicle, module, period)
            component.configure(changed)

        self._end_changes = on_change(self, parameters, configure)
        # ICR steering answers to what the plant says.
        self.attach(component, fetched=('joint_states', 'odom', 'imu', 'tyres/side_slip'))

    def finish(self) -> None:
        """Let parameters change no component that is gone."""
        self._end_changes()


def main() -> None:
    """Run the node until a signal comes."""
    sys.exit(run(lambda context, exchange: [SideSlipControllerNode(context, exchange)]))
