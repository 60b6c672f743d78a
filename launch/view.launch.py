"""Show a vehicle that is running, or a bag that is replayed: its model and its path in RViz."""

from pathlib import Path

from ament_index_python.packages import get_package_share_directory
from launch import LaunchContext, LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction, SetEnvironmentVariable
from launch.substitutions import EnvironmentVariable, LaunchConfiguration
from launch_ros.actions import Node

PACKAGE = 'omni_vehicle_ros'


def arguments() -> list[DeclareLaunchArgument]:
    """Return the launch arguments."""
    truth = ['true', 'false']
    return [
        DeclareLaunchArgument('namespace', default_value='', description='Namespace of the vehicle.'),
        DeclareLaunchArgument(
            'urdf', default_value='', description='URDF of the vehicle; empty: that of the default parameters.'
        ),
        DeclareLaunchArgument(
            'use_sim_time', default_value='true', choices=truth, description='Whether the clocks follow /clock.'
        ),
        DeclareLaunchArgument('rviz', default_value='true', choices=truth, description='Whether to start RViz.'),
    ]


def this_machine() -> SetEnvironmentVariable:
    """Return what limits discovery to this machine, unless the user has said otherwise."""
    name = 'ROS_AUTOMATIC_DISCOVERY_RANGE'
    return SetEnvironmentVariable(name, EnvironmentVariable(name, default_value='LOCALHOST'))


def nodes(context: LaunchContext) -> list[Node]:
    """Return the nodes that the arguments ask for."""
    names = ('namespace', 'urdf', 'use_sim_time', 'rviz')
    value = {name: LaunchConfiguration(name).perform(context) for name in names}
    share = Path(get_package_share_directory(PACKAGE))
    urdf = Path(value['urdf'] or share / 'urdf' / 'omni_vehicle.urdf')
    common = {'namespace': value['namespace'].rstrip('/'), 'output': 'screen'}
    time = {'use_sim_time': value['use_sim_time'] == 'true'}
    model = {**time, 'robot_description': urdf.read_text(encoding='utf-8')}
    publisher = 'robot_state_publisher'
    shown = [
        Node(package=publisher, executable=publisher, name=publisher, parameters=[model], **common),
        Node(package=PACKAGE, executable='odom_transform', name='odom_transform', parameters=[time], **common),
    ]
    if value['rviz'] == 'true':
        view = ['-d', str(share / 'rviz' / 'vehicle.rviz')]
        shown.append(
            Node(package='rviz2', executable='rviz2', name='rviz2', arguments=view, parameters=[time], **common)
        )
    return shown


def generate_launch_description() -> LaunchDescription:
    """Return what ``ros2 launch omni_vehicle_ros view.launch.py`` starts."""
    return LaunchDescription([this_machine(), *arguments(), OpaqueFunction(function=nodes)])
