import dataclasses
import json
import math

import pytest

from omni_vehicle_ros.analysis import compute_metrics
from omni_vehicle_ros.analysis.turn_limit import turn_limit
from omni_vehicle_ros.model.dynamics import Environment
from omni_vehicle_ros.model.kinematics import Icr, road_steer_angles
from omni_vehicle_ros.model.steady_turn import limit_speed
from omni_vehicle_ros.parameters import VehicleParameters
from omni_vehicle_ros.wheels import WHEELS

CAR = VehicleParameters()


@pytest.fixture
def turn(motion):
    """Make a turn at a held speed about an ICR that stands still."""

    def make(radius=2.0, speed=3.0):
        turning = motion(4.0, radius, speed)
        turning.icr, turning.steer_angles = (0.0, radius), road_steer_angles(Icr(0.0, radius), CAR)
        return turning

    return make


@pytest.mark.parametrize('radius', [2.0, -3.0])
def test_a_held_turn_knows_its_limit(turn, bag_of, radius):
    metrics = compute_metrics(bag_of(turn(radius)))
    expected = limit_speed(CAR, radius)
    assert metrics['steady'] == {
        'reached': True, 'reason': None, 'limit_speed': expected.speed, 'limit_cause': expected.cause}
    json.dumps(metrics, allow_nan=False)


def test_past_its_limit_a_turn_that_looks_settled_is_not_steady(turn, bag_of):
    """Near a fold the motion creeps, slower than any test of settling sees."""
    steady = compute_metrics(bag_of(turn(2.0, 3.26)))['steady']
    assert not steady['reached']
    assert steady['reason'] == 'faster than 3.254 m/s, up to which there is a stable steady turn of this radius'
    assert steady['limit_cause'] == 'fold'


def test_road_and_vehicle_count(turn, bag_of):
    slippery = turn()
    slippery.friction, slippery.bank = [(0.0, dict.fromkeys(WHEELS, 0.5))], 0.02
    heavy = dataclasses.replace(CAR, mass=1500.0)
    expected = limit_speed(heavy, 2.0, Environment(bank=0.02, friction=(0.5,) * 4))
    assert turn_limit(bag_of(slippery), heavy) == expected
    assert expected.speed != limit_speed(CAR, 2.0).speed


def spoiled(name, turning):
    if name == 'speed that changes':
        turning.vx[-1] += 1e-9
    elif name == 'backwards':
        turning.vx[:] *= -1.0
    elif name == 'no ICR':
        turning.icr = None
    elif name == 'ICR ahead':
        turning.icr = (0.1, 2.0)
    elif name == 'ICR that is no number':
        turning.icr = (0.0, math.nan)
    elif name == 'ICR within the track':
        turning.icr = (0.0, 0.5)
    elif name == 'trimmed wheel':
        turning.steer_angles = (turning.steer_angles[0] - 0.01, *turning.steer_angles[1:])
    elif name == 'straight on':
        turning.icr, turning.steer_angles = (0.0, 1e6), (1e-6,) * 2 + (-1e-6,) * 2
    return turning


@pytest.mark.parametrize('name', [
    'speed that changes', 'backwards', 'no ICR', 'ICR ahead', 'ICR that is no number', 'ICR within the track',
    'trimmed wheel', 'straight on',
])
def test_of_anything_else_no_limit_is_known(turn, bag_of, name):
    assert turn_limit(bag_of(spoiled(name, turn())), CAR) is None
