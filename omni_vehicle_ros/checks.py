"""Whether a scenario can be driven: looked at before anything starts."""

import re

from omni_vehicle_ros.control.commands import check_cmd_vel, check_icr
from omni_vehicle_ros.control.loop_check import check_gains
from omni_vehicle_ros.errors import CommandError, ParameterError, RunError
from omni_vehicle_ros.messages import Point, Twist
from omni_vehicle_ros.scenarios import Scenario


def check_commands(scenario: Scenario) -> None:
    """Check that the vehicle can turn to where the driver of a scenario will say.

    Raises
    ------
    RunError
        A command asks for more than the wheels' range.
    """
    for number, command in enumerate(scenario.commands):
        try:
            if isinstance(command.icr, tuple):
                check_icr(Point(0, *command.icr), scenario.vehicle, scenario.steering)
            if command.twist is not None:
                topic = 'teleop' if command.cmd_vel is None else 'cmd_vel'
                check_cmd_vel(Twist(0, *command.twist), scenario.vehicle, scenario.steering, topic)
        except CommandError as error:
            raise RunError(f'{scenario.name}: commands[{number}]: {error}') from None


def check_loop(scenario: Scenario, mode: str = 'processes') -> None:
    """Check that the loop of the side-slip controller settles: sampled, or solved exactly.

    Raises
    ------
    RunError
        Gains are at the limit of the sampled loop or beyond it.
    ScenarioError
        An offline run has gains without an exact form.
    """
    if not scenario.side_slip_control:
        return
    if mode == 'offline':
        from omni_vehicle_ros.simulation import exact_gains

        if exact_gains(scenario) is not None:
            return
    try:
        check_gains(scenario.side_slip, scenario.vehicle, scenario.wheel_module, scenario.plant.control_period)
    except ParameterError as error:
        raise RunError(f'side_slip.{error}') from None


def check_namespace(namespace: str) -> None:
    """Check that ROS takes a namespace.

    Raises
    ------
    RunError
        It has something other than letters, digits and underscores between slashes.
    """
    if '__' in namespace or not re.fullmatch(r'/?([A-Za-z_]\w*(/[A-Za-z_]\w*)*)?/?', namespace, re.ASCII):
        raise RunError(
            f'--namespace: {namespace!r} must be letters, digits and single underscores between slashes, such as car1'
        )
