"""A wheel that nothing steers trails behind its axis; one that is locked slides against its motion."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from omni_vehicle_ros.model.body_model import body_model
from omni_vehicle_ros.model.castor import castored
from omni_vehicle_ros.model.dynamics import Environment, Inputs
from omni_vehicle_ros.parameters import VehicleParameters
from omni_vehicle_ros.wheels import per_wheel

SPEEDS = st.floats(-10.0, 10.0)


@given(st.floats(-1.5, 1.5), SPEEDS, SPEEDS, st.floats(0.05, 0.5))
@settings(deadline=None, max_examples=30)
def test_a_castor_follows_its_equation(angle: float, along: float, across: float, trail: float) -> None:
    """de/dt = -(v / t) sin(e), integrated numerically."""
    speed, direction = math.hypot(along, across), math.atan2(across, along)
    if math.cos(angle - direction) < -0.999:
        return  # pushed straight forward it may fall to either side
    off = math.remainder(angle - direction, math.tau)
    path = solve_ivp(lambda _, e: -speed / trail * math.sin(e[0]), (0.0, 0.02), [off], rtol=1e-9, atol=1e-12)
    found = castored(angle, (along, across), trail, 0.02)
    assert found - angle == pytest.approx(path.y[0, -1] - off, abs=1e-6)


def test_a_castor_at_rest_stays() -> None:
    assert castored(0.7, (0.0, 0.0), 0.1, 1.0) == 0.7


@pytest.mark.parametrize('kind', ['yaw_plane', 'eight_dof'])
def test_a_vehicle_with_locked_wheels_slides_to_rest(kind: str) -> None:
    """With all wheels locked friction alone acts, against the motion: v^2 / (2 mu g) from 10 m/s to rest, straight.

    The tyres of eight_dof slide by Dugoff's law, whose friction falls with speed: 1 - 0.015 v at most.
    """
    vehicle, environment = VehicleParameters(body_model=kind), Environment()
    body, locked = body_model(vehicle), (0, 1, 2, 3)
    state, time, inputs = body.initial_state(10.0), 0.0, Inputs((0.0, 0.0, 0.0, 0.0))
    while state[0] > 0.05:
        state = body.locked(state, locked)
        now = body.evaluate(state, inputs, environment)
        force = per_wheel(lambda i: body.locking_force(i, state, now, 0.9))  # noqa: B023
        assert max(force) < 0.0
        state = body.advance(state, inputs._replace(drive_force=force), (0.0,) * 4, environment, 0.005, 0.001)
        time += 0.005
        assert time < 2.0
    ideal = 10.0**2 / (2 * 0.9 * vehicle.gravity)
    assert ideal * 0.99 < state[3] < ideal * (1.01 if kind == 'yaw_plane' else 1.15)
    assert abs(state[4]) < 1e-6


@pytest.mark.parametrize('kind', ['yaw_plane', 'eight_dof'])
def test_a_locked_wheel_at_rest_pushes_nothing(kind: str) -> None:
    body, inputs = body_model(VehicleParameters(body_model=kind)), Inputs((0.1, 0.0, 0.0, 0.0))
    state = body.initial_state(0.0)
    now = body.evaluate(state, inputs, Environment())
    assert body.locking_force(0, state, now, 0.9) == pytest.approx(0.0, abs=1e-9)


@given(SPEEDS, SPEEDS, st.floats(-1.0, 1.0))
@settings(deadline=None, max_examples=50)
def test_friction_of_a_locked_wheel_is_against_its_motion(vx: float, vy: float, angle: float) -> None:
    """Along the wheel it is mu N times the cosine of the angle between motion and wheel, the sign against it."""
    vehicle, environment = VehicleParameters(), Environment()
    body, inputs = body_model(vehicle), Inputs((angle, 0.0, 0.0, 0.0))
    state = body.initial_state(vx)
    state[1] = vy
    now = body.evaluate(state, inputs, environment)
    force = body.locking_force(0, state, now, 0.9)
    assert abs(force) <= 0.9 * now.vertical_load[0] * (1 + 1e-12)
    if math.hypot(vx, vy) > 0.1:
        cosine = math.cos(now.steer_angle[0] - math.atan2(vy, vx))
        assert force == pytest.approx(-0.9 * now.vertical_load[0] * cosine, abs=1e-6)
