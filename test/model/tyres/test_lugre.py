"""The averaged LuGre tyre: closed form, lumped model and distributed model are one in steady state."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import simpson, solve_ivp

from omni_vehicle_ros.model.tyres.lugre import bristle_rate, lugre_force, past_peak, patch_share, stribeck

quiet = settings(deadline=None, max_examples=25, derandomize=True)
STIFFNESS = (50000.0, 30000.0)
SHARE, SPEED = 0.5556, 12.5
LENGTH = 0.2
slips = st.floats(-6.0, 6.0)
rolls = st.floats(0.5, 30.0)
capacities = st.floats(300.0, 8000.0)


def force(slip, rolling, capacity):
    return lugre_force(slip, rolling, math.hypot(*slip), capacity, STIFFNESS, SHARE, SPEED)


def distributed_force(slip, rolling, capacity):
    """Carry bristles through the patch, dz/dzeta = (v_r - k norm(v_r) / limit z) / rolling; add them up."""
    speed = math.hypot(*slip)
    limit = capacity * stribeck(speed, SHARE, SPEED)
    places = np.linspace(0.0, LENGTH, 4001)
    forces = []
    for v, stiffness in zip(slip, STIFFNESS, strict=True):
        bristle = 2.0 * stiffness / LENGTH
        carried = solve_ivp(
            lambda place, z, v=v, k=bristle: (v - k * speed / limit * z) / rolling,
            (0.0, LENGTH), [0.0], t_eval=places, method='Radau', rtol=1e-8, atol=1e-12,
        )  # fmt: skip
        forces.append(bristle * simpson(carried.y[0], x=places) / LENGTH)
    return tuple(forces)


@quiet
@given(slips, slips, rolls, capacities)
def test_closed_form_is_the_distributed_model(v_long, v_lat, rolling, capacity):
    expected = distributed_force((v_long, v_lat), rolling, capacity)
    assert force((v_long, v_lat), rolling, capacity) == pytest.approx(expected, rel=1e-4, abs=1e-5 * capacity)


@quiet
@given(slips, slips, rolls, capacities, st.floats(0.05, 0.4))
def test_the_lumped_model_comes_to_rest_at_the_closed_form(v_long, v_lat, rolling, capacity, length):
    speed = math.hypot(v_long, v_lat)
    limit = capacity * stribeck(speed, SHARE, SPEED)
    settled = []
    for v, stiffness in zip((v_long, v_lat), STIFFNESS, strict=True):
        bristle = 2.0 * stiffness / length
        end = solve_ivp(
            lambda time, z, v=v, c=stiffness: [bristle_rate(z[0], v, speed, rolling, c, limit, length)],
            (0.0, 40.0 * length / rolling), [0.0], method='Radau', rtol=1e-9, atol=1e-14,
        ).y[0, -1]  # fmt: skip
        settled.append(bristle * end)
    assert force((v_long, v_lat), rolling, capacity) == pytest.approx(tuple(settled), rel=1e-6, abs=1e-9 * capacity)


def test_bristles_that_stick_relax_over_half_a_patch():
    """At little slip the mean deflection decays with the rate 2 rolling / L: a relaxation length of L / 2."""
    rate = bristle_rate(1e-4, 0.0, 0.0, 5.0, 30000.0, 3000.0, LENGTH)
    assert rate == pytest.approx(-2.0 * 5.0 / LENGTH * 1e-4)


def test_a_locked_wheel_is_a_lugre_block_on_the_road():
    """Without rolling it is the model of Canudas de Wit et al. 1995: dz/dt = v - k abs(v) / limit z."""
    limit, stiffness, v = 2500.0, 30000.0, 0.7
    bristle = 2.0 * stiffness / LENGTH
    assert bristle_rate(0.002, v, v, 0.0, stiffness, limit, LENGTH) == pytest.approx(v - bristle * v / limit * 0.002)


@quiet
@given(st.floats(0.01, 100.0), capacities)
def test_a_sliding_tyre_has_the_friction_of_stribeck(speed, capacity):
    limit = capacity * (SHARE + (1.0 - SHARE) * math.exp(-speed / SPEED))
    assert force((0.0, speed), 0.0, capacity)[1] == pytest.approx(limit)
    assert force((-speed, 0.0), 0.0, capacity)[0] == pytest.approx(-limit)
    assert math.hypot(*force((speed, speed), 2.0, capacity)) <= capacity * stribeck(1.4142 * speed, SHARE, SPEED)


def test_the_stribeck_curve_falls_from_static_to_sliding_friction():
    assert stribeck(0.0, SHARE, SPEED) == 1.0
    assert stribeck(SPEED, SHARE, SPEED) == pytest.approx(SHARE + (1.0 - SHARE) / math.e)
    assert stribeck(1e6, SHARE, SPEED) == pytest.approx(SHARE, abs=1e-9)
    assert stribeck(5.0, 1.0, SPEED) == 1.0


@quiet
@given(st.floats(1e-9, 1e4))
def test_patch_share_keeps_its_digits(x):
    """Against the mean of 1 - exp(-x place) over the patch, by Gauss's rule."""
    nodes, weights = np.polynomial.legendre.leggauss(60)
    if x < 50.0:
        mean = float(weights @ -np.expm1(-x * 0.5 * (nodes + 1.0))) * 0.5
        assert patch_share(x, 1.0) == pytest.approx(mean, rel=1e-12)
    assert patch_share(3.0 * x, 3.0) == pytest.approx(patch_share(x, 1.0), rel=1e-12)
    assert 0.0 < patch_share(x, 1.0) < 1.0


def test_patch_share_has_no_seam():
    for seam in (0.02, 700.0):
        assert patch_share(seam * (1.0 - 1e-12), 1.0) == pytest.approx(patch_share(seam, 1.0), rel=1e-11)


@quiet
@given(st.floats(0.01, 2.0), st.floats(0.5, 12.0), st.floats(500.0, 8000.0))
def test_past_the_peak_is_where_the_slope_is_negative(slip, speed, capacity):
    def side(value):
        return force((0.0, value * speed), speed, capacity)[1]

    slope = side(slip * (1.0 + 1e-5)) - side(slip * (1.0 - 1e-5))
    if abs(slope) > 1e-8 * capacity:
        assert past_peak(slip, speed, capacity, 30000.0, SHARE, SPEED) is (slope < 0.0)


@quiet
@given(st.floats(5.0, 40.0), st.floats(500.0, 8000.0))
def test_far_out_is_past_the_peak_as_well(speed, capacity):
    slips = np.geomspace(1e-3, 1e3, 4000)
    forces = [force((0.0, s * speed), speed, capacity)[1] for s in slips]
    top = int(np.argmax(forces))
    found = [past_peak(s, speed, capacity, 30000.0, SHARE, SPEED) for s in slips]
    assert found.index(True) == pytest.approx(top, abs=2)
    assert all(found[top + 2 :])


def test_without_a_stribeck_curve_the_force_never_falls():
    forces = [lugre_force((0.0, s), 5.0, s, 3000.0, STIFFNESS, 1.0, SPEED)[1] for s in np.linspace(0.1, 50.0, 100)]
    assert forces == sorted(forces)
    assert not past_peak(2.0, 20.0, 3000.0, 30000.0, 1.0, SPEED)
