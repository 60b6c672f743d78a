"""Faults on a real graph: the same in all modes, processes that really die, and the parameters of live nodes."""

import signal
import textwrap
from pathlib import Path

import numpy as np
import pytest

from omni_vehicle_ros.bags import open_bag, read_messages
from omni_vehicle_ros.faults import make_fault, read_faults
from omni_vehicle_ros.messages import decode

from .conftest import Lab, finish, until
from .test_live import diagnostics
from .test_modes import contents

pytestmark = pytest.mark.graph

DRIVE = """
duration: 1.2
side_slip_control: true
plant: {initial_speed: 4.0}
commands:
  - {at: 0.0, icr: straight, speed: 4.0}
  - {at: 0.2, icr: [0.0, 10.0], speed: 4.0}
faults:
"""

MANY = DRIVE + """
  - {at: 0.0, component: messages/rear_right/state, failure: intermittent}
  - {at: 0.1, component: messages/front_left/command, failure: delayed, value: 0.03}
  - {at: 0.2, component: messages/front_left/trim, failure: garbage}
  - {at: 0.3, component: front_left/steering, failure: off, for: 0.4}
  - {at: 0.3, component: front_right/brake, failure: stuck, for: 0.1}
  - {at: 0.3, component: imu, failure: garbage}
  - {at: 0.4, component: odom, failure: off, for: 0.1}
  - {at: 0.4, component: joint_states, failure: intermittent, value: 0.1, for: 0.2}
  - {at: 0.4, component: rear_left/drive, failure: garbage}
  - {at: 0.4, component: rear_left/module, failure: delayed, value: 0.001}
  - {at: 0.5, component: messages/tyres/side_slip, failure: reordered}
  - {at: 0.5, component: messages/driver/speed, failure: duplicated}
  - {at: 0.6, component: clock, failure: wrong, value: 0.3}
  - {at: 1.0, component: clock, failure: wrong, value: -0.1}
"""


def test_faults_are_the_same_in_all_modes(lab: Lab) -> None:
    """All kinds of them together, the clock's included, byte for byte; and nothing is said to be lost."""
    scenario = str(lab.scenario(MANY))
    for mode in ('offline', 'one-process', 'processes'):
        out, _ = finish(lab.command('run', scenario, '--mode', mode, '--out', mode))
        assert ' 0 lost' in out
    expected = contents(lab.path / 'offline')
    assert len(expected['/odom']) == 201  # 60 cycles are jumped over, 20 are there twice
    assert '/odom/truth' in expected
    for mode in ('one-process', 'processes'):
        assert contents(lab.path / mode) == expected


LOST_MODULES = 'front_left/wheel_module, rear_right/wheel_module'

LOST = DRIVE + """
  - {at: 0.5, component: front_left/module, failure: off}
  - {at: 0.5, component: rear_right/module, failure: stuck}
  - {at: 0.6, component: driver, failure: off}
"""


def test_processes_kill_and_freeze_themselves_in_the_cycle_that_is_told(lab: Lab) -> None:
    """The others go on to the end, which is no failure of the run, and the frozen process ends with it.

    The modules don't answer any more in that cycle; the driver has said in it what it had to say.
    """
    finish(lab.command('run', str(lab.scenario(LOST)), '--out', 'run'))
    bag = open_bag(lab.path / 'run' / 'bag')
    assert bag['front_left/state'].stamp[-1] == bag['rear_right/state'].stamp[-1] == pytest.approx(0.495)
    assert bag['driver/step'].stamp[-1] == bag['driver/icr'].stamp[-1] == pytest.approx(0.6)
    assert bag['odom'].stamp[-1] == pytest.approx(1.2)
    torque = bag['joint_states'].effort[-1, 4:]
    assert torque[0] == torque[3] == 0.0
    said = {(name, text) for _, name, text in diagnostics(lab.path / 'run' / 'bag')}
    assert ('/plant', f'no answer from {LOST_MODULES}: no torque, steer angle held') in said
    assert any('command_timeout' in text for name, text in said if name == '/icr_steering')


CLIENT = textwrap.dedent("""
    import sys
    import rclpy
    from rclpy.parameter import Parameter
    from rclpy.parameter_client import AsyncParameterClient

    rclpy.init()
    node = rclpy.create_node('client')
    client = AsyncParameterClient(node, sys.argv[1])
    assert client.wait_for_services(30.0)
    for setting in sys.argv[2:]:
        name, _, value = setting.partition('=')
        for _ in range(10):
            future = client.set_parameters([Parameter(name, value=value)])
            rclpy.spin_until_future_complete(node, future, timeout_sec=5.0)
            if future.done():
                break
        result = future.result().results[0]
        print('set' if result.successful else result.reason, flush=True)
    node.destroy_node()
    rclpy.shutdown()
""")


def injected(bag: Path) -> list:
    found = []
    for message in read_messages(bag):
        if message.topic == '/faults':
            found += read_faults(decode(message.type_name, message.data))[0]
    return found


def test_faults_of_a_live_vehicle_are_set_by_parameters_and_lie_in_the_bag(lab: Lab) -> None:
    vehicle = lab.command('start', '--fault-injection', '--out', 'run')
    bag = lab.path / 'run' / 'bag'
    until(lambda: (bag / 'bag_0.mcap').exists() and (bag / 'bag_0.mcap').stat().st_size > 20_000, 'the vehicle')
    out, _ = finish(lab.start('-c', CLIENT, 'plant', 'fault.imu=wrong 2.0', 'fault.imu=sleepy', 'fault.imu=wrong 99'))
    assert out.splitlines()[0] == 'set'
    assert "imu: unknown failure 'sleepy'; allowed: ok, off, stuck" in out
    assert 'imu: wrong: 99 is outside -10 .. 10' in out
    out, _ = finish(lab.start('-c', CLIENT, 'front_left/wheel_module', 'fault.steering=wrong 0.2'))
    assert out == 'set\n'
    faults = [make_fault('imu', 'wrong', 2.0), make_fault('front_left/steering', 'wrong', 0.2)]
    until(lambda: set(injected(bag)) == {*faults}, 'both faults in the bag')
    until(lambda: _angle(bag) > 0.15, 'the wheel that goes to where nobody wants it')
    vehicle.send_signal(signal.SIGINT)
    finish(vehicle)
    gravity = {float(value) for value in np.unique(open_bag(bag)['imu'].az)}
    assert gravity == {9.81, 19.62}


def _angle(bag: Path) -> float:
    last = [message for message in read_messages(bag) if message.topic == '/joint_states'][-1]
    return decode(last.type_name, last.data).position[0]


def test_without_fault_injection_faults_are_refused(lab: Lab) -> None:
    node = lab.node('plant')
    out, _ = finish(lab.start('-c', CLIENT, 'plant', 'fault.odom=stuck', 'fault.odom=ok'))
    assert out == 'fault.odom: fault_injection is false; start the node with it set to true\nset\n'
    node.terminate()
    finish(node)
    _, errors = finish(lab.node('plant', '-p', 'fault.odom:=stuck'), 2)
    assert errors == 'error: fault.odom: fault_injection is false; start the node with it set to true\n'
