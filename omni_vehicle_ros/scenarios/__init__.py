"""What a run is: commands, environment and vehicle, read from ``config/scenarios/*.yaml``; no ROS."""

from omni_vehicle_ros.scenarios.commands import Command
from omni_vehicle_ros.scenarios.environment import EnvironmentChange, EnvironmentProfile
from omni_vehicle_ros.scenarios.faults import FaultEvent
from omni_vehicle_ros.scenarios.library import scenario_directory, scenario_names
from omni_vehicle_ros.scenarios.loading import load_scenario, variants
from omni_vehicle_ros.scenarios.scenario import Scenario
from omni_vehicle_ros.scenarios.script import DriverScript

__all__ = [
    'Command',
    'DriverScript',
    'EnvironmentChange',
    'EnvironmentProfile',
    'FaultEvent',
    'Scenario',
    'load_scenario',
    'scenario_directory',
    'scenario_names',
    'variants',
]
