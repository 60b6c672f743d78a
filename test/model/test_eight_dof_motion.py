"""The vehicle with 8 degrees of freedom in time: roll, wheels, energy, rest, and how well it is integrated."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from omni_vehicle_ros.model.constants import constants
from omni_vehicle_ros.model.dynamics import Environment, Inputs
from omni_vehicle_ros.model.eight_dof.constants import eight_dof_constants
from omni_vehicle_ros.model.eight_dof.dynamics import state_rate
from omni_vehicle_ros.model.eight_dof.integrate import integrate
from omni_vehicle_ros.model.eight_dof.state import EightDofState, initial_state, state_vector, state_view
from omni_vehicle_ros.model.eight_dof.vehicle import advance, evaluate
from omni_vehicle_ros.model.kinematics import Icr, Twist, road_steer_angles, steer_angles
from omni_vehicle_ros.model.plant import advance as advance_plane
from omni_vehicle_ros.model.state import initial_state as plane_initial_state
from omni_vehicle_ros.parameters import TYRE_MODELS, VehicleParameters

VEHICLE = VehicleParameters()
MODEL = eight_dof_constants(VEHICLE)
TYRES = [eight_dof_constants(VehicleParameters(tyre_model=name)) for name in TYRE_MODELS]
RADIUS, INERTIA = VEHICLE.wheel_radius, VEHICLE.wheel_inertia
STILL = (0.0, 0.0, 0.0, 0.0)
COAST, LEVEL, ICE = Inputs(STILL), Environment(), Environment(friction=STILL)
PERIOD = 0.005


def derivative(vector, inputs, road, model, constant_speed=False):
    return state_vector(state_rate(state_view(vector), inputs, road, model, constant_speed))


def rolling(speed):
    return initial_state(speed, RADIUS)


def drive(state, inputs, duration, *, road=LEVEL, model=MODEL, step=0.001, rates=STILL, constant_speed=False):
    return advance(state, inputs, rates, road, model, duration, step, constant_speed)


def all_wheels(force):
    return Inputs(STILL, (force,) * 4)


@pytest.mark.parametrize('product', [0.0, -150.0])
def test_free_roll_has_the_closed_form_of_a_damped_oscillator(product):
    v = VehicleParameters(roll_yaw_inertia=product)
    # On ice the body rolls about the centre of gravity of the vehicle, and may yaw.
    inertia = v.roll_inertia - (v.sprung_mass * v.roll_arm) ** 2 / v.mass - product**2 / v.yaw_inertia
    decay = v.roll_damping / (2.0 * inertia)
    stiffness = v.roll_stiffness - v.sprung_mass * v.gravity * v.roll_arm
    frequency = math.sqrt(stiffness / inertia - decay**2)
    start = rolling(10.0)
    start[6] = 0.05
    for time in (0.05, 0.2, 0.45):
        end = state_view(drive(start, COAST, time, road=ICE, model=eight_dof_constants(v)))
        swing = math.cos(frequency * time) + decay / frequency * math.sin(frequency * time)
        assert end.roll == pytest.approx(0.05 * math.exp(-decay * time) * swing, abs=1e-9)
        assert end.r == pytest.approx(product / v.yaw_inertia * end.roll_rate, abs=1e-9)
        assert (end.vx, end.vy) == pytest.approx((10.0 * math.cos(end.psi), -10.0 * math.sin(end.psi)))


def test_on_tyres_that_do_not_give_the_body_rolls_about_the_roll_axis():
    v = VehicleParameters(cornering_stiffness=1e7, roll_damping=0.0, front_roll_steer=0.0, rear_roll_steer=0.0)
    model = eight_dof_constants(v)
    rest, size = rolling(0.0), 1e-7
    columns = [derivative(rest + size * unit, COAST, LEVEL, model) for unit in np.eye(20)]
    found = np.linalg.eigvals(np.array(columns).T / size)
    expected = math.sqrt((v.roll_stiffness - v.sprung_mass * v.gravity * v.roll_arm) / v.roll_inertia)
    swinging = found[found.imag > 1.0]
    assert np.abs(swinging - 1j * expected).min() < 1e-3 * expected


def test_a_wheel_in_the_air_is_a_flywheel():
    end = state_view(drive(rolling(5.0), all_wheels(60.0), 0.7, road=ICE))
    assert end.spin == pytest.approx((5.0 / RADIUS + 60.0 * RADIUS / INERTIA * 0.7,) * 4)
    assert end[:3] == (5.0, 0.0, 0.0)


def test_wheels_carry_inertia_of_their_own():
    # 500 N on each of four wheels for 2 s (thesis sec. 4.3), less what spins the wheels up and slips.
    end = state_view(drive(rolling(2.0), all_wheels(500.0), 2.0))
    mass = VEHICLE.mass + 4.0 * INERTIA / RADIUS**2
    momentum = VEHICLE.mass * (end.vx - 2.0) + INERTIA / RADIUS * (sum(end.spin) - 4.0 * 2.0 / RADIUS)
    assert momentum == pytest.approx(4.0 * 500.0 * 2.0, rel=1e-9)
    assert end.vx - 2.0 == pytest.approx(4.0 * 500.0 * 2.0 / mass, rel=2e-3)
    slips = [(RADIUS * spin - end.vx) / end.vx for spin in end.spin]
    carried = 500.0 * VEHICLE.mass / mass
    assert slips == pytest.approx((carried / VEHICLE.longitudinal_stiffness,) * 4, rel=0.02)


def test_hard_braking_locks_the_wheels_and_they_slide():
    inputs = all_wheels(-6000.0)
    state = drive(rolling(20.0), inputs, 0.5)
    for _ in range(5):
        state = drive(state, inputs, 0.2)
        found, now = evaluate(state, inputs, LEVEL, MODEL), state_view(state)
        assert now.spin == STILL
        sliding = 1.0 - VEHICLE.adhesion_reduction * now.vx
        for along, load in zip(found.longitudinal_force, found.vertical_load, strict=True):
            assert along == pytest.approx(-0.9 * load * sliding, rel=1e-12)
    # Released, the road spins them up again.
    free = drive(state, COAST, 0.3)
    assert state_view(free).spin == pytest.approx((free[0] / RADIUS,) * 4, rel=1e-3)


def test_a_locked_wheel_steers_no_more():
    inputs = Inputs((0.1, 0.1, 0.0, 0.0), (-6000.0, -6000.0, 0.0, 0.0))
    braked, free = drive(rolling(15.0), inputs, 0.6), drive(rolling(15.0), inputs._replace(drive_force=STILL), 0.6)
    assert state_view(braked).spin[:2] == (0.0, 0.0)
    assert abs(braked[2]) < 0.1 * abs(free[2])


@pytest.mark.parametrize('step', [0.001, 0.01])
@pytest.mark.parametrize('force', [-300.0, -6000.0])
def test_a_brake_stops_a_wheel_and_never_turns_it_round(force, step):
    state, road = rolling(3.0), Environment(friction=(0.9, 0.2, 0.0, 0.9))
    lowest = 0.0
    for _ in range(100):
        state = drive(state, all_wheels(force), 0.01, road=road, step=step)
        if state[0] < 0.1:
            break
        lowest = min(lowest, *state[8:12])
    assert lowest == 0.0


def test_a_torque_that_lasts_reverses_the_vehicle():
    end = rolling(1.0)
    for _ in range(800):
        end = drive(end, all_wheels(-300.0), PERIOD)
    mass = VEHICLE.mass + 4.0 * INERTIA / RADIUS**2
    assert end[0] == pytest.approx(1.0 - 4.0 * 300.0 / mass * 4.0, rel=0.02)
    assert end[8:12] * RADIUS == pytest.approx(np.full(4, end[0]), rel=0.01)


def test_wheels_spin_up_on_ice():
    slippery, torque = Environment(friction=(0.1,) * 4), 400.0
    state = drive(rolling(5.0), all_wheels(torque / RADIUS), 1.0, road=slippery)
    found = evaluate(state, COAST, slippery, MODEL)
    assert min(found.friction_use) > 0.95 * (1.0 - VEHICLE.adhesion_reduction * state[0])
    before = state
    state = drive(state, all_wheels(torque / RADIUS), 0.1, road=slippery)
    spinning = (state - before)[8:12] / 0.1
    assert spinning == pytest.approx((torque - RADIUS * np.array(found.longitudinal_force)) / INERTIA, rel=1e-3)
    assert (state[8:12] * RADIUS > 5.0 * state[0]).all()


def energy(state, model):
    now, plane = state_view(state), model.plane
    moving = 0.5 * plane.mass * (now.vx**2 + now.vy**2) + 0.5 * plane.yaw_inertia * now.r**2
    rolled = 0.5 * model.roll_inertia * now.roll_rate**2 + 0.5 * model.net_roll_stiffness * now.roll**2
    spinning = 0.5 * INERTIA * sum(spin**2 for spin in now.spin)
    return moving + rolled - model.roll_yaw_inertia * now.r * now.roll_rate + spinning


@pytest.mark.parametrize('angles', [(0.3, 0.25, -0.1, -0.1), (-0.6, -0.4, 0.3, 0.2)])
@pytest.mark.parametrize('tyre', TYRE_MODELS)
def test_a_vehicle_that_coasts_loses_energy_all_the_time(tyre, angles):
    vehicle = VehicleParameters(tyre_model=tyre, front_roll_steer=0.0, rear_roll_steer=0.0, roll_yaw_inertia=80.0)
    model = eight_dof_constants(vehicle)
    spin = (20.0, 50.0, 0.0, 40.0)
    state = state_vector(EightDofState(14.0, 2.0, -0.5, 0.0, 0.0, 0.0, 0.06, -0.4, spin, STILL, STILL))
    energies = []
    while state[0] > 3.0 and len(energies) < 800:
        state = drive(state, Inputs(angles), PERIOD, model=model)
        energies.append(energy(state, model))
    assert np.diff(energies).max() < 0.0


def test_energy_on_a_bank_is_what_gravity_gives():
    model = eight_dof_constants(VehicleParameters(roll_damping=0.0))
    start = rolling(8.0)
    start[[1, 2, 6]] = 0.5, 0.3, 0.05
    end = drive(start, COAST, 2.0, road=Environment(bank=0.1, friction=STILL), model=model)
    # The centre of gravity in the direction downhill of the yawing vehicle: the integral of vy, by its own equation.
    gravity = VEHICLE.mass * VEHICLE.gravity * math.sin(0.1)

    def rate(time, state):
        return [*derivative(state[:20], COAST, Environment(bank=0.1, friction=STILL), model), gravity * state[1]]

    work = solve_ivp(rate, (0.0, 2.0), [*start, 0.0], rtol=1e-11, atol=1e-11).y[20, -1]
    assert energy(end, model) - energy(start, model) == pytest.approx(work, rel=1e-7)


@pytest.mark.parametrize(('bank', 'model'), [(0.01, MODEL), (-0.5, MODEL), *((0.1, model) for model in TYRES)])
def test_rest_on_a_bank(bank, model):
    road = Environment(bank=bank)
    early = drive(rolling(0.0), COAST, 6.0, road=road, model=model)
    late = drive(early, COAST, 24.0, road=road, model=model)
    assert np.abs(late[[0, 1, 2, 7, 8, 9, 10, 11]]).max() < 1e-10
    assert late[3:7] == pytest.approx(early[3:7], abs=1e-6)
    found = evaluate(late, COAST, road, model)
    assert found.ay == pytest.approx(-VEHICLE.gravity * math.sin(bank), rel=1e-9)
    assert late[6] == pytest.approx(MODEL.plane.roll_per_acceleration * found.ay, rel=1e-9)


@settings(deadline=None, max_examples=40, derandomize=True)
@given(st.floats(2.5, 30.0), st.floats(-3.0, 3.0), st.floats(-1.0, 1.0), st.floats(-0.3, 0.3), st.floats(0.05, 2.0))
def test_above_walking_pace_the_deflections_change_nothing(vx, vy, r, deflection, length):
    inputs, spin, rates = Inputs((0.1, 0.2, -0.1, 0.0), (100.0,) * 4), (vx / RADIUS, 50.0, 0.0, 1.0), []
    for z, sigma in ((0.0, 0.35), (deflection, length)):
        state = EightDofState(vx, vy, r, 0.0, 0.0, 0.0, 0.02, 0.1, spin, (z,) * 4, (-z,) * 4)
        model = eight_dof_constants(VehicleParameters(relaxation_length=sigma))
        rates.append(derivative(state_vector(state), inputs, LEVEL, model)[:12])
    assert rates[0].tobytes() == rates[1].tobytes()


@pytest.mark.parametrize('speed', [0.2, 0.6, 1.0, -0.5])
def test_a_slow_rolling_tyre_settles_at_the_slip_of_its_velocity(speed):
    road = Environment(bank=0.05)
    end = drive(rolling(speed), COAST, 15.0, road=road, constant_speed=True)
    found, now = evaluate(end, COAST, road, MODEL, True), state_view(end)
    for i, (x, y) in enumerate(zip(VEHICLE.wheel_x, VEHICLE.wheel_y, strict=True)):
        u, w = now.vx - y * now.r, now.vy + x * now.r
        turned = math.atan2(w, u) - (-0.2 if i < 2 else 0.2) * found.roll_angle
        assert found.side_slip[i] == pytest.approx(math.atan2(-math.sin(turned), abs(math.cos(turned))), abs=1e-6)
        assert now.spin[i] * RADIUS == pytest.approx(math.hypot(u, w) * math.cos(turned), rel=1e-6)


def test_no_jump_when_passing_walking_pace():
    state, inputs, found = rolling(0.0), Inputs((0.15, 0.15, 0.0, 0.0), (300.0,) * 4), []
    for _ in range(400):
        state = drive(state, inputs, PERIOD)
        now = evaluate(state, inputs, LEVEL, MODEL)
        found.append((now.ax, now.ay))
    assert state[0] > 1.5
    assert np.abs(np.diff(found, axis=0))[20:].max() < 0.05


@pytest.mark.parametrize('radius', [2.0, -4.0, 1e6])
@pytest.mark.parametrize('road', [LEVEL, Environment(bank=0.1)])
def test_brakes_in_proportion_to_the_spin_stop_the_vehicle(radius, road):
    angles, gain = road_steer_angles(Icr(0.0, radius), VEHICLE), 150.0 / RADIUS
    state, twists = rolling(1.5), []
    state[2] = 1.5 / radius
    for _ in range(1200):
        forces = tuple(-gain * spin for spin in state[8:12].tolist())
        state = drive(state, Inputs(angles, forces), PERIOD, road=road)
        twists.append(state[:3])
    assert np.abs(state[:3]).max() < 1e-3
    assert np.abs(np.array(twists)[-200:]).max() < 2e-3
    assert np.abs(np.diff(twists, axis=0)[-200:]).max() < 1e-4


def test_locked_across_a_slope_it_stays_for_ever():
    # Wheels across: gravity pulls along them, and only the tyres' memory can hold against it.
    angles, road = (0.5 * math.pi,) * 4, Environment(bank=0.1)
    pull = VEHICLE.mass * VEHICLE.gravity * math.sin(0.1) / 4.0
    early = drive(rolling(0.0), Inputs(angles, (-pull,) * 4), 6.0, road=road)
    late = drive(early, Inputs(angles, (-pull,) * 4), 10.0, road=road)
    assert np.abs(late[:3]).max() < 1e-4
    assert math.hypot(*(late - early)[3:5]) < 1e-4


def test_starts_reverses_and_spins_in_place():
    angles = road_steer_angles(Icr(0.0, 4.0), VEHICLE)
    for force in (150.0, -150.0):
        end = state_view(drive(rolling(0.0), Inputs(angles, (force,) * 4), 2.0))
        assert math.copysign(1.0, end.vx) == math.copysign(1.0, force)
        assert end.vx / end.r == pytest.approx(4.0, rel=0.02)
    steering = steer_angles(Twist(0.0, 0.0, 1.0), STILL, 1.75, VEHICLE)
    forces = tuple(math.copysign(200.0, speed) for speed in steering.speeds)
    end = state_view(drive(rolling(0.0), Inputs(steering.angles, forces), 3.0))
    levers = [math.hypot(x, y) for x, y in zip(VEHICLE.wheel_x, VEHICLE.wheel_y, strict=True)]
    inertia = VEHICLE.yaw_inertia + INERTIA / RADIUS**2 * sum(lever**2 for lever in levers)
    assert end.r == pytest.approx(200.0 * sum(levers) / inertia * 3.0, rel=0.01)
    assert math.hypot(end.x, end.y) < 0.01


def test_stiff_roll_and_light_wheels_make_the_model_in_the_plane():
    rates, errors = (0.2, 0.2, -0.1, -0.1), []
    for stiffness in (1e5, 1e6, 1e7):
        # The sprung mass close to a point on its arm, and wheels of next to nothing.
        inertia = 1.05 * VEHICLE.sprung_mass * VEHICLE.roll_arm**2
        v = VehicleParameters(
            roll_stiffness=stiffness,
            roll_inertia=inertia,
            roll_damping=math.sqrt(2.0 * stiffness * inertia),
            wheel_inertia=2e5 / stiffness,
        )
        ours = advance(rolling(10.0), COAST, rates, LEVEL, eight_dof_constants(v), 0.8, 0.001)
        theirs = advance_plane(plane_initial_state(10.0), STILL, rates, STILL, LEVEL, constants(v), 0.8, 0.001)
        errors.append(np.abs(ours[:6] - theirs[:6]).max())
    assert errors[2] < 2e-4
    # Of the first order in both: compliance of the springs and inertia of the wheels.
    assert np.divide(errors[:2], errors[1:]) == pytest.approx([10.0, 10.0], rel=0.5)


def manoeuvre(size):
    """Steer into a gentle turn, above walking pace, on the smooth part of the tyre's curve."""
    rates, road = (0.02, 0.02, -0.01, -0.01), Environment(bank=0.01)
    end = integrate(
        state_view(rolling(8.0)), all_wheels(100.0), rates, road, MODEL, round(0.24 / size), size, False
    )
    return state_vector(end)[:12]


