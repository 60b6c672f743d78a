import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omni_vehicle_ros.model.body import Environment, Inputs, derivative, evaluate
from omni_vehicle_ros.model.constants import LUGRE, constants
from omni_vehicle_ros.model.contact import WALKING_PACE, low_speed_weight
from omni_vehicle_ros.model.kinematics import Icr, Twist, road_steer_angles, steer_angles
from omni_vehicle_ros.model.plant import advance
from omni_vehicle_ros.model.state import State, initial_state, state_vector, state_view
from omni_vehicle_ros.model.tyres.lugre import stribeck
from omni_vehicle_ros.parameters import TYRE_MODELS, VehicleParameters

VEHICLE = VehicleParameters()
STILL = (0.0, 0.0, 0.0, 0.0)
LEVEL = Environment()
PERIOD = 0.005


@pytest.fixture(params=TYRE_MODELS)
def model(request):
    return constants(VehicleParameters(tyre_model=request.param))


def wheel_speeds(state, angles):
    now = state_view(state)
    return tuple(
        (now.vx - y * now.r) * math.cos(angle) + (now.vy + x * now.r) * math.sin(angle)
        for x, y, angle in zip(VEHICLE.wheel_x, VEHICLE.wheel_y, angles, strict=True)
    )


def brake(state, angles, model, duration, force, road=LEVEL):
    """Brake in closed loop and return the twists of every cycle."""
    twists = []
    for _ in range(round(duration / PERIOD)):
        # Near standstill no more than half of a wheel's momentum in a cycle, so that it never turns round.
        firmness = 0.125 * VEHICLE.mass / PERIOD
        speeds = wheel_speeds(state, angles)
        forces = tuple(-math.copysign(min(force, firmness * abs(speed)), speed) for speed in speeds)
        state = advance(state, angles, STILL, forces, road, model, PERIOD, PERIOD)
        twists.append(state[:3])
    return state, np.array(twists)


def test_rest_on_a_bank_stays_rest_for_a_minute(model):
    road = Environment(bank=0.1)
    early = advance(initial_state(), STILL, STILL, STILL, road, model, 4.0, 0.01)
    late = advance(early, STILL, STILL, STILL, road, model, 56.0, 0.01)
    assert np.abs(late[:3]).max() < 1e-12
    assert late[3:] == pytest.approx(early[3:], abs=1e-7)
    assert abs(late[4]) < 0.01


@pytest.mark.parametrize('bank', [0.01, -0.5])
def test_rest_is_soon_reached_on_any_bank_that_the_grip_holds(model, bank):
    road = Environment(bank=bank)
    # The more of its grip a tyre uses the softer it is: LuGre's, at 0.78, has a tenth of its stiffness left.
    end = advance(initial_state(), STILL, STILL, STILL, road, model, 6.0, 0.005)
    assert np.abs(end[:3]).max() < 1e-6
    assert np.abs(derivative(end, Inputs(STILL), road, model)).max() < 1e-5


def test_flat_rest_is_exact(model):
    state = advance(initial_state(), (0.5, 0.2, -0.3, 1.2), STILL, STILL, LEVEL, model, 1.0, 0.001)
    assert not state.any()


def test_at_rest_on_a_bank_the_tyres_carry_the_weight(model):
    road = Environment(bank=0.2)
    end = advance(initial_state(), STILL, STILL, STILL, road, model, 5.0, 0.005)
    found = evaluate(end, Inputs(STILL), road, model)
    assert sum(found.lateral_force) == pytest.approx(-VEHICLE.mass * VEHICLE.gravity * math.sin(0.2), rel=1e-6)
    assert found.ay == pytest.approx(-VEHICLE.gravity * math.sin(0.2), rel=1e-6)
    assert max(found.side_slip) < 0.0


def test_a_bank_steeper_than_the_grip_slides(model):
    road = Environment(bank=0.3, friction=(0.1,) * 4)
    end = state_view(advance(initial_state(), STILL, STILL, STILL, road, model, 2.0, 0.005))
    share = stribeck(end.vy, model.sliding_share, model.stribeck_speed) if model.tyre_model == LUGRE else 1.0
    slowest, fastest = (
        2.0 * VEHICLE.gravity * (math.sin(0.3) - 0.1 * least * math.cos(0.3)) for least in (1.0, share)
    )
    assert 0.95 * slowest < end.vy < 1.05 * fastest


@pytest.mark.parametrize('radius', [2.0, -4.0, 1e6])
@pytest.mark.parametrize('road', [LEVEL, Environment(bank=0.1)])
def test_stops_from_a_turn_without_chatter(model, radius, road):
    angles = road_steer_angles(Icr(0.0, radius), VEHICLE)
    start = initial_state(1.5)
    start[2] = 1.5 / radius
    end, twists = brake(start, angles, model, 6.0, 1000.0, road)
    assert np.abs(end[:3]).max() < 1e-3
    reversals = np.abs(np.diff(np.sign(np.where(np.abs(twists) < 1e-4, 0.0, twists)), axis=0)) == 2
    assert reversals.sum() <= 6
    assert np.abs(twists[-200:]).max() < 2e-3


