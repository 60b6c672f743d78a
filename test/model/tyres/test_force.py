"""What every tyre has in common, behind the one interface."""

import math

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from omni_vehicle_ros.model.constants import BRUSH, DUGOFF, LUGRE, MAGIC_FORMULA, constants
from omni_vehicle_ros.model.tyres.force import side_force, tyre_force
from omni_vehicle_ros.parameters import TYRE_MODELS, VehicleParameters

quiet = settings(
    deadline=None, max_examples=60, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
speeds = st.floats(-40.0, 40.0)
anything = st.floats(-1e6, 1e6)
capacities = st.floats(0.0, 8000.0)


def rolling(tyre, slip, capacity=3000.0, speed=10.0):
    """Side force of a wheel that rolls at a speed with tan(alpha) = slip."""
    return side_force(slip * speed, speed, slip * speed, capacity, tyre)


def test_each_name_stands_for_its_law():
    codes = [constants(VehicleParameters(tyre_model=name)).tyre_model for name in TYRE_MODELS]
    assert codes == [DUGOFF, BRUSH, MAGIC_FORMULA, LUGRE]
    assert TYRE_MODELS == ('dugoff', 'brush', 'magic_formula', 'lugre')


def test_all_tyres_have_the_same_slopes_at_no_slip(tyre):
    slip = 1e-7
    assert rolling(tyre, slip) == pytest.approx(30000.0 * slip, rel=1e-5)
    assert tyre_force(10.0 * (1.0 + slip), 10.0, 0.0, 3000.0, tyre)[0] == pytest.approx(50000.0 * slip, rel=1e-5)
    assert tyre_force(10.0 * (1.0 - slip), 10.0, 0.0, 3000.0, tyre)[0] == pytest.approx(-50000.0 * slip, rel=1e-5)


@quiet
@given(speeds, speeds, capacities)
def test_side_force_is_the_force_of_a_rim_as_fast_as_the_contact(tyre, v_long, v_lat, capacity):
    along, across = tyre_force(v_long, v_long, v_lat, capacity, tyre)
    assert along == 0.0
    assert across == pytest.approx(side_force(-v_lat, abs(v_long), v_lat, capacity, tyre), rel=1e-12, abs=1e-9)


@quiet
@given(anything, anything, anything, capacities)
@example(0.0, 0.0, 0.0, 3000.0)
@example(3.0, 0.0, 0.0, 3000.0)
@example(0.0, 3.0, 0.0, 3000.0)
@example(0.0, 0.0, 3.0, 3000.0)
@example(5.0, -5.0, 0.0, 3000.0)
@example(1e-300, 1e-300, 1e-300, 3000.0)
def test_friction_is_never_exceeded_and_only_takes_energy(tyre, rim_speed, v_long, v_lat, capacity):
    along, across = tyre_force(rim_speed, v_long, v_lat, capacity, tyre)
    assert math.hypot(along, across) <= capacity * (1.0 + 1e-12)
    assert along * (rim_speed - v_long) >= 0.0
    assert across * -v_lat >= 0.0


@quiet
@given(speeds, speeds, speeds, capacities)
def test_left_and_right_and_forward_and_backward_are_mirror_images(tyre, rim_speed, v_long, v_lat, capacity):
    along, across = tyre_force(rim_speed, v_long, v_lat, capacity, tyre)
    assert tyre_force(rim_speed, v_long, -v_lat, capacity, tyre) == (along, -across)
    assert tyre_force(-rim_speed, -v_long, v_lat, capacity, tyre) == (-along, across)


@quiet
@given(st.floats(-1.0, 1.0), speeds, st.floats(0.1, 10.0))
def test_only_the_proportion_counts_and_not_how_fast_it_rolls(tyre, slip, speed, scale):
    """But for the friction, which depends on the speed of sliding."""
    force = side_force(slip, 1.0, speed, 3000.0, tyre)
    assert side_force(scale * slip, scale, speed, 3000.0, tyre) == pytest.approx(force, rel=1e-12, abs=1e-9)


@pytest.mark.parametrize('capacity', [300.0, 3000.0, 8000.0])
def test_the_side_force_rises_to_one_peak_and_then_never_again(tyre, capacity):
    forces = np.array([rolling(tyre, slip, capacity) for slip in np.tan(np.linspace(0.0, math.atan(2.5), 600))])
    top = int(forces.argmax())
    assert (np.diff(forces[: top + 1]) > 0.0).all()
    assert (np.diff(forces[top:]) <= 1e-9 * capacity).all()


def test_a_tyre_dragged_sideways_or_locked_has_the_same_sliding_friction(tyre):
    dragged = tyre_force(0.0, 0.0, -4.0, 3000.0, tyre)
    locked = tyre_force(0.0, 4.0, 0.0, 3000.0, tyre)
    assert dragged[0] == locked[1] == 0.0
    assert dragged[1] > 2000.0
    assert locked[0] == pytest.approx(-dragged[1], rel=1e-12)


def test_no_load_or_no_slip_is_no_force(tyre):
    assert tyre_force(8.0, 7.0, 1.0, 0.0, tyre) == (0.0, 0.0)
    assert tyre_force(7.0, 7.0, 0.0, 3000.0, tyre) == (0.0, 0.0)
    assert tyre_force(0.0, 0.0, 0.0, 3000.0, tyre) == (0.0, 0.0)


def test_a_brake_costs_side_force(tyre):
    free = tyre_force(10.0, 10.0, -1.0, 3000.0, tyre)[1]
    braked = [tyre_force(10.0 * (1.0 - slip), 10.0, -1.0, 3000.0, tyre)[1] for slip in (0.05, 0.1, 0.3, 1.0)]
    assert [free, *braked] == sorted([free, *braked], reverse=True)
    assert braked[-1] < 0.5 * free


@quiet
@given(st.floats(500.0, 8000.0), st.floats(5e3, 2e5))
def test_full_stretch_is_at_seven_eighths_of_the_grip(tyre, capacity, stiffness):
    tyre = tyre._replace(cornering_stiffness=stiffness)
    force = side_force(tyre.full_stretch * capacity / stiffness, 1.0, 0.0, capacity, tyre)
    assert force == pytest.approx(0.875 * capacity, rel=1e-4)
