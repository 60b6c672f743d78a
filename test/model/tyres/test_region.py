"""The regions in which a tyre works, for every tyre."""

import math

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from omni_vehicle_ros.model.constants import BRUSH, DUGOFF, constants
from omni_vehicle_ros.model.tyres.dugoff import first_critical_slip, second_critical_slip
from omni_vehicle_ros.model.tyres.force import side_force
from omni_vehicle_ros.model.tyres.region import Region, region
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
