import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omni_vehicle_ros.model import dynamics, loop
from omni_vehicle_ros.model.body import Environment, Inputs, derivative, evaluate
from omni_vehicle_ros.model.constants import constants
from omni_vehicle_ros.model.loads import static_loads, vertical_loads
from omni_vehicle_ros.model.state import State, initial_state, state_vector, state_view
from omni_vehicle_ros.model.tyres.force import side_force
from omni_vehicle_ros.model.tyres.friction_circle import lateral_capacity
from omni_vehicle_ros.parameters import TYRE_MODELS, VehicleParameters

VEHICLE = VehicleParameters()
MODEL = constants(VEHICLE)
STIFF = constants(VehicleParameters(front_roll_steer=0.0, rear_roll_steer=0.0))
models = st.sampled_from([constants(VehicleParameters(tyre_model=tyre)) for tyre in TYRE_MODELS])
quiet = settings(deadline=None, max_examples=60, derandomize=True)


def per_wheel(entries):
    return st.tuples(entries, entries, entries, entries)


def state(vx, vy, r):
    return state_vector(State(vx, vy, r, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0))


# Every wheel faster than walking pace, whatever the yaw rate.
driving = st.builds(state, st.floats(3.0, 30.0), st.floats(-5.0, 5.0), st.floats(-1.0, 1.0))
steering = per_wheel(st.floats(-0.5, 0.5))
gains = per_wheel(st.just(0.0)) | per_wheel(st.floats(0.0, 20.0))
driven = st.builds(Inputs, steering, per_wheel(st.floats(-6000.0, 6000.0)), gains)
roads = st.builds(
    Environment, st.floats(-0.3, 0.3), st.floats(-20.0, 20.0), per_wheel(st.floats(0.0, 1.2))
)


def wheel_velocities(vector, angles):
    vx, vy, r = vector[:3]
    for x, y, angle in zip(VEHICLE.wheel_x, VEHICLE.wheel_y, angles, strict=True):
        u, w = vx - y * r, vy + x * r
        yield u * math.cos(angle) + w * math.sin(angle), w * math.cos(angle) - u * math.sin(angle)


@quiet
@given(driving, driven, roads, models)
def test_the_algebraic_loop_closes(vector, inputs, road, model):
    found = evaluate(vector, inputs, road, model)
    static = static_loads(MODEL, road.bank)
    assert found.vertical_load == pytest.approx(vertical_loads(found.ay, static[0], static[2], MODEL), abs=1e-6)
    assert found.roll_angle == MODEL.roll_per_acceleration * found.ay
    leftward = sum(
        along * math.sin(angle) + across * math.cos(angle)
        for along, across, angle in zip(
            found.longitudinal_force, found.lateral_force, found.steer_angle, strict=True
        )
    )
    assert leftward / VEHICLE.mass == pytest.approx(found.ay, abs=1e-9)


@quiet
@given(driving, driven, roads, models)
def test_forces_are_those_of_the_tyre_at_the_reported_loads_and_slips(vector, inputs, road, model):
    found = evaluate(vector, inputs, road, model)
    for i, (v_long, v_lat) in enumerate(wheel_velocities(vector, found.steer_angle)):
        capacity = road.friction[i] * found.vertical_load[i]
        speed = math.hypot(v_long, v_lat)
        rest = lateral_capacity(capacity, found.longitudinal_force[i])
        slip, roll_steer = found.side_slip[i], (-0.2 if i < 2 else 0.2) * found.roll_angle
        turned = math.atan2(v_lat, v_long) - roll_steer
        assert math.sin(slip) == pytest.approx(-math.sin(turned), abs=1e-9)
        assert abs(slip) <= 0.5 * math.pi
        v_long, v_lat = speed * math.cos(turned), speed * math.sin(turned)
        force = side_force(-v_lat, abs(v_long), v_lat, rest, model)
        # At full use of the grip a square root of 0 stands here: the loop's 1e-11 become their root, 5e-6.
        assert found.lateral_force[i] == pytest.approx(force, rel=1e-6, abs=1e-3 + 5e-6 * capacity)


@quiet
@given(driving, driven, roads, models)
def test_friction_is_never_exceeded_and_axle_loads_are_conserved(vector, inputs, road, model):
    found = evaluate(vector, inputs, road, model)
    static = static_loads(MODEL, road.bank)
    assert max(found.friction_use) <= 1.0 + 1e-9
    assert min(found.vertical_load) >= 0.0
    fl, fr, rl, rr = found.vertical_load
    assert (fl + fr, rl + rr) == pytest.approx((2.0 * static[0], 2.0 * static[2]))


@quiet
@given(driving, driven, roads)
def test_tyres_only_dissipate(vector, inputs, road):
    found = evaluate(vector, inputs, road, STIFF)
    for i, (v_long, v_lat) in enumerate(wheel_velocities(vector, found.steer_angle)):
        assert found.lateral_force[i] * v_lat <= 1e-9
        assert abs(found.longitudinal_force[i] * v_long) <= abs(inputs.drive_force[i] * v_long)


