"""What a run is: commands, environment and vehicle, read from ``config/scenarios/*.yaml``; no ROS."""

from omni_vehicle_ros.scenarios.commands import Command, EnvironmentChange
from omni_vehicle_ros.scenarios.library import scenario_directory, scenario_names
from omni_vehicle_ros.scenarios.scenario import Scenario, load_scenario
from omni_vehicle_ros.scenarios.script import DriverScript

__all__ = [
    'Command',
    'DriverScript',
    'EnvironmentChange',
    'Scenario',
    'load_scenario',
    'scenario_directory',
    'scenario_names',
]
