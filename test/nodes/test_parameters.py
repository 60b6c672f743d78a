"""Parameters of the nodes: refused by name when bad, described, and changed live where that makes sense."""

import pytest

from .conftest import Lab, finish, until

pytestmark = pytest.mark.graph


@pytest.mark.parametrize(
    ('executable', 'setting', 'words'),
    [
        ('plant', 'mass:=-5.0', 'mass'),
        ('plant', 'mass:=heavy', "mass: 'heavy' must be a number"),
        ('plant', 'control_period:=0.0', 'control_period'),
        ('plant', 'integration_step:=0.002', 'must divide control_period'),
        ('plant', 'publish_clock:=7', 'publish_clock: 7 must be true or false'),
        ('icr_steering', 'steering_rule:=rail', "steering_rule: 'rail' is not one of road, omni"),
        ('side_slip_controller', 'proportional_gains:=[1.0, 2.0]', 'must be a list of 4 values'),
        ('side_slip_controller', 'proportional_gains:=[0.0, 25.0, 0.0, 0.0]', '25 is not below 20.5, where'),
        ('side_slip_controller', 'controller:=best', "controller: 'best' is not one of wheel_slip, yaw_moment"),
        ('wheel_module', 'wheel:=fifth', "wheel: 'fifth' is not one of front_left"),
        ('driver', 'scenario:=nowhere', 'nowhere'),
    ],
)
def test_a_bad_parameter_is_one_line_and_exit_2(lab: Lab, executable: str, setting: str, words: str) -> None:
    out, errors = finish(lab.node(executable, '-p', setting), 2)
    assert words in errors
    assert len([line for line in errors.splitlines() if line.strip()]) == 1, errors
    assert out == ''


def test_a_whole_number_is_taken_for_a_real_one(lab: Lab) -> None:
    node = lab.node('plant', '-p', 'mass:=1300')
    finish(lab.start('-c', CLIENT, 'plant', 'mass'))
    node.terminate()
    finish(node)


CLIENT = """
import sys
import rclpy
from rclpy.parameter import Parameter
from rclpy.parameter_client import AsyncParameterClient

rclpy.init()
node = rclpy.create_node('client')
client = AsyncParameterClient(node, sys.argv[1])
assert client.wait_for_services(30.0)


def ask(call, *arguments):
    # A server that has not yet found the client answers into the void: ask again.
    for _ in range(10):
        future = call(*arguments)
        rclpy.spin_until_future_complete(node, future, timeout_sec=5.0)
        if future.done():
            return future.result()
    sys.exit('no answer')


name = sys.argv[2]
if name == 'mass':
    value = ask(client.get_parameters, ['mass']).values[0]
    assert (value.type, value.double_value) == (3, 1300.0), value
    description = ask(client.describe_parameters, ['mass']).descriptors[0]
    assert description.description == 'Total mass. [kg]', description
    assert description.floating_point_range[0].from_value == 1.0
    refused = ask(client.set_parameters, [Parameter('mass', value=1400.0)]).results[0]
    assert not refused.successful
    assert refused.reason == (
        'mass can not change while the vehicle drives: it is read at the start; restart /plant with -p mass:=1400.0'
    ), refused
else:
    good = ask(client.set_parameters, [Parameter(name, value=[5.0, 1.0, 0.0, 0.0])]).results[0]
    assert good.successful, good
    assert list(ask(client.get_parameters, [name]).values[0].double_array_value) == [5.0, 1.0, 0.0, 0.0]
    bad = ask(client.set_parameters, [Parameter(name, value=[-5.0, 1.0, 0.0, 0.0])]).results[0]
    assert not bad.successful
    assert 'outside 0 .. 100' in bad.reason, bad
    wild = ask(client.set_parameters, [Parameter(name, value=[5.0, 25.0, 0.0, 0.0])]).results[0]
    assert not wild.successful
    assert '25 is not below 20.5' in wild.reason and 'front_right' in wild.reason and 'lower it' in wild.reason, wild
    assert list(ask(client.get_parameters, [name]).values[0].double_array_value) == [5.0, 1.0, 0.0, 0.0]
    for limit, taken in ((0.3, True), (0.5, True), (0.6, False)):
        answer = ask(client.set_parameters, [Parameter('trim_limit', value=limit)]).results[0]
        assert answer.successful == taken, answer
    assert '0.6 is above 0.5 rad' in answer.reason
    fixed = ask(client.set_parameters, [Parameter('controller', value='allocation')]).results[0]
    assert not fixed.successful
    assert fixed.reason.endswith('restart /side_slip_controller with -p controller:=allocation'), fixed
    assert ask(client.get_parameters, ['controller']).values[0].string_value == 'wheel_slip'
node.destroy_node()
rclpy.shutdown()
"""


def test_gains_change_live(lab: Lab) -> None:
    node = lab.node('side_slip_controller')
    finish(lab.start('-c', CLIENT, 'side_slip_controller', 'proportional_gains'))
    node.terminate()
    finish(node)


def test_a_plant_without_the_others_gives_up(lab: Lab) -> None:
    """In lock step, a plant without the others says who is missing and ends."""
    plant = lab.node('plant', '-p', 'pacing:=lockstep', '-p', 'start_limit:=1.0')
    until(lambda: plant.poll() is not None, 'the plant to give up')
    _, errors = finish(plant, 2)
    assert 'not ready after 1 s: front_left/wheel_module' in errors