@quiet
@given(driving, driven, roads)
def test_power_of_the_tyres_is_the_gain_of_kinetic_energy(vector, inputs, road):
    level = road._replace(bank=0.0, wind=0.0)
    vx, vy, r = vector[:3]
    rate = derivative(vector, inputs, level, STIFF)
    gain = VEHICLE.mass * (vx * rate[0] + vy * rate[1]) + VEHICLE.yaw_inertia * r * rate[2]
    found = evaluate(vector, inputs, level, STIFF)
    power = sum(
        found.longitudinal_force[i] * v_long + found.lateral_force[i] * v_lat
        for i, (v_long, v_lat) in enumerate(wheel_velocities(vector, found.steer_angle))
    )
    assert gain == pytest.approx(power, rel=1e-6, abs=1e-2)


def mirrored(values):
    return values[1], values[0], values[3], values[2]


def negative(values):
    return tuple(-value for value in values)


@quiet
@given(driving, driven, roads)
def test_a_mirrored_vehicle_does_the_mirrored_thing(vector, inputs, road):
    sign = np.array([1.0, -1.0, -1.0, 1.0, -1.0, -1.0])
    other = vector.copy()
    other[:6] *= sign
    angles, forces, slip_gains = inputs
    other_inputs = Inputs(mirrored(negative(angles)), mirrored(forces), mirrored(slip_gains))
    other_road = Environment(-road.bank, -road.wind, mirrored(road.friction))
    ours = derivative(vector, inputs, road, MODEL)[:6]
    assert derivative(other, other_inputs, other_road, MODEL)[:6] == pytest.approx(sign * ours, rel=1e-7, abs=1e-7)


def test_crab_is_an_equilibrium_like_any_straight_line(model):
    rate = derivative(state(3.0, 4.0, 0.0), Inputs((math.atan2(4.0, 3.0),) * 4), Environment(), model)
    assert rate == pytest.approx([0.0, 0.0, 0.0, 3.0, 4.0, 0.0, 0.0, 0.0, 0.0, 0.0], abs=1e-12)


def test_without_the_friction_circle_traction_costs_no_side_force():
    still = {'load_transfer': False, 'front_roll_steer': 0.0, 'rear_roll_steer': 0.0}
    free = constants(VehicleParameters(friction_circle=False, **still))
    vector, angles, pull = state(10.0, 0.0, 0.0), (0.2, 0.2, 0.0, 0.0), (2500.0, 2500.0, 0.0, 0.0)
    with_pull = evaluate(vector, Inputs(angles, pull), Environment(), free)
    without = evaluate(vector, Inputs(angles), Environment(), free)
    circle = evaluate(vector, Inputs(angles, pull), Environment(), MODEL)
    assert with_pull.longitudinal_force[0] == 2500.0
    assert with_pull.lateral_force == pytest.approx(without.lateral_force)
    assert circle.lateral_force[0] < 0.9 * without.lateral_force[0]


def test_constant_speed_holds_vx_and_leaves_the_drive_out(model):
    vector, inputs = state(6.0, -0.1, 0.5), Inputs((0.2, 0.15, 0.0, 0.0), (500.0,) * 4)
    two = derivative(vector, inputs, Environment(), model, constant_speed=True)
    three = derivative(vector, inputs._replace(drive_force=(0.0,) * 4), Environment(), model)
    assert two[0] == 0.0
    assert two[1:] == pytest.approx(three[1:])


def test_a_wheel_in_the_air_uses_no_friction():
    tall = constants(VehicleParameters(front_roll_centre_height=2.0, rear_roll_centre_height=2.0))
    found = evaluate(state(20.0, 0.0, 0.0), Inputs((0.15,) * 4), Environment(), tall)
    assert found.lifted == (True, False, True, False)
    assert found.friction_use[0] == found.friction_use[2] == 0.0


def test_speed_lost_in_a_turn_is_the_sine_of_the_side_forces(model):
    vector, angles = state(6.0, 0.0, 0.0), (0.1, 0.1, 0.0, 0.0)
    found = evaluate(vector, Inputs(angles), Environment(), model)
    braking = -(found.lateral_force[0] + found.lateral_force[1]) * math.sin(0.1)
    assert found.ax * model.mass == pytest.approx(braking)
    assert derivative(vector, Inputs(angles), Environment(), model)[0] == pytest.approx(found.ax)


@quiet
@given(driving, driven, roads, models)
def test_bisection_finds_the_same_acceleration(vector, inputs, road, model):
    fast = evaluate(vector, inputs, road, model).ay
    steps, loop.LOOP_STEPS = loop.LOOP_STEPS, 0
    try:
        slow = dynamics.evaluation(state_view(vector), inputs, road, model, False).ay
    finally:
        loop.LOOP_STEPS = steps
    assert slow == pytest.approx(fast, abs=1e-8)


def test_at_rest_nothing_happens(model):
    assert not derivative(initial_state(), Inputs((0.4, 0.3, -0.2, 1.0)), Environment(), model).any()
