"""Steady turns that slow driving does not lead to, against long simulations and roots found without any curve."""

import math

import numpy as np
import pytest
from scipy.optimize import root

from omni_vehicle_ros.model.body import Environment, derivative
from omni_vehicle_ros.model.other_turns import past_fold, tightened
from omni_vehicle_ros.model.plant import advance
from omni_vehicle_ros.model.state import initial_state
from omni_vehicle_ros.model.steady_turn import steady_turn, steady_turns
from omni_vehicle_ros.model.turning import turning
from omni_vehicle_ros.parameters import VehicleParameters

NONE = (0.0, 0.0, 0.0, 0.0)
SNOW = Environment(friction=(0.5, 0.5, 0.5, 0.5))
RADIUS, SPEED = 8.5, 12.0
STEP = 0.005


@pytest.fixture(scope='module')
def straight(vehicle):
    return steady_turns(vehicle, math.inf, Environment(), SPEED)


@pytest.fixture(scope='module')
def curve(straight):
    return tightened(straight, SPEED, 4.0)


@pytest.fixture(scope='module')
def drift(curve):
    (turn,) = curve.turns(RADIUS)
    return turn


def simulated(held, state, duration):
    angles = held.inputs.steer_angle
    return advance(state, angles, NONE, NONE, held.environment, held.constants, duration, STEP, constant_speed=True)


def started(twist):
    state = initial_state(twist.vx)
    state[1:3] = twist.vy, twist.r
    return state


def test_past_the_fold_there_is_a_stable_turn_that_slow_driving_does_not_lead_to(vehicle, drift):
    """It is wide and sideways, and swings with 12 s a period, hardly damped."""
    assert steady_turns(vehicle, RADIUS).limit.speed < 10.0
    assert steady_turn(vehicle, RADIUS, SPEED) is None
    assert drift.stable
    assert not drift.slides
    assert drift.residual < 1e-9
    assert (drift.twist.vx, drift.twist.vy, drift.twist.r) == pytest.approx((12.0, -4.89, 0.625), abs=0.01)
    assert np.degrees(drift.side_slip) == pytest.approx([27.0, 24.0, 17.0, 17.0], abs=0.6)
    assert drift.path_radius > 2.0 * RADIUS


def test_a_simulation_stays_in_it_and_comes_back_to_it(vehicle, drift):
    held = turning(vehicle, RADIUS, Environment())
    stayed = simulated(held, started(drift.twist), 300.0)
    assert stayed[1:3] == pytest.approx(drift.twist[1:], rel=1e-6)
    pushed = started(drift.twist)
    pushed[1] += 0.1
    back = simulated(held, pushed, 300.0)
    left = 0.1 * math.exp(-300.0 * drift.decay_rate)
    assert math.hypot(back[1] - drift.twist.vy, back[2] - drift.twist.r) < 2.0 * left


def test_who_tightens_the_turn_slowly_comes_to_it_and_who_speeds_up_does_not(vehicle, drift):
    tightening, faster = initial_state(SPEED), initial_state(8.0)
    for share in np.linspace(0.0, 1.0, 301):
        held = turning(vehicle, 1.0 / (share / RADIUS + (1.0 - share) / 40.0), Environment())
        tightening = simulated(held, tightening, 1.0)
        faster[0] = 8.0 + 4.0 * share
        faster = simulated(turning(vehicle, RADIUS, Environment()), faster, 1.0)
    held = turning(vehicle, RADIUS, Environment())
    assert simulated(held, tightening, 300.0)[1:3] == pytest.approx(drift.twist[1:], rel=1e-3)
    assert abs(faster[1]) > 2.0 * SPEED


@pytest.mark.parametrize('radius', [9.0, 15.0, 60.0])
def test_where_slow_driving_gets_so_far_both_ways_lead_to_one_turn(vehicle, curve, radius):
    (turn,) = curve.turns(radius)
    slow = steady_turn(vehicle, radius, SPEED)
    assert turn.twist == pytest.approx(slow.twist, rel=1e-8)
    assert turn.eigenvalues == pytest.approx(slow.eigenvalues, rel=1e-4)
    assert turn.path_radius == pytest.approx(slow.path_radius, rel=1e-8)


