"""What all controllers share: the time between cycles, the fading at low speed, what counts as a number."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omni_vehicle_ros.control.controllers import make_controller
from omni_vehicle_ros.control.health import ERROR, OK
from omni_vehicle_ros.control.trim import NO_TRIMS, Cycles, Sensed, fade
from omni_vehicle_ros.model.kinematics import Twist
from omni_vehicle_ros.parameters import SideSlipParameters, VehicleParameters

VEHICLE = VehicleParameters()
STEP = 5_000_000
MOVING = ('yaw_moment', 'rear_steering', 'allocation')
TURN = Twist(4.0, 0.0, 0.8)
SLIPS, ANGLES, TORQUES = (0.05, 0.03, 0.03, 0.02), (0.2, 0.15, -0.3, -0.2), (20.0,) * 4
DRIVING = Sensed(SLIPS, (4.0,) * 4, ANGLES, TORQUES, Twist(4.0, 0.1, 0.7), 3.0, TURN)
any_float = st.one_of(st.floats(-30.0, 30.0), st.floats(allow_nan=True, allow_infinity=True))
four = st.tuples(*[any_float] * 4)
twists = st.builds(Twist, any_float, any_float, any_float)


def controller(name, **values):
    return make_controller(SideSlipParameters(controller=name, **values), VEHICLE)


def test_cycles_tell_the_time_since_the_last_one():
    cycles = Cycles()
    assert [cycles.next(stamp) for stamp in (STEP, 2 * STEP, 2 * STEP, STEP)] == [0.0, 0.005, None, 0.0]
    assert cycles.next(STEP + 600_000_000) == 0.0


@pytest.mark.parametrize('speed, share', [(0.0, 0.0), (0.5, 0.0), (0.75, 0.5), (-0.75, 0.5), (1.0, 1.0), (-9.0, 1.0)])
def test_fading(speed, share):
    assert fade(speed, 1.0) == share


@pytest.mark.parametrize('name', MOVING)
@pytest.mark.parametrize('bad', [math.nan, math.inf, 1e9])
def test_no_number_keeps_the_last_trims_and_says_so(name, bad):
    law = controller(name)
    before = law.update(0, DRIVING)
    assert before != NO_TRIMS
    assert law.update(STEP, DRIVING._replace(twist=Twist(bad, 0.0, 0.0))) == before
    assert law.status.level == ERROR
    assert 'finite' in law.status.message
    law.update(2 * STEP, DRIVING)
    assert law.status.level == OK


@pytest.mark.parametrize('name', MOVING)
def test_same_stamp_same_answer(name):
    law = controller(name)
    first = law.update(0, DRIVING)
    assert law.update(0, Sensed()) == first


@pytest.mark.parametrize('name', MOVING)
@pytest.mark.parametrize('jump', [-STEP, 3_000_000_000])
def test_a_clock_that_jumps_starts_anew(name, jump):
    law = controller(name)
    fresh = controller(name).update(0, DRIVING)
    for k in range(100):
        law.update(k * STEP, DRIVING)
    again = law.update(99 * STEP + jump, DRIVING)
    assert again.steer_angle == pytest.approx(fresh.steer_angle, abs=1e-9)
    assert again.torque == pytest.approx(fresh.torque, abs=1e-4)


@pytest.mark.parametrize('name', MOVING)
@pytest.mark.parametrize(
    'commanded, measured',
    [
        (Twist(0.0, 0.0, 0.0), Twist(0.0, 0.0, 0.0)),
        (Twist(0.0, 0.0, 0.8), Twist(0.0, 0.0, 0.8)),
        (Twist(0.0, 0.0, 0.0), Twist(2.0, 0.1, 0.3)),
        (Twist(1.0, 0.0, 0.2), Twist(0.4, 0.0, 0.1)),
        (Twist(2.0, 0.0, 0.4), Twist(-2.0, 0.0, 0.0)),
    ],
    ids=['standing', 'spinning in place', 'told to stand', 'slow', 'rolling the other way'],
)
def test_no_trim_without_a_course(name, commanded, measured):
    law = controller(name)
    law.update(0, DRIVING)
    assert law.update(STEP, DRIVING._replace(commanded=commanded, twist=measured)) == NO_TRIMS
    assert law.status.level == OK


@pytest.mark.parametrize('name', MOVING)
def test_half_the_trims_at_three_quarters_of_the_minimum_speed(name):
    # What is fast enough for one controller is three quarters of that for the other; all else is the same.
    whole, half = controller(name, minimum_speed=4.0), controller(name, minimum_speed=4.0 / 0.75)
    full, less = whole.update(0, DRIVING), half.update(0, DRIVING)
    assert less.steer_angle == pytest.approx([0.5 * trim for trim in full.steer_angle])
    assert less.torque == pytest.approx([0.5 * trim for trim in full.torque])


@pytest.mark.parametrize('name', MOVING)
@settings(deadline=None, max_examples=60)
@given(
    st.lists(
        st.tuples(
            st.integers(-(2**40), 2**60), st.builds(Sensed, four, four, four, four, twists, any_float, twists)
        ),
        min_size=1,
        max_size=6,
    )
)
def test_trims_are_finite_and_limited_whatever_comes(name, inputs):
    law = controller(name)
    for stamp, sensed in inputs:
        trims = law.update(stamp, sensed)
        assert all(map(math.isfinite, (*trims.steer_angle, *trims.torque)))
        assert max(map(abs, trims.steer_angle)) <= 0.5
