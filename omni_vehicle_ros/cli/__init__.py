"""The command ``omni_vehicle``."""

from omni_vehicle_ros.cli.command_line import main

__all__ = ['main']
