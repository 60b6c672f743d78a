"""Traction and brake shared among the wheels: sums, moments, and no brake that drives backwards."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize

from omni_vehicle_ros.control import traction as law
from omni_vehicle_ros.control.actuator import DriveActuator
from omni_vehicle_ros.parameters import SteeringParameters, VehicleParameters, WheelModuleParameters

VEHICLE, STEERING = VehicleParameters(), SteeringParameters()
PERIOD = 0.005
AHEAD = (1.0,) * 4
angles = st.tuples(*[st.floats(-1.75, 1.75)] * 4)


def lever(i, angle):
    return VEHICLE.wheel_x[i] * math.sin(angle) - VEHICLE.wheel_y[i] * math.cos(angle)


def moment_of(forces, steer_angles):
    return sum(forces[i] * lever(i, steer_angles[i]) for i in range(4))


def speeds_under(total, steering, speed, lagging, cycles):
    """Speeds of a vehicle of one mass that runs straight on under open-loop traction or brake."""
    drives = [DriveActuator(WheelModuleParameters(ideal_actuators=not lagging)) for _ in range(4)]
    for _ in range(cycles):
        forces = law.traction_forces(total, AHEAD, (speed,) * 4, VEHICLE, steering)
        got = [drive.update(0.35 * f, PERIOD) / 0.35 for drive, f in zip(drives, forces, strict=True)]
        speed += PERIOD * sum(got) / VEHICLE.mass
        yield speed


def test_a_wheel_under_the_icr_gets_no_force():
    assert law.rolling_signs((0.0, 2.0, 2.0, -2.0)) == (0.0, 1.0, 1.0, -1.0)
    assert law.rolling_signs((0.0,) * 4) == (0.0,) * 4


@pytest.mark.parametrize('shares', [(0.25,) * 4, (0.5, 0.5, 0.0, 0.0), (0.0, 0.0, 0.5, 0.5)])
def test_open_loop_traction_sums_to_the_total(shares):
    # 500 N on each of four wheels for 2 s from rest give 3.08 m/s (thesis, sec. 4.3: 3.1 m/s).
    *_, speed = speeds_under(2000.0, SteeringParameters(drive_shares=shares), 0.0, False, 400)
    assert speed == pytest.approx(2000.0 * 2.0 / 1298.9)


@pytest.mark.parametrize('lagging', [True, False])
@pytest.mark.parametrize('begin', [3.0, -3.0, 0.05])
def test_an_open_loop_brake_never_drives_the_vehicle_backwards(lagging, begin):
    for speed in speeds_under(-4000.0, STEERING, begin, lagging, 2000):
        assert speed * begin >= -1e-6
    assert speed == pytest.approx(0.0, abs=1e-6)


@settings(deadline=None)
@given(st.floats(-3000.0, 3000.0), angles)
def test_moment_forces_make_the_moment(moment, steer_angles):
    forces = law.moment_forces(moment, steer_angles, VEHICLE)
    assert any(forces) == bool(moment) or abs(moment) < 1e-9
    assert moment_of(forces, steer_angles) == pytest.approx(moment, abs=1e-6) or not any(forces)


def test_moment_of_straight_wheels_is_half_the_track_times_right_minus_left():
    fl, fr, rl, rr = law.moment_forces(1000.0, (0.0,) * 4, VEHICLE)
    assert 1.436 / 2.0 * (fr + rr - fl - rl) == pytest.approx(1000.0)
    assert fl + fr + rl + rr == pytest.approx(0.0)


@settings(deadline=None)
@given(st.floats(-3000.0, 3000.0), angles, st.floats(-3.2, 3.2))
def test_each_axle_makes_half_of_the_moment_and_no_traction(moment, steer_angles, bearing):
    forces = law.axle_moment_forces(moment, steer_angles, bearing, VEHICLE)
    for axle in ((0, 1), (2, 3)):
        pair = tuple(force if i in axle else 0.0 for i, force in enumerate(forces))
        made = law.resultant(pair, steer_angles, bearing, VEHICLE)
        assert made.along == pytest.approx(0.0, abs=1e-6)
        assert made.moment == pytest.approx(0.5 * moment, abs=1e-6) or not any(pair)


def test_axle_forces_of_straight_wheels_are_those_of_the_thesis():
    # Mz = T / 2 (right - left) on one axle (thesis eq. 2.10), and half of Mz on each of two.
    fl, fr, rl, rr = law.axle_moment_forces(1000.0, (0.0,) * 4, 0.0, VEHICLE)
    assert 0.5 * 1.436 * (fr - fl) == pytest.approx(500.0)
    assert 0.5 * 1.436 * (rr - rl) == pytest.approx(500.0)
    assert (fr, rr) == (-fl, -rl)


def test_resultant_of_turned_wheels():
    made = law.resultant((100.0, 0.0, 0.0, 0.0), (math.pi / 2, 0.0, 0.0, 0.0), 0.0, VEHICLE)
    assert made == pytest.approx((0.0, 100.0, 100.0 * VEHICLE.cg_to_front_axle), abs=1e-9)
    crab = law.resultant((100.0,) * 4, (math.pi / 2,) * 4, math.pi / 2, VEHICLE)
    assert crab == pytest.approx((400.0, 0.0, 100.0 * sum(VEHICLE.wheel_x)), abs=1e-9)


@settings(deadline=None, max_examples=25)
@given(
    st.floats(200.0, 2000.0), st.tuples(*[st.floats(-0.4, 0.4)] * 4), st.tuples(*[st.floats(500.0, 4000.0)] * 4)
)
def test_the_easiest_moment_is_the_one_that_scipy_finds(moment, steer_angles, room):
    forces = law.easiest_moment_forces(moment, steer_angles, 0.0, room, VEHICLE)
    made = law.resultant(forces, steer_angles, 0.0, VEHICLE)
    assert (made.along, made.moment) == pytest.approx((0.0, moment), abs=1e-6)
    scale, weights = max(room), np.array(room) / max(room)
    found = minimize(
        lambda f: np.sum((f / weights) ** 2), np.zeros(4), jac=lambda f: 2.0 * f / weights**2, method='SLSQP',
        constraints=[
            {'type': 'eq', 'fun': lambda f: f @ np.cos(steer_angles)},
            {'type': 'eq', 'fun': lambda f: moment_of(f, steer_angles) - moment / scale},
        ],
        options={'ftol': 1e-14, 'maxiter': 300},
    )  # fmt: skip
    assert forces == pytest.approx(scale * found.x, abs=1e-3 * scale)


def test_no_moment_without_levers_or_room():
    towards_the_centre = tuple(math.atan2(y, x) for x, y in zip(VEHICLE.wheel_x, VEHICLE.wheel_y, strict=True))
    assert law.easiest_moment_forces(500.0, towards_the_centre, 0.0, (1000.0,) * 4, VEHICLE) == (0.0,) * 4
    assert law.easiest_moment_forces(500.0, (0.0,) * 4, 0.0, (0.0,) * 4, VEHICLE) == (0.0,) * 4
