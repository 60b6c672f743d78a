"""The regions in which a tyre works, for every tyre."""

import math

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from omni_vehicle_ros.model.constants import BRUSH, DUGOFF, constants
from omni_vehicle_ros.model.tyres.dugoff import first_critical_slip, second_critical_slip
from omni_vehicle_ros.model.tyres.force import side_force, tyre_force
from omni_vehicle_ros.model.tyres.region import Region, combined_region, region
from omni_vehicle_ros.parameters import VehicleParameters

quiet = settings(
    deadline=None, max_examples=40, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
ANGLES = np.linspace(0.0, 1.4, 1401)


@pytest.mark.parametrize('speed', [4.0, 20.0])
@pytest.mark.parametrize('capacity', [1000.0, 3000.0])
def test_regions_follow_each_other_and_end_where_the_curve_says(tyre, speed, capacity):
    found = [region(angle, speed, capacity, tyre) for angle in ANGLES]
    assert found == sorted(found)
    assert set(found) == set(Region)
    forces = [side_force(math.tan(a), 1.0, speed * math.tan(a), capacity, tyre) for a in ANGLES]
    # Where the force stops rising: at the peak, or at the first of a row of equals.
    assert ANGLES[found.index(Region.SLIDING)] == pytest.approx(ANGLES[int(np.argmax(forces))], abs=0.0021)
    beyond = found.index(Region.NONLINEAR)
    share = forces[beyond] / (tyre.cornering_stiffness * math.tan(ANGLES[beyond]))
    if tyre.tyre_model != DUGOFF:
        assert share == pytest.approx(0.95, abs=0.02)
        assert share < 0.95
    else:
        assert 0.99 < share < 1.0


@quiet
@given(st.floats(-1.5, 1.5), st.floats(0.1, 40.0), st.floats(100.0, 8000.0))
def test_left_and_right_are_the_same(tyre, angle, speed, capacity):
    assert region(angle, speed, capacity, tyre) == region(-angle, -speed, capacity, tyre)


@quiet
@given(st.floats(0.0, 1.5), st.floats(0.1, 40.0), st.floats(100.0, 8000.0))
def test_dugoffs_regions_end_at_its_critical_slips(angle, speed, capacity):
    limits = speed, capacity, 30000.0, 0.015
    expected = (angle > first_critical_slip(*limits)) + (angle > second_critical_slip(*limits))
    assert region(angle, speed, capacity, constants(VehicleParameters())) == expected


@quiet
@given(st.floats(100.0, 8000.0))
def test_the_brush_slides_where_no_bristle_sticks(capacity):
    tyre, full = constants(VehicleParameters(tyre_model='brush')), math.atan(3.0 * capacity / 30000.0)
    assert tyre.tyre_model == BRUSH
    assert region(full * 1.001, 10.0, capacity, tyre) is Region.SLIDING
    assert region(full * 0.999, 10.0, capacity, tyre) is Region.NONLINEAR


def test_a_wheel_in_the_air_slides_unless_it_runs_straight(tyre):
    assert region(0.1, 10.0, 0.0, tyre) is Region.SLIDING
    assert region(0.0, 10.0, 0.0, tyre) is Region.LINEAR
    assert region(0.0, 10.0, 3000.0, tyre) is Region.LINEAR


@quiet
@given(st.floats(-1.4, 1.4), st.floats(0.5, 40.0), st.floats(500.0, 8000.0))
def test_a_wheel_that_rolls_freely_is_where_its_side_slip_alone_puts_it(tyre, angle, speed, capacity):
    near = {region(angle * share, speed, capacity, tyre) for share in (0.998, 1.002)}
    assert combined_region(angle, speed, speed, capacity, tyre) in near


@quiet
@given(st.floats(-0.5, 0.5), st.floats(-0.6, 0.6), st.floats(0.5, 40.0), st.floats(500.0, 8000.0))
def test_with_spin_dugoffs_tyre_is_linear_up_to_lambda_1(angle, ratio, speed, capacity):
    """Lambda of combined slip: mu Fz (1 - eps_r u hypot(S, tan)) (1 - S) / (2 hypot(C_s S, C_alpha tan))."""
    tyre, slope = constants(VehicleParameters()), math.tan(angle)
    rim_speed = speed * (1.0 + ratio) if ratio < 0.0 else speed / (1.0 - ratio)
    demand = 2.0 * math.hypot(50000.0 * ratio, 30000.0 * slope)
    left = capacity * max(0.0, 1.0 - 0.015 * speed * math.hypot(ratio, slope)) * (1.0 - abs(ratio))
    if abs(left - demand) > 1e-3 * demand:
        assert (combined_region(angle, rim_speed, speed, capacity, tyre) is Region.LINEAR) == (left > demand)


def test_a_braked_wheel_slides_past_the_peak_of_its_brake_force(tyre):
    """At a held speed of the rim, as a side-slip curve is at a held speed along the wheel."""
    speeds = 15.0 * (1.0 + np.linspace(0.001, 0.9, 900))
    forces = [-tyre_force(15.0, speed, 0.0, 3000.0, tyre)[0] for speed in speeds]
    found = [combined_region(0.0, 15.0, speed, 3000.0, tyre) for speed in speeds]
    assert found == sorted(found)
    assert set(found) == set(Region)
    assert speeds[found.index(Region.SLIDING)] == pytest.approx(speeds[int(np.argmax(forces))], abs=2.1 * 0.015)


def test_a_locked_wheel_slides_whichever_way_it_moves(tyre):
    for angle in (0.0, 0.3, 1.2):
        assert combined_region(angle, 0.0, 20.0, 3000.0, tyre) is Region.SLIDING