def test_starts_and_reverses_about_the_commanded_centre(model):
    angles = road_steer_angles(Icr(0.0, 4.0), VEHICLE)
    for force in (150.0, -150.0):
        end = state_view(advance(initial_state(), angles, STILL, (force,) * 4, LEVEL, model, 2.0, 0.005))
        assert math.copysign(1.0, end.vx) == math.copysign(1.0, force)
        assert end.vx / end.r == pytest.approx(4.0, rel=0.02)


def test_spins_in_place(model):
    steering = steer_angles(Twist(0.0, 0.0, 1.0), STILL, 1.75, VEHICLE)
    forces = tuple(math.copysign(200.0, speed) for speed in steering.speeds)
    end = advance(initial_state(), steering.angles, STILL, forces, LEVEL, model, 3.0, 0.005)
    now = state_view(end)
    lever = sum(math.hypot(x, y) for x, y in zip(VEHICLE.wheel_x, VEHICLE.wheel_y, strict=True))
    assert now.r == pytest.approx(200.0 * lever / VEHICLE.yaw_inertia * 3.0, rel=0.01)
    assert math.hypot(now.x, now.y) < 0.01
    end, _ = brake(end, steering.angles, model, 4.0, 1000.0)
    assert np.abs(end[:3]).max() < 1e-3


def test_crabs_from_rest_at_a_right_angle(model):
    end = state_view(
        advance(initial_state(), (0.5 * math.pi,) * 4, STILL, (100.0,) * 4, LEVEL, model, 2.0, 0.005)
    )
    assert end.vy == pytest.approx(800.0 / VEHICLE.mass, rel=0.01)
    assert (end.vx, end.r) == pytest.approx((0.0, 0.0), abs=0.02)


def test_the_weight_is_exactly_nothing_from_walking_pace_on():
    assert low_speed_weight(WALKING_PACE) == 0.0
    assert low_speed_weight(0.0) == 1.0
    weights = [low_speed_weight(0.01 * n) for n in range(140)]
    assert weights == sorted(weights, reverse=True)


@settings(deadline=None, max_examples=60, derandomize=True)
@given(
    st.floats(2.5, 30.0), st.floats(-3.0, 3.0), st.floats(-1.0, 1.0), st.floats(-1.0, 1.0), st.floats(0.05, 2.0)
)  # fmt: skip
def test_above_walking_pace_the_deflection_changes_nothing(vx, vy, r, deflection, length):
    inputs = Inputs((0.1, 0.2, -0.1, 0.0), (100.0,) * 4)
    rates = [
        derivative(
            state_vector(State(vx, vy, r, 0.0, 0.0, 0.0, z, z, z, z)),
            inputs,
            LEVEL,
            constants(VehicleParameters(relaxation_length=sigma)),
        )[:6]
        for z, sigma in ((0.0, 0.35), (deflection, length))
    ]
    assert rates[0].tobytes() == rates[1].tobytes()


@pytest.mark.parametrize('speed', [0.2, 0.6, 1.0, -0.5])
def test_a_slow_rolling_tyre_settles_at_the_slip_of_its_velocity(model, speed):
    road = Environment(bank=0.05)
    end = state_view(advance(initial_state(speed), STILL, STILL, STILL, road, model, 15.0, 0.01, True))
    found = evaluate(state_vector(end), Inputs(STILL), road, model, True)
    for i in range(4):
        u, w = end.vx - VEHICLE.wheel_y[i] * end.r, end.vy + VEHICLE.wheel_x[i] * end.r
        turned = math.atan2(w, u) - (-0.2 if i < 2 else 0.2) * found.roll_angle
        assert found.side_slip[i] == pytest.approx(math.atan2(-math.sin(turned), abs(math.cos(turned))), abs=1e-6)


def test_no_jump_when_passing_walking_pace(model):
    angles = (0.15, 0.15, 0.0, 0.0)
    state, laterals = initial_state(0.0), []
    for _ in range(400):
        state = advance(state, angles, STILL, (300.0,) * 4, LEVEL, model, PERIOD, PERIOD)
        laterals.append(evaluate(state, Inputs(angles), LEVEL, model).ay)
    assert state[0] > 1.5
    assert np.abs(np.diff(laterals)).max() < 0.05


def test_a_long_standing_tyre_does_not_spring_back_from_afar(model):
    # Dragged sideways for long, the tyre keeps no more deflection than its grip can hold.
    dragged = advance(
        state_vector(State(0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)),
        STILL, STILL, STILL, LEVEL, model, 4.0, 0.005,
    )  # fmt: skip
    assert np.abs(dragged[6:]).max() < 0.1
    assert np.abs(dragged[:3]).max() < 1e-6
