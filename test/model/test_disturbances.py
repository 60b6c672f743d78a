import math

import pytest

from omni_vehicle_ros.errors import ParameterError
from omni_vehicle_ros.model.constants import constants
from omni_vehicle_ros.model.disturbances import (
    bank_force,
    beaufort,
    side_force_coefficient,
    wind_force,
    wind_moment,
)
from omni_vehicle_ros.parameters import VehicleParameters


def test_thesis_wind_case(model):
    # Table 4.2: 2 m/s at 5.556 m/s blow at 0.3455 rad, where Cy is 0.58.
    assert math.atan2(2.0, 5.556) == pytest.approx(0.3455, abs=1e-4)
    assert wind_force(2.0, 5.556, model) == pytest.approx(0.6 * 0.58 * 1.2 * (5.556**2 + 4.0), rel=1e-3)


def test_wind_force_is_odd_in_the_wind_continuous_and_blind_to_the_direction_of_travel(model):
    assert wind_force(-2.0, 20.0, model) == -wind_force(2.0, 20.0, model)
    assert wind_force(2.0, -20.0, model) == wind_force(2.0, 20.0, model)
    assert wind_force(0.0, 20.0, model) == 0.0
    assert wind_force(1e-9, 20.0, model) == pytest.approx(0.0, abs=1e-6)


def test_wind_on_a_standing_vehicle_is_finite(model):
    assert wind_force(10.0, 0.0, model) == pytest.approx(0.6 * 0.58 * 1.2 * 100.0)


def test_coefficient_is_interpolated_and_held_beyond_the_table():
    model = constants(VehicleParameters(airflow_angles=(0.2, 0.4), side_force_coefficients=(0.5, 0.7)))
    coefficients = [side_force_coefficient(angle, model) for angle in (0.0, 0.1, 0.2, 0.3, 0.4, 1.0)]
    assert coefficients == pytest.approx([0.0, 0.25, 0.5, 0.6, 0.7, 0.7])


def test_a_table_may_begin_at_zero():
    model = constants(VehicleParameters(airflow_angles=(0.0, 0.4), side_force_coefficients=(0.1, 0.5)))
    assert [side_force_coefficient(angle, model) for angle in (0.0, 0.2)] == pytest.approx([0.1, 0.3])


def test_wind_ahead_of_the_centre_of_gravity_turns_the_vehicle_with_it():
    model = constants(VehicleParameters(aerodynamic_centre=0.1))
    assert wind_moment(50.0, model) == pytest.approx(5.0)


def test_bank_force_is_the_weight_along_the_road(vehicle, model):
    assert bank_force(0.02, model) == pytest.approx(vehicle.mass * vehicle.gravity * math.sin(0.02))


def test_beaufort_table():
    assert (beaufort(0).low, beaufort(1).high, beaufort(2).mean) == (0.0, 3.0, 5.0)
    assert (beaufort(8).name, beaufort(31).name, beaufort(31).high) == ('weak', 'violent', 143.0)
    with pytest.raises(ParameterError, match=r'32 is outside 0 \.\. 31'):
        beaufort(32)
