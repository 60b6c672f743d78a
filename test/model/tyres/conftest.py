"""The four tyres, on the thesis's vehicle."""

import pytest

from omni_vehicle_ros.model.constants import constants
from omni_vehicle_ros.parameters import TYRE_MODELS, VehicleParameters


@pytest.fixture(params=TYRE_MODELS)
def tyre(request):
    """Constants of the vehicle with each of the tyres."""
    return constants(VehicleParameters(tyre_model=request.param))
