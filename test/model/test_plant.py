import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from omni_vehicle_ros.errors import ParameterError
from omni_vehicle_ros.model.body import Environment, Inputs, derivative, evaluate
from omni_vehicle_ros.model.constants import constants
from omni_vehicle_ros.model.integrate import integrate
from omni_vehicle_ros.model.kinematics import Icr, road_steer_angles
from omni_vehicle_ros.model.linear import linear_bicycle
from omni_vehicle_ros.model.plant import advance
from omni_vehicle_ros.model.state import State, initial_state, state_vector, state_view
from omni_vehicle_ros.parameters import TYRE_MODELS, VehicleParameters

STILL = (0.0, 0.0, 0.0, 0.0)
ROAD = Environment()
quiet = settings(deadline=None, max_examples=40, derandomize=True)


def drive(model, speed, angles, duration, *, forces=STILL, road=ROAD, step=0.005, constant_speed=False, rates=STILL):
    return advance(initial_state(speed), angles, rates, forces, road, model, duration, step, constant_speed)


def test_thesis_traction_check(model):
    # Thesis sec. 4.3: 500 N on each wheel for 2 s makes 3.1 m/s from rest, 1000 N twice that.
    for force in (500.0, 1000.0):
        end = state_view(drive(model, 0.0, STILL, 2.0, forces=(force,) * 4))
        assert end.vx == pytest.approx(8.0 * force / 1298.9, abs=1e-3)
        assert end.x == pytest.approx(end.vx, abs=2e-3)
        assert end[1:3] == (0.0, 0.0)


def test_without_friction_momentum_is_conserved(model):
    ice = Environment(friction=STILL)
    start = state_vector(State(8.0, 1.0, 0.7, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0))
    end = state_view(advance(start, (0.3,) * 4, STILL, (500.0,) * 4, ice, model, 2.0, 0.005))
    assert end.r == 0.7
    assert (end.x, end.y, end.psi) == pytest.approx((16.0, 2.0, 1.4), abs=1e-6)
    assert math.hypot(end.vx, end.vy) == pytest.approx(math.hypot(8.0, 1.0))


def test_a_circle_closes(model):
    # A crawl about the ICR is kinematic: the pose comes back after one turn.
    angles = road_steer_angles(Icr(0.0, 3.0), VehicleParameters())
    start = state_vector(State(1.2, 0.0, 0.4, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0))
    end = state_view(advance(start, angles, STILL, STILL, ROAD, model, 5.0 * math.pi, 0.01, True))
    assert end.psi == pytest.approx(2.0 * math.pi, rel=0.01)
    assert math.hypot(end.x, end.y) < 0.2


@pytest.mark.parametrize('icr', [Icr(0.0, 3.0), Icr(0.0, -8.0), Icr(-1.454, 4.0)])
def test_slow_turn_follows_the_commanded_radius(model, vehicle, icr):
    angles = road_steer_angles(icr, vehicle)
    end = state_view(drive(model, 0.3, angles, 4.0, constant_speed=True))
    assert end.vx / end.r == pytest.approx(icr.y, rel=2e-3)
    assert -end.vy / end.r == pytest.approx(icr.x, abs=5e-3)


@pytest.mark.parametrize('speed', [3.0, 10.0, 25.0])
@pytest.mark.parametrize('tyre', TYRE_MODELS)
def test_linear_bicycle_is_the_limit_of_small_steering(stiff_vehicle, speed, tyre):
    linear, model = linear_bicycle(stiff_vehicle, speed), constants(replace(stiff_vehicle, tyre_model=tyre))
    angle = 1e-6  # brush and LuGre lose 1e-6 of their stiffness here, in proportion to the slip
    angles = (angle, angle, 0.0, 0.0)
    end = state_view(drive(model, speed, angles, 4.0, constant_speed=True))
    assert end.r == pytest.approx(angle * linear.yaw_gain, rel=1e-5)
    assert end.vy / speed == pytest.approx(angle * linear.side_slip_gain, rel=1e-4, abs=1e-11)
    lateral = evaluate(drive(model, speed, angles, 4.0, constant_speed=True), Inputs(angles), ROAD, model, True).ay
    beyond = angle - stiff_vehicle.wheelbase * end.r / speed
    assert beyond / lateral == pytest.approx(linear.understeer_gradient, rel=1e-3)


def test_linear_step_response_in_time(stiff_vehicle):
    speed, angle, time = 15.0, 1e-5, 0.15
    linear = linear_bicycle(stiff_vehicle, speed)
    steady = np.linalg.solve(linear.state_matrix, -linear.input_matrix @ [angle, -angle])
    exact = steady - expm(linear.state_matrix * time) @ steady
    end = drive(
        constants(stiff_vehicle), speed, (angle, angle, -angle, -angle), time, step=0.001, constant_speed=True
    )
    assert end[1:3] == pytest.approx(exact, rel=1e-5)


def test_linear_gains_match_their_closed_forms(vehicle):
    speed, axle = 12.0, 2.0 * vehicle.cornering_stiffness
    gradient = vehicle.mass / vehicle.wheelbase * (1.454 / axle - 1.0 / axle)
    linear = linear_bicycle(vehicle, speed)
    assert linear.understeer_gradient == pytest.approx(gradient)
    assert linear.yaw_gain == pytest.approx(speed / (vehicle.wheelbase + gradient * speed**2))
    with pytest.raises(ParameterError, match=r'0\.0 m/s must be above 0'):
        linear_bicycle(vehicle, 0.0)


