"""Node ``side_slip_controller``."""

import sys

from rclpy.context import Context

from omni_vehicle_ros import interface
from omni_vehicle_ros.components.side_slip_controller import SideSlipController
from omni_vehicle_ros.nodes.declare import declare, on_change
from omni_vehicle_ros.nodes.process import run
from omni_vehicle_ros.nodes.shell import Shell
from omni_vehicle_ros.parameters import SideSlipParameters


class SideSlipControllerNode(Shell):
    """Side slip of the tyres in, steering trims out."""

    def __init__(self, context: Context, namespace: str | None = None) -> None:
        super().__init__(interface.SIDE_SLIP_CONTROLLER, context=context, namespace=namespace)
        parameters = declare(self, SideSlipParameters, changeable=True)
        component = SideSlipController(parameters, name=self.full_name)
        on_change(self, parameters, component.configure)
        self.attach(component)


def main() -> None:
    """Run the node until a signal comes."""
    sys.exit(run(lambda context: [SideSlipControllerNode(context)]))
