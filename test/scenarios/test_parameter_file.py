import dataclasses
import itertools
import re
from pathlib import Path

import pytest
import yaml

from omni_vehicle_ros import parameters
from omni_vehicle_ros.scenarios import scenario_directory
from omni_vehicle_ros.scenarios.parameter_file import default_parameter_file

VEHICLE_YAML = scenario_directory().parent / 'vehicle.yaml'
DECLARED = {
    '/**': (parameters.VehicleParameters, parameters.PacingParameters),
    '/**/plant': (parameters.PlantParameters,),
    '/**/icr_steering': (parameters.SteeringParameters,),
    '/**/wheel_module': (parameters.WheelModuleParameters,),
    '/**/side_slip_controller': (parameters.SideSlipParameters,),
    '/**/recorder': (parameters.RecorderParameters,),
}


def test_the_file_is_what_the_parameters_give() -> None:
    assert VEHICLE_YAML.read_text(encoding='utf-8') == default_parameter_file(), (
        'python -m omni_vehicle_ros.scenarios.parameter_file > config/vehicle.yaml'
    )


def test_every_default_is_there_once_in_its_type() -> None:
    tree = yaml.safe_load(VEHICLE_YAML.read_text(encoding='utf-8'))
    assert set(tree) == set(DECLARED)
    shared = tree['/**']['ros__parameters']
    for pattern, classes in reversed(DECLARED.items()):  # what nodes share stands once, in what is for all
        found = tree[pattern]['ros__parameters']
        if pattern != '/**':
            own = {entry.name for kind in classes for entry in dataclasses.fields(kind)}
            found |= {name: shared.pop(name) for name in own & set(shared)}
        expected = {entry.name: entry.default for kind in classes for entry in dataclasses.fields(kind)}
        assert set(found) == set(expected)
        for name, default in expected.items():
            plain = list(default) if isinstance(default, tuple) else default
            assert found[name] == plain
            assert type(found[name]) is type(plain)
            if isinstance(plain, list):
                assert all(type(item) is type(default[0]) for item in found[name])


def test_every_line_is_readable() -> None:
    lines = VEHICLE_YAML.read_text(encoding='utf-8').splitlines()
    assert max(map(len, lines)) <= 110
    for before, line in itertools.pairwise(lines):
        if re.match(r'    \w+:', line):
            assert before.startswith('    # ')


@pytest.mark.filterwarnings('ignore:module .sre_.* is deprecated:DeprecationWarning')
@pytest.mark.parametrize('namespace', ['', '/cars/left'])
def test_ros_gives_each_node_its_values(namespace: str, tmp_path: Path) -> None:
    rclpy = pytest.importorskip('rclpy')
    text = default_parameter_file()
    text = text.replace('mass: 1298.9', 'mass: 1400.0').replace('proportional_gains: [5.0', 'proportional_gains: [4.0')
    path = tmp_path / 'vehicle.yaml'
    path.write_text(text, encoding='utf-8')
    context = rclpy.Context()
    rclpy.init(args=['--ros-args', '--params-file', str(path)], context=context)
    try:
        values = {}
        for name, below in (('plant', ''), ('wheel_module', '/front_left'), ('side_slip_controller', '')):
            node = rclpy.create_node(
                name, namespace=namespace + below or '/', context=context,
                automatically_declare_parameters_from_overrides=True,
            )
            values[name] = {key: parameter.value for key, parameter in node.get_parameters_by_prefix('').items()}
            node.destroy_node()
    finally:
        rclpy.shutdown(context=context)
    assert {mine['mass'] for mine in values.values()} == {1400.0}
    assert list(values['plant']['friction']) == [0.9] * 4
    assert values['wheel_module']['steer_time_constant'] == 0.1
    assert list(values['side_slip_controller']['proportional_gains']) == [4.0, 5.0, 0.0, 0.0]
    assert 'proportional_gains' not in values['plant']
