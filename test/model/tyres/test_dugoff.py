"""Dugoff's tyre against the formulas of the thesis (eq. B.1-B.3) and of Boada et al. 2005."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq, minimize_scalar

from omni_vehicle_ros.model.tyres.dugoff import (
    FULL_STRETCH,
    dugoff,
    dugoff_combined,
    first_critical_slip,
    lateral_force,
    second_critical_slip,
)
from omni_vehicle_ros.model.tyres.slip import slip_ratio

STIFFNESS, REDUCTION = 30000.0, 0.015
quiet = settings(deadline=None, max_examples=60, derandomize=True)
capacities = st.floats(100.0, 8000.0)
speeds = st.floats(1.0, 40.0)
anything = st.floats(-1e6, 1e6)


def force_at(slip, speed, capacity):
    """Dugoff as printed, thesis eq. B.1-B.3, for a tyre that rolls forward."""
    tangent = math.tan(slip)
    factor = capacity * (1.0 - REDUCTION * speed * abs(tangent)) / (2.0 * STIFFNESS * abs(tangent))
    factor = max(0.0, factor)
    return STIFFNESS * tangent * (factor * (2.0 - factor) if factor < 1.0 else 1.0)


@quiet
@given(st.floats(1e-6, 1.2), speeds, capacities)
def test_force_is_dugoff_as_printed(slip, speed, capacity):
    ours = lateral_force(speed, -speed * math.tan(slip), capacity, STIFFNESS, REDUCTION)
    assert ours == pytest.approx(force_at(slip, speed, capacity), rel=1e-9, abs=1e-9)


@quiet
@given(anything, anything, capacities)
def test_force_opposes_sliding_within_the_grip_at_any_velocity(v_long, v_lat, capacity):
    force = lateral_force(v_long, v_lat, capacity, STIFFNESS, REDUCTION)
    assert abs(force) <= capacity
    assert force * v_lat <= 0.0


@quiet
@given(speeds, anything, capacities)
def test_a_wheel_rolling_backward_is_a_mirror_image(v_long, v_lat, capacity):
    force = lateral_force(v_long, v_lat, capacity, STIFFNESS, REDUCTION)
    assert lateral_force(-v_long, v_lat, capacity, STIFFNESS, REDUCTION) == force
    assert lateral_force(v_long, -v_lat, capacity, STIFFNESS, REDUCTION) == -force


def test_slope_at_no_slip_is_the_cornering_stiffness():
    assert lateral_force(10.0, -1e-6, 3000.0, STIFFNESS, REDUCTION) == pytest.approx(STIFFNESS * 1e-7)


@pytest.mark.parametrize(('v_long', 'v_lat', 'capacity'), [(0.0, 0.0, 3000.0), (0.0, 2.0, 0.0), (0.0, 0.0, 0.0)])
def test_nothing_to_divide_by_is_no_force(v_long, v_lat, capacity):
    assert lateral_force(v_long, v_lat, capacity, STIFFNESS, REDUCTION) == 0.0


def test_a_tyre_dragged_sideways_uses_all_the_grip_there_is():
    assert lateral_force(0.0, -2.0, 3000.0, STIFFNESS, REDUCTION) == pytest.approx(3000.0 * (1.0 - 2.0 * REDUCTION))
    assert dugoff(1.0, 0.0, 3000.0, STIFFNESS) == 3000.0


@quiet
@given(speeds, capacities)
def test_first_critical_slip_is_where_the_force_leaves_the_tangent(speed, capacity):
    def surplus(slip):  # lambda - 1
        tangent = math.tan(slip)
        return capacity * (1.0 - REDUCTION * speed * tangent) / (2.0 * STIFFNESS * tangent) - 1.0

    assert first_critical_slip(speed, capacity, STIFFNESS, REDUCTION) == pytest.approx(
        brentq(surplus, 1e-6, 1.0, xtol=1e-14), rel=1e-9
    )


@quiet
@given(speeds, capacities)
def test_second_critical_slip_is_the_peak_of_the_force(speed, capacity):
    peak = minimize_scalar(
        lambda slip: -force_at(slip, speed, capacity), bounds=(1e-4, 1.55), method='bounded', options={'xatol': 1e-10}
    )
    ours = second_critical_slip(speed, capacity, STIFFNESS, REDUCTION)
    assert ours == pytest.approx(peak.x, abs=1e-5)
    assert ours > first_critical_slip(speed, capacity, STIFFNESS, REDUCTION)


def test_the_force_never_falls_on_a_road_without_adhesion_reduction():
    assert second_critical_slip(20.0, 3000.0, STIFFNESS, 0.0) == pytest.approx(0.5 * math.pi)


def combined_as_printed(ratio, slip, speed, capacity):
    """Boada et al. 2005, wheel rolling forward, abs(ratio) < 1."""
    tangent = math.tan(slip)
    demand = math.hypot(50000.0 * ratio, STIFFNESS * tangent)
    factor = capacity * (1.0 - REDUCTION * speed * math.hypot(ratio, tangent)) * (1.0 - abs(ratio)) / (2.0 * demand)
    share = factor * (2.0 - factor) if factor < 1.0 else 1.0
    return (50000.0 * ratio / (1.0 - abs(ratio)) * share, STIFFNESS * tangent / (1.0 - abs(ratio)) * share)


@quiet
@given(st.floats(-0.9, 0.9), st.floats(0.001, 0.5), st.floats(1.0, 20.0), capacities)
def test_combined_slip_is_boada_as_printed(ratio, slip, speed, capacity):
    rim_speed = speed / (1.0 - ratio) if ratio > 0.0 else speed * (1.0 + ratio)
    assert slip_ratio(rim_speed, speed) == pytest.approx(ratio)
    ours = dugoff_combined(
        rim_speed, speed, -speed * math.tan(slip), capacity, (50000.0, STIFFNESS), REDUCTION
    )
    assert ours == pytest.approx(combined_as_printed(ratio, slip, speed, capacity), rel=1e-6, abs=1e-6)


@quiet
@given(speeds, st.floats(-20.0, 20.0), capacities)
def test_combined_slip_of_a_free_wheel_is_the_plain_tyre(speed, v_lat, capacity):
    force = dugoff_combined(speed, speed, v_lat, capacity, (50000.0, STIFFNESS), REDUCTION)
    assert force[0] == 0.0
    assert force[1] == pytest.approx(lateral_force(speed, v_lat, capacity, STIFFNESS, REDUCTION))


@quiet
@given(anything, anything, anything, capacities)
def test_combined_slip_keeps_within_the_grip_at_any_velocity(rim_speed, v_long, v_lat, capacity):
    force = dugoff_combined(rim_speed, v_long, v_lat, capacity, (50000.0, STIFFNESS), REDUCTION)
    assert math.hypot(*force) <= capacity * (1.0 + 1e-9)


def test_a_wheel_spinning_on_the_spot_pulls_with_all_its_grip():
    assert dugoff_combined(3.0, 0.0, 0.0, 2000.0, (50000.0, STIFFNESS), REDUCTION) == (2000.0, 0.0)
    assert dugoff_combined(0.0, 0.0, 0.0, 2000.0, (50000.0, STIFFNESS), REDUCTION) == (0.0, 0.0)


def test_full_stretch_is_at_seven_eighths_of_the_grip():
    assert dugoff(FULL_STRETCH * 3000.0 / STIFFNESS, 1.0, 3000.0, STIFFNESS) == pytest.approx(0.875 * 3000.0)
