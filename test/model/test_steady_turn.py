"""Steady turns found directly, against long simulations, linear theory and the way a fold looks."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omni_vehicle_ros.errors import CommandError, ParameterError
from omni_vehicle_ros.model.body import Environment, evaluate
from omni_vehicle_ros.model.linear import linear_bicycle
from omni_vehicle_ros.model.plant import advance
from omni_vehicle_ros.model.state import initial_state
from omni_vehicle_ros.model.steady_turn import limit_speed, steady_turn, steady_turns
from omni_vehicle_ros.model.turning import turning
from omni_vehicle_ros.model.tyres.region import Region
from omni_vehicle_ros.parameters import VehicleParameters

NONE = (0.0, 0.0, 0.0, 0.0)
SNOW = Environment(friction=(0.5, 0.5, 0.5, 0.5))
STEP = 0.005


def simulated(held, state, duration, step=STEP):
    """Return where the plant is after a while with its wheels and its forward speed held."""
    angles = held.inputs.steer_angle
    return advance(state, angles, NONE, NONE, held.environment, held.constants, duration, step, constant_speed=True)


def started(twist, speed=None):
    """Return a state with this motion, its path kept at another speed."""
    scale = 1.0 if speed is None else speed / twist.vx
    state = initial_state(scale * twist.vx)
    state[1:3] = scale * twist.vy, scale * twist.r
    return state


@pytest.mark.parametrize(
    ('radius', 'kmh', 'environment', 'settling'),
    [
        (2.0, 6.0, Environment(), 10.0),
        (2.0, 10.0, Environment(), 20.0),
        (5.0, 15.0, Environment(), 10.0),
        (-5.0, 15.0, Environment(bank=0.05), 10.0),
        (5.0, 22.0, Environment(), 60.0),
        (10.0, 20.0, SNOW, 20.0),
        (10.0, 35.0, Environment(), 120.0),
        (0.8, 3.0, Environment(), 20.0),
        (15.0, 80.0, Environment(wind=-10.0), 120.0),
        (-20.0, 40.0, Environment(bank=-0.02, wind=8.0, friction=(0.9, 0.5, 0.9, 0.5)), 20.0),
        (3.0, 1.5, Environment(bank=0.1), 60.0),
        (math.inf, 80.0, Environment(bank=0.02, wind=5.0), 20.0),
    ],
)
def test_a_long_simulation_ends_in_it(vehicle, radius, kmh, environment, settling):
    turn = steady_turn(vehicle, radius, kmh / 3.6, environment)
    held = turning(vehicle, radius, environment)
    end = simulated(held, initial_state(kmh / 3.6), settling)
    seen = evaluate(end, held.inputs, environment, held.constants, constant_speed=True)
    assert (turn.twist.vy, turn.twist.r) == pytest.approx((end[1], end[2]), rel=1e-6, abs=1e-8)
    assert turn.side_slip == pytest.approx(seen.side_slip, rel=1e-6, abs=1e-8)
    assert turn.vertical_load == pytest.approx(seen.vertical_load, rel=1e-6)
    assert turn.friction_use == pytest.approx(seen.friction_use, rel=1e-6, abs=1e-8)
    assert turn.lateral_acceleration == pytest.approx(seen.ay, rel=1e-6, abs=1e-8)
    assert turn.stable
    assert turn.residual < 1e-9


def test_the_turn_that_the_thesis_controls(vehicle):
    """R = 5 m at 15 km/h, as the simulation of its chapter 5 begins."""
    turn = steady_turn(vehicle, 5.0, 15.0 / 3.6)
    assert np.degrees(turn.side_slip) == pytest.approx([2.94, 2.06, 1.85, 1.72], abs=0.005)
    assert turn.path_radius == pytest.approx(5.24, abs=0.005)
    assert turn.region == (Region.NONLINEAR, Region.LINEAR, Region.NONLINEAR, Region.LINEAR)


@pytest.mark.parametrize('radius', [1.0, 5.0, -20.0])
def test_a_creeping_vehicle_turns_about_its_icr(vehicle, radius):
    """Slip grows with the square of the speed from nothing, and so does what the path departs by."""
    slips, departures = [], []
    for root in (0.03, 0.06):
        turn = steady_turn(vehicle, radius, root * math.sqrt(abs(radius)))
        slips.append(max(map(abs, turn.side_slip)))
        departures.append(turn.path_radius / radius - 1.0)
    assert slips[0] < 1e-4
    assert slips[1] / slips[0] == pytest.approx(4.0, rel=0.02)
    assert departures[1] / departures[0] == pytest.approx(4.0, rel=0.02)


def sampled(held, twist, duration, size=1e-5):
    """Return how (vy, r) of a disturbed plant depends on that of the steady turn some time before, shape (2, 2)."""
    columns = []
    for disturbance in size * np.eye(2):
        ends = []
        for sign in (1.0, -1.0):
            state = started(twist)
            state[1:3] += sign * disturbance
            ends.append(simulated(held, state, duration)[1:3])
        columns.append((ends[0] - ends[1]) / (2.0 * size))
    return np.column_stack(columns)


@pytest.mark.parametrize(
    ('radius', 'speed', 'environment', 'duration'),
    [
        (5.0, 4.0, Environment(), 0.05),
        (5.0, 6.1, Environment(), 0.5),
        (10.0, 9.0, Environment(), 0.5),
        (20.0, 15.0, Environment(wind=5.0), 0.5),
        (10.0, 20.0, Environment(), 2.0),
        (-8.0, 6.0, SNOW, 0.5),
    ],
)
def test_disturbances_change_as_the_eigenvalues_say(vehicle, radius, speed, environment, duration):
    """What a disturbance becomes in a time T has the eigenvalues exp(lambda T) (Floquet of a constant flow)."""
    turn = steady_turn(vehicle, radius, speed, environment)
    change = sampled(turning(vehicle, radius, environment), turn.twist, duration)
    first, second = np.exp(np.array(turn.eigenvalues) * duration)
    assert np.trace(change) == pytest.approx((first + second).real, rel=1e-5, abs=1e-6)
    assert np.linalg.det(change) == pytest.approx((first * second).real, rel=1e-4, abs=1e-6)
    slowest = max(abs(first), abs(second))
    assert slowest == pytest.approx(math.exp(-turn.decay_rate * duration))


@pytest.mark.parametrize('speed', [0.1, 0.5, 1.0, 1.4])
def test_below_walking_pace_disturbances_decay_too(vehicle, speed):
    turn = steady_turn(vehicle, 2.0, speed)
    held = turning(vehicle, 2.0, Environment())
    settled = simulated(held, started(turn.twist), 60.0)
    pushed = settled.copy()
    pushed[1:3] += 0.02 * speed
    assert simulated(held, pushed, 60.0)[1:3] == pytest.approx(turn.twist[1:], rel=1e-6, abs=1e-9)
    assert turn.stable


@pytest.mark.parametrize('speed', [2.0, 10.0, 30.0])
def test_straight_on_the_eigenvalues_are_those_of_the_linear_bicycle(stiff_vehicle, speed):
    expected = np.sort_complex(np.linalg.eigvals(linear_bicycle(stiff_vehicle, speed).state_matrix))
    found = steady_turn(stiff_vehicle, math.inf, speed)
    assert np.sort_complex(found.eigenvalues) == pytest.approx(expected, rel=1e-6)
    assert found.path_radius == math.inf
    assert found.side_slip == NONE
    frequency, product = np.sqrt(np.prod(expected)).real, np.sum(expected).real
    assert found.damping_ratio == pytest.approx(-0.5 * product / frequency, rel=1e-6)


def test_a_gentle_turn_is_that_of_the_linear_bicycle_but_for_the_square_of_its_slip(stiff_vehicle):
    """Both axles are steered: the path is R (1 + K v^2 / L), with K the understeer gradient (Abe, ch. 3)."""
    speed, errors = 12.0, []
    bicycle = linear_bicycle(stiff_vehicle, speed)
    widening = 1.0 + bicycle.understeer_gradient * speed**2 / stiff_vehicle.wheelbase
    expected = np.sort_complex(np.linalg.eigvals(bicycle.state_matrix))
    for radius in (400.0, 800.0):
        turn = steady_turn(stiff_vehicle, radius, speed)
        gap = np.abs(np.sort_complex(turn.eigenvalues) / expected - 1.0)
        errors.append((abs(turn.path_radius / (radius * widening) - 1.0), np.max(gap)))
        assert turn.region == (Region.LINEAR,) * 4
    assert np.all(np.array(errors[0]) < 1e-4)
    assert np.array(errors[0]) / np.array(errors[1]) == pytest.approx(4.0, rel=0.05)


VEHICLES = st.builds(
    VehicleParameters,
    mass=st.floats(1170.0, 2500.0),
    cg_to_front_axle=st.floats(0.8, 1.8),
    cg_to_rear_axle=st.floats(0.8, 1.8),
    front_track=st.floats(1.2, 1.8),
    rear_track=st.floats(1.2, 1.8),
    yaw_inertia=st.floats(1000.0, 3000.0),
    cornering_stiffness=st.floats(2e4, 6e4),
    tyre_model=st.sampled_from(['dugoff', 'brush', 'magic_formula', 'lugre']),
)
ENVIRONMENTS = st.builds(
    Environment,
    bank=st.floats(-0.05, 0.05),
    wind=st.floats(-10.0, 10.0),
    friction=st.floats(0.4, 1.0).map(lambda friction: (friction,) * 4),
)


@settings(deadline=None, max_examples=25)
@given(VEHICLES, ENVIRONMENTS, st.floats(1.2, 50.0), st.floats(0.05, 0.5))
def test_the_mirror_image_of_a_turn_is_a_turn(vehicle, environment, radius, lateral):
    speed = math.sqrt(lateral * environment.friction[0] * 9.81 * radius)
    left = steady_turn(vehicle, radius, speed, environment)
    mirrored = Environment(-environment.bank, -environment.wind, environment.friction)
    right = steady_turn(vehicle, -radius, speed, mirrored)
    if left is None or right is None:
        assert left is right
        return
    assert (left.twist.vy, left.twist.r) == pytest.approx((-right.twist.vy, -right.twist.r), abs=1e-9)
    assert left.side_slip == pytest.approx([-right.side_slip[i] for i in (1, 0, 3, 2)], abs=1e-9)
    assert left.path_radius == pytest.approx(-right.path_radius, rel=1e-8)
    assert left.decay_rate == pytest.approx(right.decay_rate, rel=1e-4)
    assert left.residual < 1e-8


@pytest.mark.parametrize(('radius', 'environment'), [(2.0, Environment()), (5.0, Environment()), (3.0, SNOW)])
def test_at_the_limit_the_steady_turn_vanishes(vehicle, radius, environment):
    """1e-4 m/s below the fold the plant comes to rest in the turn, 1e-4 m/s above it creeps past and spins."""
    branch = steady_turns(vehicle, radius, environment)
    limit, cause = branch.limit[:2]
    assert cause == 'fold'
    held, start = branch.turning, branch.turn(limit).twist
    below = branch.turn(limit - 1e-4)
    assert branch.turn(limit + 1e-4) is None
    near = simulated(held, started(start, limit - 1e-4), 300.0)
    assert abs(near[1] - below.twist.vy) < 0.1 * abs(start.vy - below.twist.vy)
    assert abs(simulated(held, started(start, limit + 1e-4), 600.0)[1]) > 100.0


def test_near_the_fold_the_decay_rate_goes_with_the_square_root_of_the_distance(vehicle):
    branch = steady_turns(vehicle, 5.0)
    limit = branch.limit.speed
    rates = [branch.turn(limit - distance).decay_rate for distance in (4e-4, 1e-4, 0.25e-4)]
    assert rates[0] / rates[1] == pytest.approx(2.0, rel=0.02)
    assert rates[1] / rates[2] == pytest.approx(2.0, rel=0.02)
    assert branch.turn(limit).decay_rate == pytest.approx(0.0, abs=1e-3)
    assert [branch.limit.margin(limit * share) for share in (0.5, 1.0, 1.5)] == pytest.approx([0.5, 0.0, -0.5])


def test_known_turns_at_a_radius_of_2_m(vehicle):
    assert steady_turn(vehicle, 2.0, 10.0 / 3.6).stable
    assert 11.5 / 3.6 < limit_speed(vehicle, 2.0).speed < 12.0 / 3.6
    assert steady_turn(vehicle, 2.0, 14.0 / 3.6) is None


def oversteering():
    lengths = {'cg_to_front_axle': 1.454, 'cg_to_rear_axle': 1.0}
    return VehicleParameters(**lengths, load_transfer=False, front_roll_steer=0.0, rear_roll_steer=0.0)


def test_an_oversteering_vehicle_diverges_at_its_critical_speed():
    """Straight on at sqrt(-L / K) (Abe, ch. 3); the wider the turn, the nearer to that is the fold that loses it."""
    vehicle = oversteering()
    critical = math.sqrt(-vehicle.wheelbase / linear_bicycle(vehicle, 10.0).understeer_gradient)
    straight = limit_speed(vehicle, math.inf)
    assert straight.cause == 'divergence'
    assert straight.speed == pytest.approx(critical, rel=1e-7)
    turns = [limit_speed(vehicle, radius) for radius in (10.0, 100.0, 500.0, 1e4)]
    assert {turn.cause for turn in turns} == {'fold'}
    speeds = [turn.speed for turn in turns]
    assert speeds == sorted(speeds)
    assert 0.99 * critical < speeds[-1] < critical
    unstable = steady_turn(vehicle, math.inf, 1.01 * critical)
    assert not unstable.stable
    assert unstable.damping_ratio is None


def test_a_vehicle_that_begins_to_oscillate():
    vehicle = VehicleParameters(cg_to_front_axle=1.3, cg_to_rear_axle=1.154)
    branch = steady_turns(vehicle, 50.0)
    limit, cause = branch.limit[:2]
    assert cause == 'oscillation'
    for share in (0.99, 1.01):
        turn = branch.turn(share * limit)
        change = sampled(branch.turning, turn.twist, 2.0)
        assert turn.stable == (np.linalg.det(change) < 1.0) == (share < 1.0)
        assert abs(turn.eigenvalues[0].imag) > 0.1


def test_past_the_largest_lateral_acceleration_the_vehicle_only_runs_wide(vehicle):
    """R = 10 m: nothing is lost, but from some speed on the front tyres give less, until both of them slide."""
    branch = steady_turns(vehicle, 10.0)
    speed, cause, grip, slide = branch.limit
    assert (speed, cause) == (None, None)
    assert not branch.turn(slide - 1e-3).slides
    assert branch.turn(slide + 1e-3).slides
    assert branch.turn(slide + 1e-3).path_radius > branch.turn(slide - 1e-3).path_radius > 6.0 * 10.0
    best = branch.turn(grip).lateral_acceleration
    for other in (grip - 0.2, grip + 0.2):
        assert branch.turn(other).lateral_acceleration < best
    assert branch.turn(grip).path_radius > 1.5 * 10.0


@pytest.mark.parametrize('radius', [9.0, 10.0])
def test_a_turn_with_a_sliding_axle_is_come_to_by_speeding_up_and_is_stable(vehicle, radius):
    """The plant speeds up by 0.5 m/s a step to past where both front tyres slide, and shakes off a push there."""
    branch = steady_turns(vehicle, radius)
    top = branch.limit.slide_speed + 1.0
    state = started(branch.turn(0.5 * top).twist)
    for speed in np.append(np.arange(0.5 * top, top, 0.5), top):
        state[0] = speed
        state = simulated(branch.turning, state, 4.0)
    sliding = branch.turn(top)
    assert sliding.slides
    assert sliding.stable
    state[1] += 0.1
    end = simulated(branch.turning, state, 16.0 / sliding.decay_rate)  # leaves 1e-7 of the push
    assert end[1:3] == pytest.approx(sliding.twist[1:], rel=1e-5)


@settings(deadline=None, max_examples=20)
@given(VEHICLES, ENVIRONMENTS, st.floats(1.2, 30.0), st.floats(0.0, 1.0))
def test_up_to_its_limit_and_no_farther_a_turn_is_stable(vehicle, environment, radius, share):
    branch = steady_turns(vehicle, radius, environment, 25.0)
    limit, _, grip, slide = branch.limit
    end = min(branch.end, 25.0) if limit is None else limit
    assert all(mark is None or limit is None or mark <= limit for mark in (grip, slide))
    if end > 0.2:
        turn = branch.turn(0.1 + share * 0.999 * (end - 0.1))
        assert turn.stable
        assert not turn.lifted
    if limit:
        past = branch.turn(limit + 1e-3)
        assert past is None or not past.stable or past.skids or past.lifted


def test_a_tall_vehicle_lifts_a_wheel_first():
    vehicle = VehicleParameters(roll_arm=1.1, cornering_stiffness=6e4)
    branch = steady_turns(vehicle, 20.0)
    speed, cause = branch.limit[:2]
    assert cause == 'lift'
    loads = branch.turn(speed - 1e-3).vertical_load
    assert 0.0 < min(loads) < 1e-3 * sum(loads)


def test_where_there_is_no_grip_there_is_no_turn(vehicle):
    ice = Environment(bank=0.3, friction=(0.1, 0.1, 0.1, 0.1))
    assert limit_speed(vehicle, 10.0, ice) == (0.0, 'skid', None, None)
    assert steady_turn(vehicle, 10.0, 1.0, ice) is None
    assert limit_speed(vehicle, 10.0, ice).margin(1.0) == -math.inf


def test_up_to_a_top_speed_nothing_may_happen(vehicle):
    limit = limit_speed(vehicle, 10.0, top_speed=8.0)
    assert limit == (None, None, None, None)
    assert limit.margin(5.0) is None
    assert steady_turns(vehicle, 10.0, top_speed=8.0).turn(9.0) is None


def test_what_cannot_be_asked_is_refused(vehicle):
    with pytest.raises(CommandError, match=r'0\.7 m .* 0\.718 m'):
        steady_turn(vehicle, 0.7, 1.0)
    for speed in (0.0, -1.0, math.nan):
        with pytest.raises(ParameterError, match='above 0'):
            steady_turn(vehicle, 5.0, speed)
