"""Node ``side_slip_controller``."""

import sys
from dataclasses import replace

from rclpy.context import Context

from omni_vehicle_ros import interface
from omni_vehicle_ros.components.side_slip_controller import SideSlipController
from omni_vehicle_ros.nodes.declare import declare, on_change
from omni_vehicle_ros.nodes.process import run
from omni_vehicle_ros.nodes.shell import Shell
from omni_vehicle_ros.parameters import SideSlipParameters, VehicleParameters

FIXED = ('controller', 'allocation_traction')
"""Parameters that select the law; its gains and limits may change while it runs."""


class SideSlipControllerNode(Shell):
    """What the vehicle does and should do in, trims of steering and drive out."""

    def __init__(self, context: Context, namespace: str | None = None) -> None:
        super().__init__(interface.SIDE_SLIP_CONTROLLER, context=context, namespace=namespace)
        vehicle = declare(self, VehicleParameters)
        parameters = declare(self, SideSlipParameters, only=FIXED)
        names = tuple(name for name in parameters.as_dict() if name not in FIXED)
        live = declare(self, SideSlipParameters, only=names, changeable=True)
        parameters = replace(live, **{name: getattr(parameters, name) for name in FIXED})
        component = SideSlipController(parameters, vehicle, name=self.full_name)
        on_change(self, parameters, component.configure)
        self.attach(component)


def main() -> None:
    """Run the node until a signal comes."""
    sys.exit(run(lambda context: [SideSlipControllerNode(context)]))
