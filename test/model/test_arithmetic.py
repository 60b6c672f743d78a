"""Functions that work in all lanes, beside those of Python's library."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omni_vehicle_ros.model.arithmetic import LARGEST_ANGLE, cos_sin, norm, positive

quiet = settings(deadline=None, max_examples=500, derandomize=True)
numbers = st.floats(-1e300, 1e300)


@quiet
@given(st.floats(-4.0, 4.0) | st.floats(-LARGEST_ANGLE, LARGEST_ANGLE) | st.floats(-1e300, 1e300))
def test_cosine_and_sine_are_those_of_the_library_to_a_unit_in_the_last_place(angle):
    for found, wanted in zip(cos_sin(angle), (math.cos(angle), math.sin(angle)), strict=True):
        assert abs(found - wanted) <= math.ulp(wanted)


@pytest.mark.parametrize('quarter', range(-9, 10))
def test_cosine_and_sine_hold_around_multiples_of_a_right_angle(quarter):
    for angle in (quarter * 0.5 * math.pi + offset for offset in (-1e-9, 0.0, 1e-9)):
        cos, sin = cos_sin(angle)
        assert cos == pytest.approx(math.cos(angle), rel=2.3e-16, abs=1e-24)
        assert sin == pytest.approx(math.sin(angle), rel=2.3e-16, abs=1e-24)


@quiet
@given(numbers, numbers)
def test_the_length_of_a_vector_is_that_of_the_library(x, y):
    assert norm(x, y) == pytest.approx(math.hypot(x, y), rel=1e-15, abs=0.0)


def test_the_length_of_a_tiny_vector_is_not_lost():
    assert norm(3e-300, 4e-300) == pytest.approx(5e-300, rel=1e-15, abs=0.0)
    assert norm(0.0, 0.0) == 0.0


@quiet
@given(numbers)
def test_a_positive_number_is_kept_and_any_other_is_one(number):
    assert positive(number) == (number if number > 0.0 else 1.0)
