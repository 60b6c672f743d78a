"""The managed lifecycle of the nodes: no command reaches a wheel that is not active, and nodes can be taken back."""

import signal
from pathlib import Path

import pytest

from .conftest import Lab, finish

pytestmark = pytest.mark.graph

HELPER = str(Path(__file__).with_name('manager.py'))


@pytest.mark.parametrize('one_process', [False, True])
def test_a_wheel_module_goes_through_its_states_while_the_vehicle_drives(lab: Lab, one_process: bool) -> None:
    vehicle = lab.node('vehicle') if one_process else lab.command('start')
    out, _ = finish(lab.start(HELPER))
    assert out.split() == ['done']
    vehicle.send_signal(signal.SIGINT)
    finish(vehicle)


def test_without_autostart_a_node_waits_to_be_configured(lab: Lab) -> None:
    node = lab.node('side_slip_controller', '-p', 'autostart:=false')
    script = """
import rclpy, sys
from lifecycle_msgs.srv import ChangeState, GetState
from lifecycle_msgs.msg import Transition
rclpy.init()
node = rclpy.create_node('asks')
def call(kind, name, request):
    client = node.create_client(kind, f'/side_slip_controller/{name}')
    assert client.wait_for_service(60.0)
    future = client.call_async(request)
    rclpy.spin_until_future_complete(node, future, timeout_sec=60.0)
    return future.result()
said = []
for transition in (None, Transition.TRANSITION_CONFIGURE, Transition.TRANSITION_ACTIVATE):
    if transition is not None:
        assert call(ChangeState, 'change_state', ChangeState.Request(transition=Transition(id=transition))).success
    said.append(call(GetState, 'get_state', GetState.Request()).current_state.label)
print(*said, node.count_publishers('/front_left/trim'))
node.destroy_node()
rclpy.shutdown()
"""
    out, _ = finish(lab.start('-c', script))
    assert out.split() == ['unconfigured', 'inactive', 'active', '1']
    node.send_signal(signal.SIGINT)
    finish(node)


def test_what_refuses_the_start_also_refuses_to_be_configured(lab: Lab) -> None:
    """The reason is the same line, once as the end of the process, once in its log."""
    arguments = ('-p', 'proportional_gains:=[400.0, 400.0, 400.0, 400.0]')
    _, errors = finish(lab.node('side_slip_controller', *arguments), 2)
    reason = errors.strip().splitlines()[-1].removeprefix('error: ')
    node = lab.node('side_slip_controller', *arguments, '-p', 'autostart:=false')
    script = """
import rclpy
from lifecycle_msgs.srv import ChangeState
from lifecycle_msgs.msg import Transition
rclpy.init()
node = rclpy.create_node('asks')
client = node.create_client(ChangeState, '/side_slip_controller/change_state')
assert client.wait_for_service(60.0)
future = client.call_async(ChangeState.Request(transition=Transition(id=Transition.TRANSITION_CONFIGURE)))
rclpy.spin_until_future_complete(node, future, timeout_sec=60.0)
print(future.result().success)
node.destroy_node()
rclpy.shutdown()
"""
    out, _ = finish(lab.start('-c', script))
    assert out.strip() == 'False'
    node.send_signal(signal.SIGINT)
    _, errors = finish(node)
    assert reason in errors
