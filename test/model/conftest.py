"""What every test of the model starts from."""

import pytest

from omni_vehicle_ros.model.constants import Constants, constants
from omni_vehicle_ros.parameters import VehicleParameters


@pytest.fixture(scope='session')
def vehicle() -> VehicleParameters:
    return VehicleParameters()


@pytest.fixture(scope='session')
def model(vehicle) -> Constants:
    return constants(vehicle)


@pytest.fixture(scope='session')
def stiff_vehicle() -> VehicleParameters:
    """Neither load transfer nor roll steer: what linear theory speaks of."""
    return VehicleParameters(load_transfer=False, front_roll_steer=0.0, rear_roll_steer=0.0)
