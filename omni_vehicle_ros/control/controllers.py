"""The controllers that can be selected."""

from omni_vehicle_ros.control.allocation import AllocationController
from omni_vehicle_ros.control.rear_steering import RearSteeringController
from omni_vehicle_ros.control.side_slip import SideSlipController
from omni_vehicle_ros.control.trim import Controller
from omni_vehicle_ros.control.yaw_moment import YawMomentController
from omni_vehicle_ros.parameters import SideSlipParameters, VehicleParameters


def make_controller(parameters: SideSlipParameters, vehicle: VehicleParameters) -> Controller:
    """Return the controller that ``parameters.controller`` names.

    Parameters
    ----------
    parameters
        Which one, its gains and limits.
    vehicle
        What it controls.
    """
    if parameters.controller == 'yaw_moment':
        return YawMomentController(parameters, vehicle)
    if parameters.controller == 'rear_steering':
        return RearSteeringController(parameters, vehicle)
    if parameters.controller == 'allocation':
        return AllocationController(parameters, vehicle)
    return SideSlipController(parameters)
