"""The launch file, run with stand-ins: launch and launch_ros exist only where ROS is installed."""

import runpy
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace

import pytest

from omni_vehicle_ros.parameters import PacingParameters
from omni_vehicle_ros.wheels import WHEELS

PARAMETERS = Path(__file__).parents[2] / 'config' / 'vehicle.yaml'


class Recorded:
    """Keeps the arguments that it was made with."""

    def __init__(self, *arguments, **keywords):
        self.arguments = arguments
        self.__dict__.update(keywords)


class Configuration(Recorded):
    """A launch configuration; the context of this stand-in is a dictionary."""

    def perform(self, context):
        return context[self.arguments[0]]


@pytest.fixture
def launch_file(root, monkeypatch):
    parts = {
        'launch': ('LaunchContext', 'LaunchDescription'),
        'launch.actions': ('DeclareLaunchArgument', 'OpaqueFunction', 'SetEnvironmentVariable'),
        'launch.substitutions': ('EnvironmentVariable', 'LaunchConfiguration', 'PathJoinSubstitution'),
        'launch_ros': (),
        'launch_ros.actions': ('Node',),
        'launch_ros.substitutions': ('FindPackageShare',),
    }
    for name, classes in parts.items():
        module = ModuleType(name)
        for each in classes:
            setattr(module, each, Configuration if each == 'LaunchConfiguration' else type(each, (Recorded,), {}))
        monkeypatch.setitem(sys.modules, name, module)
    return SimpleNamespace(**runpy.run_path(str(root / 'launch' / 'vehicle.launch.py')))


def started(launch_file, **values):
    """Return the nodes by their full names."""
    context = {'namespace': '', 'params_file': str(PARAMETERS), 'record': '', 'publish_clock': 'true', **values}
    nodes = launch_file.nodes(context)
    assert all(node.name == node.executable and node.package == 'omni_vehicle_ros' for node in nodes)
    return {f'{node.namespace}/{node.name}': node for node in nodes}


def own(node):
    """Return the parameters that the launch file sets itself."""
    return node.parameters[-1]


def test_arguments_and_their_defaults(launch_file):
    entities = launch_file.generate_launch_description().arguments[0]
    arguments = {each.arguments[0]: each for each in entities if type(each).__name__ == 'DeclareLaunchArgument'}
    assert set(arguments) == {'namespace', 'params_file', 'use_sim_time', 'record', 'pacing', 'publish_clock'}
    assert arguments['params_file'].default_value.arguments[0][1:] == ['config', 'vehicle.yaml']
    assert arguments['pacing'].default_value == 'realtime'
    assert arguments['use_sim_time'].default_value == 'false'
    assert arguments['namespace'].default_value == arguments['record'].default_value == ''
    assert entities[-1].function is launch_file.nodes


def test_discovery_is_limited_to_this_machine_unless_the_user_says_otherwise(launch_file):
    first = launch_file.generate_launch_description().arguments[0][0]
    name, value = first.arguments
    assert type(first).__name__ == 'SetEnvironmentVariable'
    assert name == value.arguments[0] == 'ROS_AUTOMATIC_DISCOVERY_RANGE'
    assert value.default_value == 'LOCALHOST'


@pytest.mark.parametrize('namespace', ['', 'car', '/fleet/car/'])
def test_each_node_has_the_enclave_of_its_name(launch_file, namespace):
    for name, node in started(launch_file, namespace=namespace, record='some/bag').items():
        assert node.ros_arguments == ['--enclave', '/' + name.lstrip('/')]


@pytest.mark.parametrize('namespace', ['', 'car', '/car', '/fleet/car/'])
def test_all_participants_start_in_the_namespace(launch_file, namespace):
    prefix = namespace.rstrip('/')
    expected = {f'{prefix}/{role}' for role in PacingParameters().participants}
    assert set(started(launch_file, namespace=namespace)) == expected


def test_wheel_modules_differ_by_namespace_only(launch_file):
    modules = [node for node in started(launch_file).values() if node.name == 'wheel_module']
    assert [node.namespace.strip('/') for node in modules] == list(WHEELS)
    assert all(own(node).keys() == own(modules[0]).keys() for node in modules)


def test_recorder_starts_when_asked_and_is_then_waited_for(launch_file):
    nodes = started(launch_file, record='some/bag')
    assert own(nodes['/recorder'])['directory'] == 'some/bag'
    assert all(own(node)['participants'] == [*PacingParameters().participants, 'recorder'] for node in nodes.values())
    assert 'recorder' not in own(started(launch_file)['/plant'])['participants']


@pytest.mark.parametrize(('text', 'value'), [('true', True), ('false', False)])
def test_all_nodes_know_whose_the_clock_is(launch_file, text, value):
    nodes = started(launch_file, publish_clock=text, record='some/bag')
    assert all(own(node)['publish_clock'] is value for node in nodes.values())


def test_the_file_comes_before_the_arguments(launch_file):
    for node in started(launch_file).values():
        assert node.parameters[0].arguments == ('params_file',)
        assert own(node)['pacing'].arguments == ('pacing',)
        assert own(node)['use_sim_time'].arguments == ('use_sim_time',)


def test_no_vehicle_of_defaults_starts_for_want_of_a_file(launch_file):
    with pytest.raises(ValueError, match=r'^params_file: none\.yaml is not a file$'):
        started(launch_file, params_file='none.yaml')


def test_no_vehicle_starts_whose_recorder_would_end(launch_file, tmp_path):
    with pytest.raises(ValueError, match=r'^record: .* exists; name a directory that does not$'):
        started(launch_file, record=str(tmp_path))
