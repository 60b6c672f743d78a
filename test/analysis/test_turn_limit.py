import dataclasses
import json
import math

import pytest

from omni_vehicle_ros.analysis import compute_metrics
from omni_vehicle_ros.analysis.turn_limit import turn_limit
from omni_vehicle_ros.model.dynamics import Environment
from omni_vehicle_ros.model.kinematics import Icr, road_steer_angles
from omni_vehicle_ros.model.steady_turn import limit_speed, steady_turn
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


def test_past_its_limit_a_turn_that_has_settled_is_steady(turn, bag_of):
    """At 8.5 m and 12 m/s there is a stable turn, to which a vehicle comes from a wider one."""
    settled = turn(8.5, 12.0)
    settled.vy[:], settled.yaw_rate[:] = -4.889, 0.6254
    metrics = compute_metrics(bag_of(settled))
    limit = limit_speed(CAR, 8.5)
    assert limit.speed < 10.0
    assert metrics['steady'] == {
        'reached': True, 'reason': None, 'limit_speed': limit.speed, 'limit_cause': 'fold'}
    assert metrics['path']['radius'] == pytest.approx(math.hypot(12.0, 4.889) / 0.6254)


def test_just_past_its_limit_a_turn_that_looks_settled_is_not_steady(turn, bag_of):
    """Near a fold the motion creeps, slower than any test of settling sees; it does so where the turn was."""
    creeping, end = turn(2.0, 3.26), steady_turn(CAR, 2.0, limit_speed(CAR, 2.0).speed)
    creeping.vy[:], creeping.yaw_rate[:] = end.twist.vy, end.twist.r
    steady = compute_metrics(bag_of(creeping))['steady']
    assert not steady['reached']
    assert steady['reason'] == 'creeping past where a steady turn was, above the limit speed'


@pytest.mark.parametrize(('speed', 'reason'), [
    (3.0, 'lateral speed still changing'), (3.5, 'lateral speed still changing, above the limit speed')])
def test_only_of_a_turn_that_has_not_settled_the_limit_is_the_reason(turn, bag_of, speed, reason):
    changing = turn(2.0, speed)
    changing.vy[:] = -0.5 * changing.time
    assert compute_metrics(bag_of(changing))['steady']['reason'] == reason


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
