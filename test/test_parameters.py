"""Every parameter has a unit, a range and a meaning; what does not fit is refused by name."""

import dataclasses

import pytest

from omni_vehicle_ros import parameters
from omni_vehicle_ros.errors import ParameterError
from omni_vehicle_ros.parameters import (
    Parameters,
    PlantParameters,
    RecorderParameters,
    SteeringParameters,
    VehicleParameters,
)

CLASSES = [kind for kind in vars(parameters).values() if isinstance(kind, type) and issubclass(kind, Parameters)][1:]


@pytest.mark.parametrize('kind', CLASSES)
def test_every_parameter_is_described(kind: type[Parameters]) -> None:
    for entry in dataclasses.fields(kind):  # type: ignore[arg-type]
        assert entry.metadata['text'].endswith('.'), entry.name
        if isinstance(entry.default, str):
            assert entry.metadata['choices'] or kind is RecorderParameters, entry.name
        elif isinstance(entry.default, float):
            assert entry.metadata['low'] is not None, entry.name
            assert entry.metadata['high'] is not None, entry.name


def test_the_vehicle_is_that_of_the_thesis() -> None:
    vehicle = VehicleParameters()
    assert vehicle.wheelbase == pytest.approx(2.454)
    assert vehicle.wheel_x == (1.0, 1.0, -1.454, -1.454)
    assert vehicle.wheel_y == (0.718, -0.718, 0.718, -0.718)
    # Appendix A: the sprung centre of gravity is 0.533 m high.
    assert vehicle.front_roll_centre_height + vehicle.roll_arm == pytest.approx(0.533)
    assert vehicle.rear_roll_centre_height == vehicle.front_roll_centre_height


@pytest.mark.parametrize(
    ('values', 'words'),
    [
        ({'mass': 0.0}, r'mass: 0.0 is outside 1 .. 100000 kg'),
        ({'mass': float('nan')}, 'mass: nan is outside'),
        ({'mass': 'heavy'}, "mass: 'heavy' must be a number"),
        ({'mass': True}, 'mass: True must be a number'),
        ({'load_transfer': 1}, 'load_transfer: 1 must be true or false'),
        ({'mas': 1.0}, "unknown parameter 'mas'; did you mean 'mass'"),
        ({'sprung_mass': 2000.0}, 'sprung_mass: 2000 kg is more than mass'),
        ({'roll_stiffness': 100.0}, 'the body falls over'),
        ({'airflow_angles': [0.2, 0.1], 'side_force_coefficients': [1.0, 1.0]}, 'must rise'),
        ({'airflow_angles': []}, 'must have the same length'),
        ({'body_model': 'eight_dof', 'roll_inertia': 200.0}, r'roll_inertia: 200 kg m2 must be above 244\.\d* kg m2'),
        ({'body_model': 'eight_dof', 'wheel_inertia': 0.0}, 'wheel_inertia: 0.0 kg m2 must be above 0'),
        ({'body_model': 'bicycle'}, "body_model: 'bicycle' is not one of yaw_plane, eight_dof"),
    ],
)
def test_what_does_not_fit_is_refused(values: dict[str, object], words: str) -> None:
    with pytest.raises(ParameterError, match=words):
        VehicleParameters.from_mapping(values)


def test_limits_that_depend_on_each_other() -> None:
    with pytest.raises(ParameterError, match='must divide control_period'):
        PlantParameters(control_period=0.005, integration_step=0.002)
    with pytest.raises(ParameterError, match='must sum to 1'):
        SteeringParameters(drive_shares=(0.5, 0.5, 0.5, 0.5))
    with pytest.raises(ParameterError, match='road, omni'):
        SteeringParameters(steering_rule='rail')
    with pytest.raises(ParameterError, match='must be a list of 4 values'):
        SteeringParameters(drive_shares=(0.5, 0.5))  # type: ignore[arg-type]


def test_whole_numbers_are_taken_for_real_ones() -> None:
    mass = VehicleParameters.from_mapping({'mass': 1300}).mass
    assert mass == 1300.0
    assert isinstance(mass, float)
