"""``view.launch.py``, run with stand-ins: launch and launch_ros exist only where ROS is installed."""

import runpy
import sys
from types import ModuleType, SimpleNamespace

import pytest


class Recorded:
    """Keeps the arguments that it was made with."""

    def __init__(self, *arguments, **keywords):
        self.arguments = arguments
        self.__dict__.update(keywords)

    def perform(self, context):
        """Return the value of a launch configuration."""
        return context[self.arguments[0]]


@pytest.fixture
def view(root, monkeypatch):
    parts = {
        'ament_index_python.packages': {'get_package_share_directory': lambda name: root},
        'launch': dict.fromkeys(('LaunchContext', 'LaunchDescription'), Recorded),
        'launch.actions': dict.fromkeys(
            ('DeclareLaunchArgument', 'OpaqueFunction', 'SetEnvironmentVariable'), Recorded
        ),
        'launch.substitutions': dict.fromkeys(('EnvironmentVariable', 'LaunchConfiguration'), Recorded),
        'launch_ros': {},
        'launch_ros.actions': {'Node': Recorded},
    }
    for name, content in parts.items():
        module = ModuleType(name)
        module.__dict__.update(content)
        monkeypatch.setitem(sys.modules, name, module)
    return SimpleNamespace(**runpy.run_path(str(root / 'launch' / 'view.launch.py')))


def started(view, **values):
    defaults = {entry.arguments[0]: entry.default_value for entry in view.arguments()}
    return {node.executable: node for node in view.nodes({**defaults, **values})}


def test_model_transform_and_picture_are_started(view, root):
    nodes = started(view)
    assert {name: node.package for name, node in nodes.items()} == {
        'robot_state_publisher': 'robot_state_publisher', 'odom_transform': 'omni_vehicle_ros', 'rviz2': 'rviz2',
    }
    assert nodes['robot_state_publisher'].parameters[0]['robot_description'] == (
        (root / 'urdf' / 'omni_vehicle.urdf').read_text(encoding='utf-8')
    )
    assert nodes['rviz2'].arguments == ['-d', str(root / 'rviz' / 'vehicle.rviz')]
    assert all(node.parameters[0]['use_sim_time'] is True for node in nodes.values())


def test_arguments_reach_the_nodes(view, tmp_path):
    (tmp_path / 'own.urdf').write_text('<robot name="own"/>', encoding='utf-8')
    nodes = started(
        view, namespace='/car/', rviz='false', use_sim_time='false', urdf=str(tmp_path / 'own.urdf')
    )
    assert set(nodes) == {'robot_state_publisher', 'odom_transform'}
    assert all(node.namespace == '/car' for node in nodes.values())
    assert nodes['robot_state_publisher'].parameters == [
        {'use_sim_time': False, 'robot_description': '<robot name="own"/>'}
    ]
    assert [entry.arguments[0] for entry in view.generate_launch_description().arguments[0][1:-1]] == [
        'namespace', 'urdf', 'use_sim_time', 'rviz'
    ]
