"""What rclpy says to parameters, names and files that it does not take, as one line."""

from rclpy.exceptions import InvalidParameterTypeException, InvalidParameterValueException
from rclpy.impl.implementation_singleton import rclpy_implementation

from omni_vehicle_ros.errors import OmniVehicleError

RCLError = rclpy_implementation.RCLError

REFUSALS = (OmniVehicleError, InvalidParameterTypeException, InvalidParameterValueException, RCLError)
"""What ends the start of a node, and is for the user to put right."""


def one_line(error: Exception) -> str:
    """Return what an error says; rcl adds where in its source it was found, after a comma and a line break."""
    return ' '.join(str(error).split(', at /')[0].split())
