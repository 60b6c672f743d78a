"""Start one vehicle: plant, four wheel modules, ICR steering, side-slip controller and, when asked, a recorder."""

from pathlib import Path

from launch import LaunchContext, LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction, SetEnvironmentVariable
from launch.substitutions import EnvironmentVariable, LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare

from omni_vehicle_ros.parameters import PacingParameters
from omni_vehicle_ros.wheels import WHEELS

PACKAGE = 'omni_vehicle_ros'


def arguments() -> list[DeclareLaunchArgument]:
    """Return the launch arguments."""
    defaults = PathJoinSubstitution([FindPackageShare(PACKAGE), 'config', 'vehicle.yaml'])
    truth = ['true', 'false']
    return [
        DeclareLaunchArgument('namespace', default_value='', description='Namespace of the vehicle.'),
        DeclareLaunchArgument('params_file', default_value=defaults, description='YAML file: parameters of the nodes.'),
        DeclareLaunchArgument(
            'use_sim_time',
            default_value='false',
            choices=truth,
            description="Whether the nodes' clocks follow /clock; control runs on the stamps of messages anyway.",
        ),
        DeclareLaunchArgument(
            'record', default_value='', description='Directory to record a bag in, which must not exist; empty: no bag.'
        ),
        DeclareLaunchArgument(
            'pacing',
            default_value='realtime',
            choices=['realtime', 'lockstep'],
            description='Whether the simulated time keeps pace with real time or runs as fast as all nodes can follow.',
        ),
        DeclareLaunchArgument(
            'publish_clock',
            default_value='true',
            choices=truth,
            description='Whether the plant publishes /clock; of several vehicles only one may.',
        ),
    ]


def this_machine() -> SetEnvironmentVariable:
    """Return what limits discovery to this machine, unless the user has said otherwise."""
    name = 'ROS_AUTOMATIC_DISCOVERY_RANGE'
    return SetEnvironmentVariable(name, EnvironmentVariable(name, default_value='LOCALHOST'))


def nodes(context: LaunchContext) -> list[Node]:
    """Return the nodes that the arguments ask for.

    Raises
    ------
    ValueError
        The file of the parameters is not there, or the directory to record in is: with the one launch_ros would start
        a vehicle of defaults, with the other the recorder would end, and the vehicle would drive unrecorded.
    """
    names = ('namespace', 'params_file', 'record', 'publish_clock')
    value = {name: LaunchConfiguration(name).perform(context) for name in names}
    if not Path(value['params_file']).is_file():
        raise ValueError(f'params_file: {value["params_file"]} is not a file')
    if value['record'] and Path(value['record']).exists():
        raise ValueError(f'record: {value["record"]} exists; name a directory that does not')
    vehicle = value['namespace'].rstrip('/')
    participants = [*PacingParameters().participants, *(['recorder'] if value['record'] else [])]

    def node(executable: str, namespace: str = vehicle, **parameters: object) -> Node:
        """Return one node with the parameters that all have and its own."""
        common = {
            'use_sim_time': LaunchConfiguration('use_sim_time'),
            'pacing': LaunchConfiguration('pacing'),
            'participants': participants,
            'publish_clock': value['publish_clock'] == 'true',
        }
        return Node(
            package=PACKAGE,
            executable=executable,
            name=executable,
            namespace=namespace,
            parameters=[LaunchConfiguration('params_file'), {**common, **parameters}],
            ros_arguments=['--enclave', f'/{namespace}/{executable}'.replace('//', '/')],
            output='screen',
        )

    recorder = [node('recorder', directory=value['record'])] if value['record'] else []
    modules = [node('wheel_module', namespace=f'{vehicle}/{wheel}') for wheel in WHEELS]
    return [*recorder, node('plant'), *modules, node('icr_steering'), node('side_slip_controller')]


def generate_launch_description() -> LaunchDescription:
    """Return what ``ros2 launch omni_vehicle_ros vehicle.launch.py`` starts."""
    return LaunchDescription([this_machine(), *arguments(), OpaqueFunction(function=nodes)])