@pytest.mark.parametrize('speed', [20.0 / 3.6, 80.0 / 3.6])
def test_on_a_bank_the_slips_balance_the_moment(model, speed):
    road = Environment(bank=0.02)
    end = drive(model, speed, STILL, 5.0, road=road, step=0.01, constant_speed=True)
    slip = evaluate(end, Inputs(STILL), road, model, True).side_slip
    assert (slip[0] + slip[1]) / (slip[2] + slip[3]) == pytest.approx(1.454 / 1.0, rel=1e-3)
    assert max(slip) < 0.0


def test_an_unequal_drive_turns_the_vehicle(model):
    end = state_view(drive(model, 5.0, STILL, 0.5, forces=(-200.0, 200.0, -200.0, 200.0)))
    assert end.r > 0.0
    assert end.vx == pytest.approx(5.0, abs=0.01)


def test_wind_ahead_of_the_centre_of_gravity_turns_more_than_behind():
    ends = [
        drive(constants(VehicleParameters(aerodynamic_centre=arm)), 20.0, STILL, 2.0, road=Environment(wind=5.0))
        for arm in (-0.5, 0.0, 0.5)
    ]
    yaw_rates = [state_view(end).r for end in ends]
    assert yaw_rates == sorted(yaw_rates)


def manoeuvre(model, step, duration=0.8):
    """Steer into a gentle turn, above walking pace, on the smooth part of the tyre's curve."""
    return drive(
        model,
        8.0,
        STILL,
        duration,
        forces=(100.0,) * 4,
        road=Environment(bank=0.01),
        step=step,
        rates=(0.02, 0.02, -0.01, -0.01),
    )[:6]


def test_integration_converges_with_order_four(model):
    exact = manoeuvre(model, 0.001)
    errors = [np.abs(manoeuvre(model, step) - exact).max() for step in (0.08, 0.04, 0.02)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert (orders > 3.7).all()
    assert (orders < 4.6).all()


def test_scipy_integrates_to_the_same_state(model):
    rates, road = (0.3, 0.25, -0.1, -0.1), Environment(bank=0.02, wind=3.0, friction=(0.9, 0.6, 0.9, 0.6))

    def rate(time, state):
        return derivative(state, Inputs(tuple(time * r for r in rates), (150.0,) * 4), road, model)

    reference = solve_ivp(rate, (0.0, 0.8), initial_state(12.0), method='DOP853', rtol=1e-10, atol=1e-12)
    ours = drive(model, 12.0, STILL, 0.8, forces=(150.0,) * 4, road=road, step=0.001, rates=rates)
    # The tyre's curve has a kink in its second derivative, which both cross.
    assert ours[:6] == pytest.approx(reference.y[:6, -1], abs=1e-6)
    assert max(evaluate(ours, Inputs(tuple(0.8 * r for r in rates)), road, model).friction_use) > 0.7


def test_the_control_period_does_not_matter(model):
    angles, rates, forces = STILL, (0.2, 0.2, 0.0, 0.0), (300.0,) * 4
    whole = drive(model, 6.0, angles, 0.1, forces=forces, step=0.001, rates=rates)
    state = initial_state(6.0)
    for n in range(20):
        angles = tuple(0.005 * n * rate for rate in rates)
        state = advance(state, angles, rates, forces, ROAD, model, 0.005, 0.001)
    assert state == pytest.approx(whole, abs=1e-12)


def test_same_input_same_bits_and_input_untouched(model):
    start = initial_state(5.0)
    runs = [advance(start, (0.2,) * 4, STILL, STILL, ROAD, model, 0.1, 0.001) for _ in range(2)]
    assert runs[0].tobytes() == runs[1].tobytes()
    assert start.tobytes() == initial_state(5.0).tobytes()


def test_a_held_speed_is_held_exactly(model, vehicle):
    angles = road_steer_angles(Icr(0.0, 5.0), vehicle)
    assert drive(model, 15.0 / 3.6, angles, 1.0, constant_speed=True)[0] == 15.0 / 3.6


def test_a_held_speed_past_the_grip_limit_spins_and_stays_finite(model, vehicle):
    # R = 2 m at 14 km/h asks for 7.6 m/s2 with the rear outer tyre past its peak: there is no steady state.
    angles = road_steer_angles(Icr(0.0, 2.0), vehicle)
    end = drive(model, 14.0 / 3.6, angles, 10.0, constant_speed=True)
    assert np.isfinite(end).all()
    assert abs(end[1]) > abs(end[0])


finite = st.floats(-1e6, 1e6)
four = st.tuples(finite, finite, finite, finite)


@quiet
@given(
    st.lists(finite, min_size=10, max_size=10), four, st.builds(Inputs, four, four, four),
    st.builds(Environment, finite, finite, four), st.booleans(), st.sampled_from([0.001, 0.01]),
    st.sampled_from(TYRE_MODELS),
)  # fmt: skip
def test_finite_input_gives_finite_output(state, rates, inputs, road, constant_speed, step, tyre):
    model = constants(VehicleParameters(tyre_model=tyre))
    vector = np.array(state)
    for _ in range(3):
        found = evaluate(vector, inputs, road, model, constant_speed)
        assert all(math.isfinite(number) for field in found for number in np.atleast_1d(field))
        plain = integrate(state_view(vector), inputs, rates, road, model, 3, step, constant_speed)
        assert np.isfinite(plain).all()
        vector = advance(
            vector, inputs.steer_angle, rates, inputs.drive_force, road, model, 3.0 * step, step, constant_speed,
            inputs.slip_gain,
        )  # fmt: skip
        assert np.isfinite(vector).all()
