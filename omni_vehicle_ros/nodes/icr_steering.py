"""Node ``icr_steering``."""

import sys

from rclpy.context import Context

from omni_vehicle_ros import interface
from omni_vehicle_ros.components.icr_steering import IcrSteering
from omni_vehicle_ros.nodes.declare import declare
from omni_vehicle_ros.nodes.exchange import Exchange
from omni_vehicle_ros.nodes.process import run
from omni_vehicle_ros.nodes.shell import Shell
from omni_vehicle_ros.parameters import PlantParameters, SteeringParameters, VehicleParameters


class IcrSteeringNode(Shell):
    """Driver commands in, set-points of the four wheel modules out."""

    def __init__(self, context: Context, exchange: Exchange, namespace: str | None = None) -> None:
        super().__init__(interface.ICR_STEERING, context=context, exchange=exchange, namespace=namespace)

    def build(self) -> None:
        """Read the parameters and make component and ports."""
        vehicle = declare(self, VehicleParameters)
        steering = declare(self, SteeringParameters)
        period = declare(self, PlantParameters, only=('control_period',)).control_period
        component = IcrSteering(vehicle, steering, period, name=self.full_name)
        self.attach(component)


def main() -> None:
    """Run the node until a signal comes."""
    sys.exit(run(lambda context, exchange: [IcrSteeringNode(context, exchange)]))
