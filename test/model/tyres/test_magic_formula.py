"""The Magic Formula as printed, its peak, and its combined slip."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq, minimize_scalar

from omni_vehicle_ros.model.tyres.magic_formula import full_stretch, magic_force, magic_share, past_peak

quiet = settings(deadline=None, max_examples=60, derandomize=True)
STIFFNESS = (50000.0, 30000.0)
capacities = st.floats(100.0, 8000.0)
shapes = st.floats(1.0, 2.0)
curvatures = st.floats(-10.0, 0.99)


def as_printed(slip, capacity, stiffness, c, e):
    """Pacejka 2012, sec. 4.3.1, without shifts: D sin(C atan(B x - E (B x - atan(B x))))."""
    b = stiffness / (c * capacity)
    return capacity * math.sin(c * math.atan(b * slip - e * (b * slip - math.atan(b * slip))))


@quiet
@given(st.floats(-1.5, 1.5), capacities, shapes, curvatures)
def test_force_of_either_direction_is_the_formula_as_printed(slip, capacity, shape, curvature):
    side = magic_force((0.0, slip), 1.0, capacity, STIFFNESS, shape, curvature)
    along = magic_force((slip, 0.0), 1.0, capacity, STIFFNESS, shape, curvature)
    assert side == pytest.approx((0.0, as_printed(slip, capacity, 30000.0, shape, curvature)), rel=1e-9, abs=1e-9)
    assert along == pytest.approx((as_printed(slip, capacity, 50000.0, shape, curvature), 0.0), rel=1e-9, abs=1e-9)


def test_values_worked_out_by_hand():
    # C = 1, E = 1: D sin(atan(atan x)) = D atan x / sqrt(1 + atan^2 x); at x = 1, atan x = pi / 4.
    assert magic_share(1.0, 1.0, 1.0) == pytest.approx((math.pi / 4) / math.hypot(1.0, math.pi / 4))
    # C = 2, E = 0: sin(2 atan x) = 2 x / (1 + x^2), whose peak is at x = 1.
    assert magic_share(0.5, 2.0, 0.0) == pytest.approx(0.8)
    assert magic_share(1.0, 2.0, 0.0) == pytest.approx(1.0)
    assert magic_share(3.0, 2.0, 0.0) == pytest.approx(0.6)


@quiet
@given(st.floats(1.05, 1.95), curvatures)
def test_the_peak_is_the_friction_and_stands_where_the_bracket_says(shape, curvature):
    """Pacejka 2012, sec. 4.3.1: E = (B x - tan(pi / 2 C)) / (B x - atan(B x)) at the peak."""
    def bracket(x):
        return x - curvature * (x - math.atan(x)) - math.tan(0.5 * math.pi / shape)

    peak = brentq(bracket, 0.0, 1e5)
    assert magic_share(peak, shape, curvature) == pytest.approx(1.0, rel=1e-12)
    assert not past_peak(0.999 * peak, shape, curvature)
    assert past_peak(1.001 * peak, shape, curvature)


def test_the_peak_is_where_scipy_finds_it():
    found = minimize_scalar(
        lambda slip: -magic_force((0.0, slip), 1.0, 3000.0, STIFFNESS, 1.193, -1.003)[1],
        bounds=(0.01, 1.0), method='bounded', options={'xatol': 1e-12},
    )  # fmt: skip
    assert -found.fun == pytest.approx(3000.0, rel=1e-9)
    normalised = 30000.0 * found.x / (1.193 * 3000.0)
    assert normalised + 1.003 * (normalised - math.atan(normalised)) == pytest.approx(
        math.tan(0.5 * math.pi / 1.193), rel=1e-4
    )


@quiet
@given(capacities, shapes, curvatures)
def test_far_away_the_shape_factor_alone_counts(capacity, shape, curvature):
    """Pacejka 2012, sec. 4.3.1: ya = D sin(pi C / 2)."""
    found = magic_force((0.0, 1.0), 0.0, capacity, STIFFNESS, shape, curvature)[1]
    assert found == pytest.approx(capacity * math.sin(0.5 * math.pi * shape), abs=1e-6 * capacity)


@quiet
@given(st.floats(-math.pi, math.pi), st.floats(0.001, 1.0), capacities)
def test_combined_slip_is_pure_slip_at_the_same_demand(direction, size, capacity):
    slip = size * math.cos(direction) / 50000.0, size * math.sin(direction) / 30000.0
    slip = 3e4 * slip[0], 3e4 * slip[1]
    force = magic_force(slip, 1.0, capacity, STIFFNESS, 1.193, -1.003)
    pure = as_printed(size, capacity, 30000.0, 1.193, -1.003)
    assert force == pytest.approx((pure * math.cos(direction), pure * math.sin(direction)), abs=1e-9 * capacity)


@quiet
@given(shapes, curvatures)
def test_full_stretch_is_on_the_rising_side(shape, curvature):
    stretch = full_stretch(shape, curvature) / shape
    assert magic_share(stretch, shape, curvature) == pytest.approx(0.875, rel=1e-9)
    assert not past_peak(stretch, shape, curvature)
