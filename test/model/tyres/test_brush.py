"""The brush tyre against its cubic, and against bristles summed up one by one."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.optimize import brentq

from omni_vehicle_ros.model.tyres.brush import brush_force, demand

quiet = settings(deadline=None, max_examples=40, derandomize=True)
STIFFNESS = (50000.0, 30000.0)
capacities = st.floats(100.0, 8000.0)
ROUND = (30000.0, 30000.0)


@quiet
@given(st.floats(0.0, 1.5), capacities)
def test_side_force_is_the_cubic_of_pacejka(slip, capacity):
    """Pacejka 2012, sec. 3.2: Fy = mu Fz (3 psi - 3 psi^2 + psi^3), psi = C tan(alpha) / (3 mu Fz)."""
    psi = min(30000.0 * slip / (3.0 * capacity), 1.0)
    expected = capacity * (3.0 * psi - 3.0 * psi**2 + psi**3)
    assert brush_force((0.0, slip), 1.0, capacity, STIFFNESS)[1] == pytest.approx(expected, rel=1e-9, abs=1e-9)


@quiet
@given(capacities)
def test_all_of_it_slides_from_three_times_friction_over_stiffness_on(capacity):
    full = 3.0 * capacity / 30000.0
    assert demand(full, capacity, 30000.0) == pytest.approx(1.0)
    assert brush_force((0.0, 1.001 * full), 1.0, capacity, STIFFNESS)[1] == capacity
    assert brush_force((0.0, 0.99 * full), 1.0, capacity, STIFFNESS)[1] < capacity
    assert brush_force((0.0, full), 1.0, capacity, STIFFNESS)[1] == pytest.approx(capacity, rel=1e-9)


def patch_force(slip, capacity):
    """Sum up the bristles of a patch of length 1: each sticks, or slides along the slip, under its pressure."""
    stiffness = tuple(2.0 * c for c in STIFFNESS)  # of the bristles, per length of the patch and of stretch
    size = math.hypot(*slip)

    def stress(place):
        return math.hypot(stiffness[0] * slip[0] * place, stiffness[1] * slip[1] * place)

    def limit(place):
        return 6.0 * capacity * place * (1.0 - place)

    def breaks_away(place):
        return stress(place) - limit(place)

    # Both vanish at the front edge; friction holds up to where they meet again.
    middle = 1.0 - math.hypot(stiffness[0] * slip[0], stiffness[1] * slip[1]) / (6.0 * capacity)
    edge = brentq(breaks_away, 0.5 * middle, 1.0, xtol=1e-14) if middle > 1e-3 else 0.0
    total = []
    for i in range(2):
        sticks = quad(lambda place, i=i: stiffness[i] * slip[i] * place, 0.0, edge)[0]
        slides = quad(lambda place, i=i: limit(place) * slip[i] / size, edge, 1.0)[0]
        total.append(sticks + slides)
    return tuple(total)


@quiet
@given(st.floats(-0.6, 0.6), st.floats(-0.6, 0.6), st.floats(1000.0, 8000.0))
def test_combined_forces_are_those_of_the_bristles(slip_long, slip_lat, capacity):
    if math.hypot(slip_long, slip_lat) < 1e-6:
        return
    found = brush_force((slip_long, slip_lat), 1.0, capacity, STIFFNESS)
    assert found == pytest.approx(patch_force((slip_long, slip_lat), capacity), rel=1e-6, abs=1e-5 * capacity)


@quiet
@given(st.floats(-math.pi, math.pi), st.floats(0.001, 1.0), capacities)
def test_a_tyre_equal_in_both_directions_pulls_along_its_slip(direction, size, capacity):
    slip = size * math.cos(direction), size * math.sin(direction)
    force = brush_force(slip, 1.0, capacity, ROUND)
    straight = brush_force((0.0, size), 1.0, capacity, ROUND)[1]
    assert force == pytest.approx((straight * math.cos(direction), straight * math.sin(direction)), abs=1e-9 * capacity)
