"""Node ``wheel_module``: run it four times, in the namespaces front_left, front_right, rear_left and rear_right."""

import math
import sys
import time

from rclpy.context import Context
from rclpy.node import Node

from omni_vehicle_ros import interface
from omni_vehicle_ros.components.watchdog import Watchdog
from omni_vehicle_ros.components.wheel_module import WheelModule
from omni_vehicle_ros.errors import ParameterError
from omni_vehicle_ros.messages import Value
from omni_vehicle_ros.nodes.declare import declare, declare_plain
from omni_vehicle_ros.nodes.exchange import Exchange
from omni_vehicle_ros.nodes.process import run
from omni_vehicle_ros.nodes.shell import Shell
from omni_vehicle_ros.parameters import PlantParameters, SideSlipParameters, WheelModuleParameters
from omni_vehicle_ros.wheels import WHEELS


class WheelModuleNode(Shell):
    """Set-points and trims in, what the actuators of one wheel do out."""

    def __init__(self, context: Context, exchange: Exchange, namespace: str | None = None) -> None:
        self._watchdog = Watchdog(math.inf)
        super().__init__('wheel_module', context=context, exchange=exchange, namespace=namespace)

    def build(self) -> None:
        """Read the parameters and make component and ports."""
        wheel = wheel_of(self)
        self.role = f'{wheel}/wheel_module'
        parameters = declare(self, WheelModuleParameters)
        period = declare(self, PlantParameters, only=('control_period',)).control_period
        trim_limit = declare(self, SideSlipParameters, only=('trim_limit',)).trim_limit
        trimmed = interface.SIDE_SLIP_CONTROLLER in self.pacing.participants
        self._module = WheelModule(wheel, parameters, period, trim_limit, trimmed=trimmed, name=self.full_name)
        if parameters.module_timeout > 0.0 and not self.lockstep:
            # A cycle more: what comes with a beat holds until the next.
            self._watchdog = Watchdog((parameters.module_timeout + period) / self.pacing.realtime_factor)
        # The side-slip controller answers to ICR steering, and that to the plant.
        self.attach(self._module, fetched=('joint_states', *self._module.sources[:-1]))

    def take(self, topic: str, value: Value) -> None:
        """Take a message; note the beat."""
        if topic == self._module.beat:
            self._watchdog.heard(time.monotonic())
        super().take(topic, value)

    def poll(self) -> None:
        """Look after the wheel when the beat does not come any more."""
        super().poll()
        if self.active and self._watchdog.strikes(time.monotonic()):
            self.publish(self._module.fall_back(self.now))

    def wait(self) -> float:
        """Return for how long there is nothing to do but to take messages [s]."""
        return min(super().wait(), self._watchdog.left)

    def rest(self) -> None:
        """Let the wheel roll on as it is."""
        self.publish(self._module.rest(self.now))


def wheel_of(node: Node) -> str:
    """Return which wheel a node is for: its parameter ``wheel``, else the end of its namespace.

    Raises
    ------
    ParameterError
        Neither names a wheel.
    """
    namespace = node.get_namespace().split('/')[-1]
    wheel = str(declare_plain(node, 'wheel', namespace))
    if wheel not in WHEELS:
        raise ParameterError(
            f'wheel: {wheel!r} is not one of {", ".join(WHEELS)}; run in such a namespace or set -p wheel:=front_left'
        )
    return wheel


def main() -> None:
    """Run the node until a signal comes."""
    sys.exit(run(lambda context, exchange: [WheelModuleNode(context, exchange)]))