def test_integration_converges_with_order_four():
    exact = manoeuvre(0.00025)
    errors = [np.abs(manoeuvre(size) - exact).max() for size in (0.004, 0.002, 0.001)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert (orders > 3.7).all()
    assert (orders < 4.6).all()


def test_scipy_integrates_to_the_same_state():
    rates, road = (0.3, 0.25, -0.1, -0.1), Environment(bank=0.02, wind=3.0, friction=(0.9, 0.6, 0.9, 0.6))

    def rate(time, state):
        return derivative(state, Inputs(tuple(time * r for r in rates), (150.0,) * 4), road, MODEL)

    reference = solve_ivp(rate, (0.0, 0.8), rolling(12.0), method='DOP853', rtol=1e-10, atol=1e-12)
    ours = drive(rolling(12.0), all_wheels(150.0), 0.8, road=road, rates=rates)
    # The tyre's curve has a kink in its second derivative, which the wheels cross.
    assert ours[:12] == pytest.approx(reference.y[:12, -1], rel=1e-7, abs=1e-6)
    assert max(evaluate(ours, Inputs(tuple(0.8 * r for r in rates)), road, MODEL).friction_use) > 0.7


@pytest.mark.parametrize('model', TYRES)
def test_the_spin_is_stable_at_any_step_and_speed(model):
    # Just above walking pace and at the longest step that may be asked for, slip must not ring.
    for speed in (0.4, 1.0, 1.21, 3.0, 20.0):
        state = rolling(speed)
        state[8] *= 1.02
        end = drive(state, COAST, 0.2, step=0.01, model=model)
        assert end[8:12] * RADIUS == pytest.approx(np.full(4, end[0]), rel=2e-3)


def test_the_control_period_does_not_matter():
    rates, inputs = (0.2, 0.2, 0.0, 0.0), all_wheels(300.0)
    whole, state = drive(rolling(6.0), inputs, 0.1, rates=rates), rolling(6.0)
    for n in range(20):
        now = inputs._replace(steer_angle=tuple(0.005 * n * rate for rate in rates))
        state = drive(state, now, 0.005, rates=rates)
    assert state == pytest.approx(whole, abs=1e-8)


def test_input_untouched_and_a_held_speed_is_held_exactly():
    start = rolling(15.0 / 3.6)
    runs = [drive(start, Inputs((0.2,) * 4), 0.5, constant_speed=True) for _ in range(2)]
    assert runs[0].tobytes() == runs[1].tobytes()
    assert start.tobytes() == rolling(15.0 / 3.6).tobytes()
    assert runs[0][0] == 15.0 / 3.6


finite = st.floats(-1e6, 1e6)
four = st.tuples(finite, finite, finite, finite)


@settings(deadline=None, max_examples=40, derandomize=True)
@given(
    st.lists(finite, min_size=20, max_size=20), st.builds(Inputs, four, four, four), four,
    st.builds(Environment, finite, finite, four), st.booleans(), st.sampled_from([0.001, 0.01]),
)  # fmt: skip
def test_finite_input_gives_finite_output(state, inputs, rates, road, constant_speed, step):
    vector = np.array(state)
    for _ in range(3):
        found = evaluate(vector, inputs, road, MODEL, constant_speed)
        assert all(math.isfinite(number) for field in found for number in np.atleast_1d(field))
        vector = drive(vector, inputs, 3.0 * step, road=road, step=step, rates=rates, constant_speed=constant_speed)
        assert np.isfinite(vector).all()