def roots(held, speed, count=60):
    """Return the steady turns that random starts lead to, of body slip up to 60 deg."""
    start, found = np.random.default_rng(0), []

    def rates(unknown):
        state = np.zeros(10)
        state[:3] = speed, unknown[0] * speed, unknown[1] * speed / held.wheelbase
        state[6:] = unknown[2:] * held.constants.relaxation_length
        return derivative(state, held.inputs, held.environment, held.constants, constant_speed=True)[[1, 2, 6, 7, 8, 9]]

    for _ in range(count):
        end = root(rates, start.uniform((-2.0, -5.0) + 4 * (-0.3,), (2.0, 5.0) + 4 * (0.3,)), tol=1e-12)
        new = not any(np.allclose(end.x[:2], other[:2], atol=1e-5) for other in found)
        if end.success and np.max(np.abs(end.fun)) < 1e-8 and abs(end.x[0]) < math.sqrt(3.0) and new:
            found.append(end.x)
    points = [held.curve.at(np.append(held.level(speed), place)) for place in found]
    return [held.turn(point) for point in points if point is not None]


@pytest.mark.parametrize(
    ('radius', 'speed', 'environment', 'stable', 'unstable'),
    [
        (RADIUS, SPEED, Environment(), 1, 0),
        (RADIUS, 9.0, Environment(), 1, 1),
        (2.0, 3.0, Environment(), 1, 1),
        (2.0, 4.0, Environment(), 0, 0),
        (6.0, 7.5, Environment(), 0, 0),
        (6.0, 15.0, Environment(), 1, 0),
        (15.0, 8.0, SNOW, 1, 0),
    ],
)
def test_random_starts_find_no_stable_turn_that_is_on_neither_curve(
    vehicle, radius, speed, environment, stable, unstable
):
    """What else there is, sideways or against the wheels, is unstable."""
    branch = steady_turns(vehicle, radius, environment, 20.0)
    slow = branch.turn(speed)
    straight = steady_turns(vehicle, math.inf, environment, speed)
    others = past_fold(branch, 20.0).turns(speed) + ([] if slow else tightened(straight, speed, radius).turns(radius))
    known = [*([slow] if slow else []), *others]
    assert [sum(turn.stable for turn in known), sum(not turn.stable for turn in known)] == [stable, unstable]
    found = roots(branch.turning, speed)
    assert sum(turn.stable for turn in found) == stable
    for turn in known:
        assert min(math.dist(turn.twist, other.twist) for other in found) < 1e-5 * speed


def test_past_the_fold_the_same_curve_comes_back_with_saddles(vehicle):
    """They meet the stable turns at the fold, from where the gap grows as the square root of the distance."""
    branch = steady_turns(vehicle, 5.0)
    rest, gaps = past_fold(branch, 20.0), []
    for distance in (4e-3, 1e-3):
        speed = branch.limit.speed - distance
        (saddle,) = rest.turns(speed)
        assert saddle.residual < 1e-9
        assert saddle.damping_ratio is None
        gaps.append(branch.turn(speed).twist.vy - saddle.twist.vy)
    assert gaps[0] / gaps[1] == pytest.approx(2.0, rel=0.02)
    assert rest.turns(branch.limit.speed + 1e-3) == []


def test_a_saddle_parts_what_comes_back_from_what_spins(vehicle):
    branch = steady_turns(vehicle, 5.0)
    (saddle,) = past_fold(branch, 20.0).turns(6.0)
    ends = []
    for share in (0.9, 1.1):
        state = started(saddle.twist)
        state[1:3] += (share - 1.0) * np.array(saddle.twist[1:])
        ends.append(simulated(branch.turning, state, 60.0)[1])
    assert ends[0] == pytest.approx(branch.turn(6.0).twist.vy, rel=1e-3)
    assert abs(ends[1]) > 2.0 * 6.0


def test_a_curve_that_does_not_turn_back_has_nothing_past_a_fold(vehicle):
    assert past_fold(steady_turns(vehicle, 10.0), 20.0).turns(5.0) == []


def test_faster_than_straight_on_can_be_there_is_nothing_to_tighten(vehicle):
    ice = Environment(bank=0.3, friction=(0.1, 0.1, 0.1, 0.1))
    assert tightened(steady_turns(vehicle, math.inf, ice, 5.0), 5.0, 4.0).turns(8.0) == []


def test_a_tall_vehicle_is_followed_until_a_wheel_lifts():
    tall = VehicleParameters(roll_arm=1.1, cornering_stiffness=6e4)
    points = tightened(steady_turns(tall, math.inf, Environment(), 15.0), 15.0, 4.0)
    assert points.turns(4.0) == []
    assert all(min(turn.vertical_load) > 0.0 for turn in points.turns(60.0))
    assert points.turns(60.0)
