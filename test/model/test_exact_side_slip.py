"""The exact algebraic form of proportional side-slip control: delta = delta0 - K alpha, at every instant."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from omni_vehicle_ros.model.body import Environment, Inputs, derivative, evaluate
from omni_vehicle_ros.model.constants import constants
from omni_vehicle_ros.model.contact import CREEPING_PACE, WALKING_PACE, trim_share
from omni_vehicle_ros.model.kinematics import Icr, road_steer_angles
from omni_vehicle_ros.model.plant import advance
from omni_vehicle_ros.model.state import State, initial_state, state_vector, state_view
from omni_vehicle_ros.parameters import VehicleParameters

VEHICLE = VehicleParameters()
MODEL = constants(VEHICLE)
NO_ROLL_STEER = constants(VehicleParameters(front_roll_steer=0.0, rear_roll_steer=0.0))
ROLL_STEER = (VEHICLE.front_roll_steer,) * 2 + (VEHICLE.rear_roll_steer,) * 2
NONE = (0.0, 0.0, 0.0, 0.0)
ROAD = Environment()
quiet = settings(deadline=None, max_examples=80, derandomize=True)


def four(low, high):
    return st.tuples(*(st.floats(low, high) for _ in range(4)))


def moving(vx, vy, r):
    return state_vector(State(vx, vy, r, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0))


def directions(state):
    vx, vy, r = state[:3]
    return [
        math.atan2(vy + x * r, vx - y * r) for x, y in zip(VEHICLE.wheel_x, VEHICLE.wheel_y, strict=True)
    ]


# All wheels roll forward, faster than walking pace, at less than 90 deg of slip.
driving = st.builds(moving, st.floats(3.0, 30.0), st.floats(-2.0, 2.0), st.floats(-1.0, 1.0))
gains = four(0.0, 20.0)


@quiet
@given(driving, four(-0.5, 0.5), gains)
def test_slip_is_that_of_the_set_point_over_one_plus_the_gain(state, angles, gain):
    free = evaluate(state, Inputs(angles), ROAD, NO_ROLL_STEER)
    found = evaluate(state, Inputs(angles, slip_gain=gain), ROAD, NO_ROLL_STEER)
    for i in range(4):
        assert found.side_slip[i] == pytest.approx(free.side_slip[i] / (1.0 + gain[i]), abs=1e-12)
        assert found.steer_angle[i] == pytest.approx(angles[i] - gain[i] * found.side_slip[i], abs=1e-12)


@quiet
@given(driving, four(-0.5, 0.5), gains, st.floats(-0.2, 0.2).map(Environment))
def test_with_roll_steer_angle_slip_and_roll_are_one_solution(state, angles, gain, road):
    found = evaluate(state, Inputs(angles, slip_gain=gain), road, MODEL)
    for i, direction in enumerate(directions(state)):
        slip = found.steer_angle[i] + ROLL_STEER[i] * found.roll_angle - direction
        assert found.side_slip[i] == pytest.approx(slip, abs=1e-9)
        assert found.steer_angle[i] == pytest.approx(angles[i] - gain[i] * slip, abs=1e-9)


@quiet
@given(driving, four(-0.5, 0.5), gains, four(-3000.0, 3000.0))
def test_the_forces_are_those_of_wheels_that_stand_at_the_real_angles(state, angles, gain, forces):
    found = evaluate(state, Inputs(angles, forces, gain), ROAD, MODEL)
    fixed = evaluate(state, Inputs(found.steer_angle, forces), ROAD, MODEL)
    assert found.ay == pytest.approx(fixed.ay, abs=1e-8)
    assert found.lateral_force == pytest.approx(fixed.lateral_force, rel=1e-7, abs=0.01)
    rates = derivative(state, Inputs(angles, forces, gain), ROAD, MODEL)
    assert rates == pytest.approx(derivative(state, Inputs(found.steer_angle, forces), ROAD, MODEL), abs=1e-6)


def test_a_wheel_without_gain_stands_at_its_set_point():
    angles, gain = (0.2, 0.15, -0.1, -0.05), (5.0, 0.0, 0.0, 2.0)
    found = evaluate(moving(6.0, 0.3, 0.5), Inputs(angles, slip_gain=gain), ROAD, MODEL)
    assert found.steer_angle[1:3] == angles[1:3]


@quiet
@given(driving, four(-0.5, 0.5))
def test_a_wheel_that_rolls_backward_steers_away_from_its_slip_too(state, angles):
    back = state.copy()
    back[:3] *= -1.0
    ahead = evaluate(state, Inputs(angles, slip_gain=(5.0,) * 4), ROAD, NO_ROLL_STEER)
    found = evaluate(back, Inputs(angles, slip_gain=(5.0,) * 4), ROAD, NO_ROLL_STEER)
    assert found.steer_angle == pytest.approx(ahead.steer_angle, abs=1e-12)
    assert found.side_slip == pytest.approx(tuple(-slip for slip in ahead.side_slip), abs=1e-12)


@quiet
@given(four(-3.1, 3.1), four(0.0, 1e3), st.floats(-math.pi, math.pi))
def test_no_trim_passes_a_right_angle_to_the_velocity(angles, gain, direction):
    state = moving(8.0 * math.cos(direction), 8.0 * math.sin(direction), 0.0)
    found = evaluate(state, Inputs(angles, slip_gain=gain), ROAD, NO_ROLL_STEER)
    for i in range(4):
        limit = 0.5 * math.pi * gain[i] / (1.0 + gain[i])
        assert abs(found.steer_angle[i] - angles[i]) <= limit + 1e-12
        assert abs(found.side_slip[i]) <= 0.5 * math.pi / (1.0 + gain[i]) + 1e-9


def test_the_gain_fades_out_below_walking_pace():
    assert trim_share(5.0, CREEPING_PACE) == trim_share(0.0, 10.0) == trim_share(-1.0, 10.0) == 0.0
    assert trim_share(5.0, WALKING_PACE) == trim_share(5.0, 30.0) == 5.0 / 6.0
    shares = [trim_share(5.0, 0.01 * n) for n in range(140)]
    assert shares == sorted(shares)
    assert max(b - a for a, b in pairwise(shares)) < 0.05


def drive(gain, angles, speed, duration, step, rates=NONE):
    return advance(initial_state(speed), angles, rates, (100.0,) * 4, ROAD, MODEL, duration, step, slip_gain=gain)


def test_scipy_integrates_to_the_same_state():
    gain, rates = (5.0, 3.0, 1.0, 0.5), (0.3, 0.25, -0.1, -0.1)

    def rate(time, state):
        angles = tuple(time * r for r in rates)
        return derivative(state, Inputs(angles, (100.0,) * 4, gain), ROAD, MODEL)

    reference = solve_ivp(rate, (0.0, 0.8), initial_state(8.0), method='DOP853', rtol=1e-11, atol=1e-13)
    assert drive(gain, NONE, 8.0, 0.8, 0.001, rates)[:6] == pytest.approx(reference.y[:6, -1], abs=1e-8)


def test_integration_converges_with_order_four():
    def end(step):
        return drive((5.0, 5.0, 1.0, 1.0), NONE, 8.0, 0.8, step, (0.06, 0.06, -0.03, -0.03))[:6]

    exact = end(0.001)
    errors = [np.abs(end(step) - exact).max() for step in (0.08, 0.04, 0.02)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert (orders > 3.7).all()
    assert (orders < 4.6).all()


def test_a_mirrored_turn_is_the_mirrored_turn():
    gain, mirror = (5.0, 1.0, 0.5, 0.0), [1.0, -1.0, -1.0, 1.0, -1.0, -1.0]
    left = drive(gain, road_steer_angles(Icr(0.0, 5.0), VEHICLE), 15.0 / 3.6, 3.0, 0.002)
    right = drive((1.0, 5.0, 0.0, 0.5), road_steer_angles(Icr(0.0, -5.0), VEHICLE), 15.0 / 3.6, 3.0, 0.002)
    assert right[:6] == pytest.approx(mirror * left[:6], abs=1e-9)


def test_steady_turn_balances_the_forces_of_the_linear_tyre():
    """A gentle turn of a bicycle: the front axle, whose stiffness counts 1 / (1 + K), has to carry its share."""
    vehicle = VehicleParameters(load_transfer=False, front_roll_steer=0.0, rear_roll_steer=0.0)
    model, angle, speed, gain = constants(vehicle), 1e-5, 5.0, 5.0
    end = advance(initial_state(speed), (angle, angle, 0.0, 0.0), NONE, NONE, ROAD, model, 6.0, 0.005, True,
                  (gain, gain, 0.0, 0.0))  # fmt: skip
    # Abe eq. 3.36 with the front stiffness over 1 + K.
    front, rear = 60000.0 / (1.0 + gain), 60000.0
    lf, lr, mass = 1.0, 1.454, vehicle.mass
    factor = -mass / (lf + lr) ** 2 * (lf * front - lr * rear) / (front * rear)
    assert end[2] == pytest.approx(angle * speed / (lf + lr) / (1.0 + factor * speed**2), rel=1e-5)


def test_standstill_start_and_stop_stay_finite_and_quiet():
    bank = Environment(bank=0.1)
    end = advance(initial_state(), NONE, NONE, NONE, bank, MODEL, 10.0, 0.01, slip_gain=(5.0, 5.0, 0.0, 0.0))
    plain = advance(initial_state(), NONE, NONE, NONE, bank, MODEL, 10.0, 0.01)
    assert np.abs(end[:3]).max() < 1e-9
    assert end == pytest.approx(plain, abs=1e-9)
    state, speeds = initial_state(), []
    for _ in range(300):
        state = advance(state, (0.3, 0.2, 0.0, 0.0), NONE, (300.0,) * 4, ROAD, MODEL, 0.005, 0.005,
                        slip_gain=(5.0, 5.0, 0.0, 0.0))  # fmt: skip
        speeds.append(state[:3])
    assert state_view(state).vx > 1.2
    assert np.abs(np.diff(speeds, axis=0)).max() < 0.02


@pytest.mark.parametrize('gain', [0.5, 5.0, 50.0])
def test_one_wheel_against_the_root_of_its_own_equation(gain):
    """Without the closed form: search the angle for which delta + K alpha(delta) = delta0."""
    state, angles = moving(7.0, 0.4, 0.6), (0.25, 0.1, 0.0, -0.1)

    def surplus(angle):
        slip = evaluate(state, Inputs((angle, *angles[1:])), ROAD, NO_ROLL_STEER).side_slip[0]
        return angle + gain * slip - angles[0]

    found = evaluate(state, Inputs(angles, slip_gain=(gain, 0.0, 0.0, 0.0)), ROAD, NO_ROLL_STEER)
    assert found.steer_angle[0] == pytest.approx(brentq(surplus, -1.0, 1.0, xtol=1e-14), abs=1e-11)
