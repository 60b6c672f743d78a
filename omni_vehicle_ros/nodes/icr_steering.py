"""Node ``icr_steering``."""

import sys

from rclpy.context import Context

from omni_vehicle_ros import interface
from omni_vehicle_ros.components.icr_steering import STATES, TRIMS, IcrSteering
from omni_vehicle_ros.nodes.declare import declare
from omni_vehicle_ros.nodes.exchange import Exchange
from omni_vehicle_ros.nodes.process import run
from omni_vehicle_ros.nodes.shell import Shell
from omni_vehicle_ros.parameters import (
    PlantParameters,
    SideSlipParameters,
    SteeringParameters,
    VehicleParameters,
    WheelModuleParameters,
)

ACTUATORS = (
    'ideal_actuators', 'steer_delay', 'steer_time_constant', 'steer_rate_limit', 'drive_time_constant',
    'drive_torque_limit', 'module_timeout',
)  # fmt: skip
"""Of the wheel modules: what they are expected to do."""


class IcrSteeringNode(Shell):
    """Driver commands in, set-points of the four wheel modules out."""

    def __init__(self, context: Context, exchange: Exchange, namespace: str | None = None) -> None:
        super().__init__(interface.ICR_STEERING, context=context, exchange=exchange, namespace=namespace)

    def build(self) -> None:
        """Read the parameters and make component and ports."""
        vehicle = declare(self, VehicleParameters)
        steering = declare(self, SteeringParameters)
        period = declare(self, PlantParameters, only=('control_period',)).control_period
        module = declare(self, WheelModuleParameters, only=ACTUATORS)
        trim_limit = declare(self, SideSlipParameters, only=('trim_limit',)).trim_limit
        component = IcrSteering(
            vehicle, steering, module, period, trim_limit, lockstep=self.lockstep, name=self.full_name
        )
        trims = TRIMS if interface.SIDE_SLIP_CONTROLLER in self.pacing.participants else ()
        self.attach(component, previous=(*STATES, *trims), fetched=(*STATES, *TRIMS))


def main() -> None:
    """Run the node until a signal comes."""
    sys.exit(run(lambda context, exchange: [IcrSteeringNode(context, exchange)]))
