"""What the controllers reckon that tyres can do, against the model itself."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize_scalar

from omni_vehicle_ros.control.grip import Grip, traction_share
from omni_vehicle_ros.model.body import Environment, Inputs, evaluate
from omni_vehicle_ros.model.constants import constants
from omni_vehicle_ros.model.state import State, state_vector
from omni_vehicle_ros.parameters import VehicleParameters

VEHICLE = VehicleParameters()
TURN = (0.24, 0.18, -0.31, -0.24)


@pytest.mark.parametrize('friction', [0.9, 0.5])
def test_loads_side_forces_and_roll_steer_are_those_of_the_vehicle(friction):
    state = State(4.5, 0.05, 0.9, *[0.0] * 7)
    road = Environment(friction=(friction,) * 4)
    seen = evaluate(state_vector(state), Inputs(TURN), road, constants(VEHICLE))
    grip = Grip(VEHICLE, friction)
    capacities, roll = grip.capacities(seen.ay), grip.roll_steer(seen.ay)
    assert capacities == pytest.approx([friction * load for load in seen.vertical_load])
    for i in range(4):
        along, across = state.vx - VEHICLE.wheel_y[i] * state.r, state.vy + VEHICLE.wheel_x[i] * state.r
        slip = TURN[i] + roll[i] - math.atan2(across, along)
        assert seen.side_slip[i] == pytest.approx(slip)
        force = grip.side_force(slip, math.hypot(along, across), capacities[i])
        assert force == pytest.approx(seen.lateral_force[i])


@pytest.mark.parametrize('speed', [2.0, 5.0, 10.0, 30.0])
@pytest.mark.parametrize('friction', [0.9, 0.5])
def test_the_slip_limit_gives_nearly_all_force_and_lies_below_the_peak(speed, friction):
    grip, capacity = Grip(VEHICLE, friction), 0.25 * friction * 1298.9 * 9.81

    def force(slip):
        return grip.side_force(slip, speed / math.cos(slip), capacity)

    peak = minimize_scalar(lambda slip: -force(slip), bounds=(0.01, 1.5), options={'xatol': 1e-6})
    limit = grip.slip_limit(speed)
    assert limit == pytest.approx(0.5 * peak.x, rel=1e-3)
    assert force(limit) > 0.93 * force(peak.x)


@settings(deadline=None)
@given(*[st.tuples(*[st.floats(-3000.0, 3000.0)] * 4)] * 2, st.tuples(*[st.floats(0.0, 4000.0)] * 4))
def test_added_forces_stay_within_their_room(wanted, present, room):
    share = traction_share(wanted, present, room)
    assert 0.0 <= share <= 1.0
    for w, p, r in zip(wanted, present, room, strict=True):
        assert abs(p + share * w) <= max(r, abs(p)) + 1e-6


def test_the_largest_share_is_found():
    assert traction_share((100.0, -100.0, 0.0, 0.0), (50.0,) * 4, (75.0,) * 4) == 0.25
    assert traction_share((10.0, -10.0, 0.0, 0.0), (50.0,) * 4, (75.0,) * 4) == 1.0
    assert traction_share((0.0,) * 4, (50.0,) * 4, (0.0,) * 4) == 1.0
