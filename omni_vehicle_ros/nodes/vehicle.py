"""Executable ``vehicle``: all nodes of one vehicle in one process.

What only they listen to they hand over to each other, and don't publish: see `omni_vehicle_ros.nodes.exchange`.
"""

import argparse
import sys
from collections.abc import Callable

from rclpy.context import Context
from rclpy.utilities import remove_ros_args

from omni_vehicle_ros import interface
from omni_vehicle_ros.nodes.driver import DriverNode
from omni_vehicle_ros.nodes.exchange import Exchange
from omni_vehicle_ros.nodes.icr_steering import IcrSteeringNode
from omni_vehicle_ros.nodes.plant import PlantNode
from omni_vehicle_ros.nodes.process import run
from omni_vehicle_ros.nodes.recorder import RecorderNode
from omni_vehicle_ros.nodes.shell import Shell
from omni_vehicle_ros.nodes.side_slip_controller import SideSlipControllerNode
from omni_vehicle_ros.nodes.wheel_module import WheelModuleNode

MAKERS: dict[str, Callable[[Context, Exchange, str], Shell]] = {
    interface.PLANT: PlantNode,
    interface.ICR_STEERING: IcrSteeringNode,
    interface.SIDE_SLIP_CONTROLLER: SideSlipControllerNode,
    interface.DRIVER: DriverNode,
    interface.RECORDER: RecorderNode,
    **dict.fromkeys(interface.WHEEL_MODULES, WheelModuleNode),
}


def make(context: Context, exchange: Exchange, roles: list[str], namespace: str) -> list[Shell]:
    """Make the nodes of ``roles`` in the namespace of a vehicle."""
    nodes = []
    exchange.shared = len(roles) > 1
    for role in roles:
        wheel = role.split('/')[0] if '/' in role else ''
        nodes.append(MAKERS[role](context, exchange, interface.resolve(wheel, namespace)))
    return nodes


def main() -> None:
    """Run the nodes until they have finished or a signal comes."""
    vehicle = [role for role in interface.NODES if role not in (interface.DRIVER, interface.RECORDER)]
    parser = argparse.ArgumentParser(description='All nodes of one vehicle in one process.')
    parser.add_argument('--namespace', default='', help='namespace of the vehicle')
    parser.add_argument('--nodes', nargs='+', choices=interface.NODES, default=vehicle, help='which nodes')
    options = parser.parse_args(remove_ros_args(sys.argv)[1:])
    sys.exit(run(lambda context, exchange: make(context, exchange, options.nodes, options.namespace)))
