"""Slip angles from velocities, and the friction circle."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omni_vehicle_ros.model.tyres.friction_circle import lateral_capacity, limited_drive_force
from omni_vehicle_ros.model.tyres.slip import side_slip_angle, slip_ratio

quiet = settings(deadline=None, max_examples=60, derandomize=True)
capacities = st.floats(100.0, 8000.0)


@quiet
@given(capacities, st.floats(-2.0, 2.0))
def test_friction_circle(capacity, share):
    traction = limited_drive_force(share * capacity, capacity)
    assert math.hypot(traction, lateral_capacity(capacity, traction)) == pytest.approx(capacity)
    assert lateral_capacity(capacity, 1.1 * capacity) == 0.0


def test_side_slip_angle_is_folded_and_defined_at_rest():
    assert side_slip_angle(1.0, -1.0) == pytest.approx(math.pi / 4)
    assert side_slip_angle(-1.0, -1.0) == pytest.approx(math.pi / 4)
    assert side_slip_angle(0.0, 0.0) == 0.0


@quiet
@given(st.floats(-1e3, 1e3), st.floats(-1e3, 1e3))
def test_slip_ratio_is_that_of_driving_or_of_braking(rim_speed, v_long):
    ratio = slip_ratio(rim_speed, v_long)
    assert -2.0 <= ratio <= 2.0
    if rim_speed > v_long > 0.0:
        assert ratio == pytest.approx(1.0 - v_long / rim_speed)
    if v_long > rim_speed > 0.0:
        assert ratio == pytest.approx(rim_speed / v_long - 1.0)
    assert slip_ratio(0.0, 0.0) == 0.0
