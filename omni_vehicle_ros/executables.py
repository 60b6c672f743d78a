"""Entry points of all executables; they import late, so that a signal during a start ends it without a trace."""

import importlib
import os
import signal
import sys

from omni_vehicle_ros.ending import ENDING, EXIT_SIGNAL, release_signals


def main(module: str) -> None:
    """Run the ``main`` of a module of this package; until that handles signals, one ends the process at once."""
    usual = module.startswith('nodes.')  # a signal is how a node ends, while a command has not done what it was to do
    for number in ENDING:
        signal.signal(number, lambda number, _: os._exit(0 if usual else EXIT_SIGNAL + number))
    release_signals()
    importlib.import_module(f'omni_vehicle_ros.{module}').main()


def omni_vehicle() -> None:
    """Run the command ``omni_vehicle``."""
    main('cli')


def analyse() -> None:
    """Run the command ``omni_vehicle analyse``."""
    sys.argv[:1] = ['omni_vehicle', 'analyse']
    main('cli')


def plant() -> None:
    """Run the node ``plant``."""
    main('nodes.plant')


def wheel_module() -> None:
    """Run the node ``wheel_module``."""
    main('nodes.wheel_module')


def icr_steering() -> None:
    """Run the node ``icr_steering``."""
    main('nodes.icr_steering')


def side_slip_controller() -> None:
    """Run the node ``side_slip_controller``."""
    main('nodes.side_slip_controller')


def recorder() -> None:
    """Run the node ``recorder``."""
    main('nodes.recorder')


def driver() -> None:
    """Run the node ``driver``."""
    main('nodes.driver')


def replay() -> None:
    """Run the node ``replay``: the command of that name, but like any ROS node not limited to this machine."""
    os.environ.setdefault('ROS_AUTOMATIC_DISCOVERY_RANGE', 'SUBNET')
    sys.argv[:1] = ['omni_vehicle', 'replay']
    main('cli')


def odom_transform() -> None:
    """Run the node ``odom_transform``."""
    main('nodes.odom_transform')


def vehicle() -> None:
    """Run all nodes in one process."""
    main('nodes.vehicle')


if __name__ == '__main__':
    main(sys.argv.pop(1))
