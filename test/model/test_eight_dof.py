"""The equations with 8 degrees of freedom, at one instant: against 3-D rigid bodies, energy, closed forms."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omni_vehicle_ros.model import body
from omni_vehicle_ros.model.constants import constants
from omni_vehicle_ros.model.dynamics import Environment, Inputs
from omni_vehicle_ros.model.eight_dof.constants import eight_dof_constants
from omni_vehicle_ros.model.eight_dof.dynamics import state_rate
from omni_vehicle_ros.model.eight_dof.state import EightDofState, initial_state, state_vector, state_view
from omni_vehicle_ros.model.eight_dof.vehicle import evaluate
from omni_vehicle_ros.model.kinematics import Icr, road_steer_angles
from omni_vehicle_ros.model.loads import static_loads
from omni_vehicle_ros.model.plant import advance as advance_plane
from omni_vehicle_ros.model.state import State
from omni_vehicle_ros.model.state import initial_state as plane_initial_state
from omni_vehicle_ros.model.state import state_vector as plane_vector
from omni_vehicle_ros.parameters import VehicleParameters

VEHICLE = VehicleParameters(roll_yaw_inertia=60.0)
MODEL = eight_dof_constants(VEHICLE)
NO_ROLL_STEER = VehicleParameters(roll_yaw_inertia=60.0, front_roll_steer=0.0, rear_roll_steer=0.0)
RADIUS = VEHICLE.wheel_radius
STILL = (0.0, 0.0, 0.0, 0.0)
quiet = settings(deadline=None, max_examples=60, derandomize=True)


def derivative(vector, inputs, road, model, constant_speed=False):
    return state_vector(state_rate(state_view(vector), inputs, road, model, constant_speed))


def per_wheel(entries):
    return st.tuples(entries, entries, entries, entries)


def state(vx, vy=0.0, r=0.0, roll=0.0, roll_rate=0.0, spin=None, psi=0.0):
    spin = (vx / RADIUS,) * 4 if spin is None else spin
    return state_vector(EightDofState(vx, vy, r, 0.0, 0.0, psi, roll, roll_rate, spin, STILL, STILL))


# Every wheel faster than walking pace, whatever the yaw rate; slipping by up to a half either way.
driving = st.builds(
    lambda vx, vy, r, roll, roll_rate, slips: state(
        vx, vy, r, roll, roll_rate, tuple(vx / RADIUS * (1.0 + slip) for slip in slips)
    ),
    st.floats(4.0, 30.0),
    st.floats(-4.0, 4.0),
    st.floats(-1.0, 1.0),
    st.floats(-0.1, 0.1),
    st.floats(-0.5, 0.5),
    per_wheel(st.floats(-0.5, 0.5)),
)
driven = st.builds(
    Inputs, per_wheel(st.floats(-0.5, 0.5)), per_wheel(st.floats(-6000.0, 6000.0)), st.just(STILL)
)
roads = st.builds(Environment, st.floats(-0.3, 0.3), st.floats(-20.0, 20.0), per_wheel(st.floats(0.0, 1.2)))


def road_forces(found, inputs):
    """Return position and force of every wheel in the body frame, shape (4, 2) each."""
    angle = np.array(inputs.steer_angle)
    along, across = np.array(found.longitudinal_force), np.array(found.lateral_force)
    force = np.stack(
        [along * np.cos(angle) - across * np.sin(angle), along * np.sin(angle) + across * np.cos(angle)], axis=1
    )
    return np.stack([VEHICLE.wheel_x, VEHICLE.wheel_y], axis=1), force


def two_rigid_bodies(now, place, force, bank):
    """Return yaw and roll acceleration of two rigid bodies in 3-D that a hinge joins, by Newton and Euler.

    The sprung mass turns about the hinge, a level axis straight ahead; the other body carries hinge and wheels, and
    neither rolls nor pitches. No angle is taken to be small. The origin is below the hinge, on the other body.
    """
    v, sprung, arm = VEHICLE, VEHICLE.sprung_mass, VEHICLE.roll_arm
    rest, p, r = v.mass - sprung, now.roll_rate, now.r
    cos, sin = math.cos(now.roll), math.sin(now.roll)
    turn = np.array([[1.0, 0.0, 0.0], [0.0, cos, -sin], [0.0, sin, cos]])
    # About the hinge the sprung mass has the parameters' inertia. Any Iyy and Izz do; the rest of Iz is the other's.
    centre = np.diag([v.roll_inertia - sprung * arm**2, 900.0, 1100.0])
    centre[0, 2] = centre[2, 0] = -v.roll_yaw_inertia
    inertia = turn @ centre @ turn.T
    to_centre, omega = turn @ [0.0, 0.0, arm], np.array([p, 0.0, r])
    gravity = v.gravity * np.array([0.0, math.sin(bank), -math.cos(bank)])

    def residual(ax, ay, yaw, roll):
        origin = np.array([ax, ay, 0.0])
        spinning = np.array([roll, p * r, yaw])  # derivative of p ex + r ez, ex turning with r
        acceleration = origin + np.cross(spinning, to_centre) + np.cross(omega, np.cross(omega, to_centre))
        linear = sprung * acceleration + rest * origin - v.mass * gravity
        angular = inertia @ spinning + np.cross(omega, inertia @ omega)
        about_hinge = np.cross(to_centre, sprung * (acceleration - gravity)) + angular
        springs = -v.roll_stiffness * now.roll - v.roll_damping * p
        moment = place[:, 0] @ force[:, 1] - place[:, 1] @ force[:, 0]
        return np.array([
            linear[0] - force[:, 0].sum(),
            linear[1] - force[:, 1].sum(),
            about_hinge[2] + (v.yaw_inertia - 1100.0) * yaw - moment,
            about_hinge[0] - springs,
        ])  # fmt: skip

    start = residual(0.0, 0.0, 0.0, 0.0)
    matrix = np.stack([residual(*unit) - start for unit in np.eye(4)], axis=1)
    return np.linalg.solve(matrix, -start)[2:]


@quiet
@given(driving, driven, st.floats(-0.3, 0.3))
def test_upright_the_equations_are_those_of_two_rigid_bodies_in_space(vector, inputs, bank):
    vector[6] = 0.0
    now, road = state_view(vector), Environment(bank=bank)
    place, force = road_forces(evaluate(vector, inputs, road, MODEL), inputs)
    exact = two_rigid_bodies(now, place, force, bank)
    rate = state_view(derivative(vector, inputs, road, MODEL))
    assert (rate.r, rate.roll_rate) == pytest.approx(exact, rel=1e-9, abs=1e-9)


def test_what_is_left_out_is_one_lever_arm_and_squares_of_the_roll_angle():
    inputs, rest = Inputs((0.1, 0.08, -0.02, 0.0), STILL), []
    for roll in (0.08, 0.04, 0.02):
        vector = state(15.0, 0.5, 0.4, roll, 0.3, (40.0, 41.0, 44.0, 42.0))
        place, force = road_forces(evaluate(vector, inputs, Environment(), MODEL), inputs)
        exact = two_rigid_bodies(state_view(vector), place, force, 0.0)
        ours = derivative(vector, inputs, Environment(), MODEL)
        shift = VEHICLE.sprung_mass / VEHICLE.mass * VEHICLE.roll_arm * math.sin(roll)
        # The road's force has the arm of the wheels about the origin less that of the centre of gravity.
        matrix = np.array([[1627.0, -60.0], [-60.0, MODEL.roll_inertia]])
        lever = np.linalg.solve(matrix, [-shift * force[:, 0].sum(), 0.0])
        rest.append(np.abs(exact - ours[[2, 7]] - lever).max() / np.abs(exact).max())
    assert rest[0] < 0.08**2
    orders = [math.log2(coarse / fine) for coarse, fine in itertools.pairwise(rest)]
    assert min(orders) > 1.8


@quiet
@given(driving, driven, roads)
def test_wheels_see_the_motion_of_the_body_that_roll_pushes_aside(vector, inputs, road):
    now, model = state_view(vector), eight_dof_constants(NO_ROLL_STEER)
    slips = evaluate(vector, inputs, road, model).side_slip
    # The centre of gravity keeps its momentum: what does not roll goes left as fast as it must.
    aside = VEHICLE.sprung_mass / VEHICLE.mass * VEHICLE.roll_arm * now.roll_rate
    for x, y, angle, slip in zip(VEHICLE.wheel_x, VEHICLE.wheel_y, inputs.steer_angle, slips, strict=True):
        direction = math.atan2(now.vy + x * now.r + aside, now.vx - y * now.r)
        assert math.sin(slip) == pytest.approx(math.sin(angle - direction), abs=1e-12)


def energy_gradient(now):
    """Return d(T + V)/d(state), kinetic energy and the springs', without the tyres'."""
    gradient = np.zeros(20)
    gradient[:3] = MODEL.plane.mass * now.vx, MODEL.plane.mass * now.vy, 1627.0 * now.r - 60.0 * now.roll_rate
    gradient[6] = MODEL.net_roll_stiffness * now.roll
    gradient[7] = MODEL.roll_inertia * now.roll_rate - 60.0 * now.r
    gradient[8:12] = VEHICLE.wheel_inertia * np.array(now.spin)
    return gradient


@quiet
@given(driving, driven, roads)
def test_the_tyres_and_the_dampers_only_take_energy(vector, inputs, road):
    model, now = eight_dof_constants(NO_ROLL_STEER), state_view(vector)
    calm = road._replace(wind=0.0)
    rate = derivative(vector, inputs, calm, model)
    given_in = VEHICLE.mass * VEHICLE.gravity * math.sin(calm.bank) * now.vy
    given_in += sum(force * RADIUS * spin for force, spin in zip(inputs.drive_force, now.spin, strict=True))
    damped = VEHICLE.roll_damping * now.roll_rate**2
    # What is left is what the tyres take; a slip that lasts makes heat, no force without.
    taken = given_in - damped - energy_gradient(now) @ rate
    assert taken >= -1e-9 * (abs(given_in) + damped + 1e5)


@quiet
@given(driving, driven, roads)
def test_what_the_tyres_take_is_force_times_speed_of_the_slip(vector, inputs, road):
    model, now, calm = eight_dof_constants(NO_ROLL_STEER), state_view(vector), road._replace(bank=0.0, wind=0.0)
    found = evaluate(vector, inputs, calm, model)
    place, force = road_forces(found, inputs)
    aside = model.roll_shift * now.roll_rate
    velocity = np.array([now.vx, now.vy + aside]) + now.r * np.stack([-place[:, 1], place[:, 0]], axis=1)
    power = (force * velocity).sum() - RADIUS * np.dot(found.longitudinal_force, now.spin)
    rate = derivative(vector, inputs._replace(drive_force=STILL), calm, model)
    gain = energy_gradient(now) @ rate + VEHICLE.roll_damping * now.roll_rate**2
    assert gain == pytest.approx(power, rel=1e-9, abs=1e-4)


@quiet
@given(driving, driven, roads)
def test_angular_momentum_of_every_wheel(vector, inputs, road):
    found, rate = evaluate(vector, inputs, road, MODEL), state_view(derivative(vector, inputs, road, MODEL))
    for drive, along, spin in zip(inputs.drive_force, found.longitudinal_force, rate.spin, strict=True):
        assert VEHICLE.wheel_inertia * spin == pytest.approx(RADIUS * (drive - along), rel=1e-9, abs=1e-6)


@quiet
@given(driving, driven, roads)
def test_loads_are_springs_dampers_and_roll_centres(vector, inputs, road):
    now, v = state_view(vector), VEHICLE
    found, static = evaluate(vector, inputs, road, MODEL), static_loads(MODEL.plane, road.bank)
    moment = v.roll_stiffness * now.roll + v.roll_damping * now.roll_rate
    sides = v.cg_to_rear_axle / v.wheelbase, v.cg_to_front_axle / v.wheelbase
    heights = v.front_roll_centre_height, v.rear_roll_centre_height
    leftward = road_forces(found, inputs)[1][:, 1].sum() / v.mass
    assert leftward == pytest.approx(found.ay, abs=1e-9)
    for axle, share in enumerate((0.552, 0.448)):
        left, right = found.vertical_load[2 * axle : 2 * axle + 2]
        shift = (share * moment + v.sprung_mass * found.ay * sides[axle] * heights[axle]) / v.front_track
        rest = static[2 * axle]
        expected = math.copysign(min(abs(shift), rest), shift)
        assert (left, right) == pytest.approx((rest - expected, rest + expected), abs=1e-6)


@quiet
@given(driving, driven, roads)
def test_friction_is_never_exceeded(vector, inputs, road):
    found = evaluate(vector, inputs, road, MODEL)
    assert max(found.friction_use) <= 1.0 + 1e-9
    assert min(found.vertical_load) >= 0.0
    assert found.roll_angle == vector[6]


def mirrored(values):
    return values[1], values[0], values[3], values[2]


@quiet
@given(driving, driven, roads)
def test_a_mirrored_vehicle_does_the_mirrored_thing(vector, inputs, road):
    sign = np.array([1.0, -1.0, -1.0, 1.0, -1.0, -1.0, -1.0, -1.0] + [1.0] * 8 + [-1.0] * 4)
    order = [*range(8), *(first + i for first in (8, 12, 16) for i in (1, 0, 3, 2))]
    other_inputs = Inputs(mirrored(tuple(-a for a in inputs.steer_angle)), mirrored(inputs.drive_force))
    other_road = Environment(-road.bank, -road.wind, mirrored(road.friction))
    ours = derivative(vector, inputs, road, MODEL)
    other = derivative((sign * vector)[order], other_inputs, other_road, MODEL)
    assert other == pytest.approx((sign * ours)[order], rel=1e-7, abs=1e-7)


@quiet
@given(driving, driven, roads)
def test_without_roll_and_slip_it_is_the_model_in_the_plane(vector, inputs, road):
    now, twist = state_view(vector), vector[:6].copy()
    flat = {'load_transfer': False, 'front_roll_steer': 0.0, 'rear_roll_steer': 0.0}
    plane, vehicle = constants(VehicleParameters(**flat)), VehicleParameters(**flat)
    rims = []
    for x, y, angle in zip(VEHICLE.wheel_x, VEHICLE.wheel_y, inputs.steer_angle, strict=True):
        along, across = now.vx - y * now.r, now.vy + x * now.r
        rims.append(along * math.cos(angle) + across * math.sin(angle))
    rolling = now._replace(roll=0.0, roll_rate=0.0, spin=tuple(rim / RADIUS for rim in rims))
    ours = derivative(state_vector(rolling), inputs, road, eight_dof_constants(vehicle))
    coasting = Inputs(inputs.steer_angle)
    theirs = body.derivative(plane_vector(State(*twist, *STILL)), coasting, road, plane)
    assert ours[:6] == pytest.approx(theirs[:6], rel=1e-9, abs=1e-9)


@pytest.mark.parametrize('gain', [0.5, 5.0, 60.0])
def test_side_slip_control_is_solved_at_the_instant(gain):
    vector, angles = state(9.0, 0.3, 0.4, 0.03, 0.1), (0.2, 0.15, -0.05, 0.0)
    inputs, gains = Inputs(angles, STILL, (gain,) * 4), np.full(4, gain)
    free, held = evaluate(vector, Inputs(angles), Environment(), MODEL), evaluate(vector, inputs, Environment(), MODEL)
    # Roll is a state here, so that it is not changed by the control at the same instant.
    assert held.side_slip == pytest.approx(np.array(free.side_slip) / (1.0 + gains), rel=1e-9)
    assert held.steer_angle == pytest.approx(np.array(angles) - gains * held.side_slip, rel=1e-9)


def test_constant_speed_holds_vx_and_leaves_the_torques_out():
    vector, inputs = state(6.0, -0.1, 0.5, 0.02), Inputs((0.2, 0.15, 0.0, 0.0), (500.0,) * 4)
    held = derivative(vector, inputs, Environment(), MODEL, constant_speed=True)
    coasting = derivative(vector, Inputs(inputs.steer_angle), Environment(), MODEL)
    assert held[0] == 0.0
    assert held[1:] == pytest.approx(coasting[1:])


def test_flat_rest_is_exact():
    rest = initial_state(0.0, RADIUS)
    assert not derivative(rest, Inputs((0.4, 0.3, -0.2, 1.0)), Environment(), MODEL).any()


@pytest.mark.parametrize(('radius', 'speed'), [(5.0, 15.0 / 3.6), (-10.0, 6.0), (60.0, 20.0)])
@pytest.mark.parametrize('road', [Environment(), Environment(bank=0.02, wind=6.0, friction=(0.9, 0.8, 0.9, 0.8))])
def test_a_steady_turn_of_the_plane_is_one_with_roll_and_spin(radius, speed, road):
    vehicle = VehicleParameters(aerodynamic_centre=0.1)
    plane, model = constants(vehicle), eight_dof_constants(vehicle)
    inputs = Inputs(road_steer_angles(Icr(0.0, radius), vehicle))
    end = advance_plane(plane_initial_state(speed), inputs.steer_angle, STILL, STILL, road, plane, 12.0, 0.001, True)
    found = body.evaluate(end, inputs, road, plane, True)
    vx, vy, r = end[:3]
    rims = []
    for wheel, (x, y, angle) in enumerate(zip(vehicle.wheel_x, vehicle.wheel_y, inputs.steer_angle, strict=True)):
        turned = angle + (-0.2 if wheel < 2 else 0.2) * found.roll_angle
        rims.append((vx - y * r) * math.cos(turned) + (vy + x * r) * math.sin(turned))
    spin = tuple(rim / RADIUS for rim in rims)
    vector = state(vx, vy, r, found.roll_angle, 0.0, spin, end[5])
    now = evaluate(vector, inputs, road, model, True)
    assert now.side_slip == pytest.approx(found.side_slip, abs=1e-12)
    assert now.vertical_load == pytest.approx(found.vertical_load, rel=1e-9)
    assert now.lateral_force == pytest.approx(found.lateral_force, rel=1e-9)
    assert now.longitudinal_force == pytest.approx(STILL, abs=1e-6)
    rate = derivative(vector, inputs, road, model, True)
    assert rate[[1, 2, 6, 7, 8, 9, 10, 11]] == pytest.approx(np.zeros(8), abs=1e-8)
