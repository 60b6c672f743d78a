import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omni_vehicle_ros.model.constants import constants
from omni_vehicle_ros.model.loads import lifted, roll_angle, roll_steer_angles, static_loads, vertical_loads
from omni_vehicle_ros.parameters import VehicleParameters

quiet = settings(deadline=None, max_examples=60, derandomize=True)


def test_static_loads_hold_the_weight_and_balance_about_the_centre_of_gravity(vehicle, model):
    loads = static_loads(model)
    assert sum(loads) == pytest.approx(vehicle.mass * vehicle.gravity)
    assert sum(x * load for x, load in zip(vehicle.wheel_x, loads, strict=True)) == pytest.approx(0.0, abs=1e-9)


def test_a_bank_takes_its_cosine_off_the_loads(model):
    level, banked = static_loads(model), static_loads(model, 0.3)
    assert banked == pytest.approx([math.cos(0.3) * load for load in level])
    assert static_loads(model, 2.0) == (0.0,) * 4


@quiet
@given(st.floats(-5.0, 5.0))
def test_transfer_balances_the_moment_about_the_roll_axis(ay):
    # With a level roll axis at the height h the transfers carry ms ay h and the moment of the springs, K phi.
    vehicle = VehicleParameters()
    model = constants(vehicle)
    fl, fr, rl, rr = vertical_loads(ay, *static_loads(model)[1:3], model)
    moment = 0.5 * vehicle.front_track * (fr - fl) + 0.5 * vehicle.rear_track * (rr - rl)
    springs = vehicle.roll_stiffness * roll_angle(ay, model)
    axis = vehicle.sprung_mass * ay * vehicle.front_roll_centre_height
    assert moment == pytest.approx(springs + axis, abs=1e-6)


def test_roll_is_the_balance_of_springs_gravity_and_inertia(vehicle, model):
    roll = roll_angle(3.0, model)
    overturning = vehicle.sprung_mass * vehicle.roll_arm * (3.0 + vehicle.gravity * roll)
    assert vehicle.roll_stiffness * roll == pytest.approx(overturning)


@quiet
@given(st.floats(-1e6, 1e6))
def test_axle_loads_are_conserved_and_never_negative(ay):
    model = constants(VehicleParameters())
    static = static_loads(model)
    fl, fr, rl, rr = loads = vertical_loads(ay, static[0], static[2], model)
    assert min(loads) >= 0.0
    assert (fl + fr, rl + rr) == pytest.approx((2.0 * static[0], 2.0 * static[2]))
    assert vertical_loads(-ay, static[0], static[2], model) == (fr, fl, rr, rl)


def test_a_left_turn_unloads_and_at_last_lifts_the_left_wheels(model):
    static = static_loads(model)
    gentle = vertical_loads(2.0, static[0], static[2], model)
    assert gentle[0] < static[0] < gentle[1]
    assert lifted(gentle, model) == (False,) * 4
    assert lifted(vertical_loads(30.0, static[0], static[2], model), model) == (True, False, True, False)


def test_load_transfer_can_be_left_out():
    model = constants(VehicleParameters(load_transfer=False))
    static = static_loads(model)
    assert vertical_loads(8.0, static[0], static[2], model) == static


def test_roll_steer_of_both_axles_understeers(model):
    front, _, rear, _ = roll_steer_angles(roll_angle(3.0, model), model)
    assert front < 0.0 < rear
