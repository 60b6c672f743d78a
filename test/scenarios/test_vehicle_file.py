from pathlib import Path

import pytest

from omni_vehicle_ros.errors import ScenarioError
from omni_vehicle_ros.parameters import VehicleParameters
from omni_vehicle_ros.scenarios.parameter_file import default_parameter_file
from omni_vehicle_ros.scenarios.vehicle_file import load_vehicle

HEAVY = VehicleParameters(mass=1500.0)


@pytest.fixture
def file(tmp_path: Path):
    """Write a YAML file; return its path."""

    def write(text: str) -> Path:
        path = tmp_path / 'car.yaml'
        path.write_text(text, encoding='utf-8')
        return path

    return write


@pytest.mark.parametrize('text', [
    'mass: 1500.0',
    'mass: 1500',
    'vehicle: {mass: 1500.0}',
    'vehicle: {mass: 1500.0}\nplant: {constant_speed: true}',
    'duration: 1.0\nvehicle: {mass: 1500.0}',
    'duration: 1.0\nvalues: {load: 1500.0}\nvehicle: {mass: $load}',
    '/**:\n  ros__parameters:\n    mass: 1500.0',
    '/**:\n  ros__parameters:\n    mass: 1500.0\n    pacing: realtime\n/**/plant:\n  ros__parameters:\n    bank: 0.0',
    'car1:\n  plant:\n    ros__parameters:\n      mass: 1500.0',
    '/**:\n  ros__parameters: {mass: 1500.0}\n/**/plant:\n  ros__parameters: {mass: 1500.0}',
])
def test_a_vehicle_is_found_where_one_would_look_for_it(file, text):
    assert load_vehicle(file(text)) == HEAVY


def test_the_parameter_file_of_the_package_is_the_default_vehicle(file):
    assert load_vehicle(file(default_parameter_file())) == VehicleParameters() == load_vehicle(None)


def test_overrides_come_last(file):
    path = file('mass: 1400.0\nwheel_radius: 0.3')
    loaded = load_vehicle(path, ['mass=1450', 'vehicle.mass=1500', 'wheel_radius=0.35'])
    assert loaded == HEAVY
    assert load_vehicle(None, ['airflow_angles=[0.3, 0.6]', 'side_force_coefficients=[0.5, 0.6]']).airflow_angles == (
        0.3, 0.6)


@pytest.mark.parametrize(('text', 'words'), [
    ('', 'must be a mapping'),
    ('- mass', 'must be a mapping'),
    ('mass: [', 'line 1'),
    ('mass: heavy', "mass: 'heavy' must be a number"),
    ('mass: -1', 'outside'),
    ('mas: 1400', "did you mean 'mass'"),
    ('duration: 1.0\nvehicle: {mas: 1400}', "did you mean 'mass'"),
    ('vehicle: 5', 'must be a mapping'),
    ('/**:\n  ros__parameters:\n    pacing: realtime', 'no vehicle parameters'),
    ('/**:\n  ros__parameters: 3', 'must be a mapping'),
    ('/**:\n  ros__parameters: {mass: 1.0}\nplant:\n  ros__parameters: {mass: 2.0}', 'mass is there twice'),
    ('sprung_mass: 1500.0', 'is more than mass'),
    ('mass: 1500.0\nfriction: 0.5', 'give --friction, or put it under plant:'),
    ('vehicle: {mass: 1500.0}\nfriction: 0.5', 'give --friction, or put it under plant:'),
    ('vehicle: {wind: 2.0}', 'wind is no vehicle parameter but one of the road: put it under plant:'),
])
def test_what_is_no_vehicle_is_refused_with_one_line(file, text, words):
    path = file(text)
    with pytest.raises(ScenarioError) as refusal:
        load_vehicle(path)
    assert words in str(refusal.value)
    assert str(path) in str(refusal.value)
    assert '\n' not in str(refusal.value)


def test_file_and_overrides_need_to_fit_together_only(file):
    light = file('mass: 1000.0')
    with pytest.raises(ScenarioError, match='is more than mass'):
        load_vehicle(light)
    assert load_vehicle(light, ['sprung_mass=900']) == VehicleParameters(mass=1000.0, sprung_mass=900.0)


@pytest.mark.parametrize(('override', 'words'), [
    ('mass', 'must be name=value'), ('mas=3', "did you mean 'mass'"), ('mass=heavy', 'must be a number'),
    ('mass=-3', 'outside'), ('mass=[', 'line 1'), ('sprung_mass=2000', 'is more than mass'),
    ('friction=0.5', 'give --friction'),
])
def test_a_wrong_override_is_refused(override, words):
    with pytest.raises(ScenarioError, match='default vehicle with') as refusal:
        load_vehicle(None, [override])
    assert words in str(refusal.value)


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(ScenarioError, match=r'nowhere\.yaml: No such file'):
        load_vehicle(tmp_path / 'nowhere.yaml')
