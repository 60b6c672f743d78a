import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as numpy_st

from omni_vehicle_ros.analysis.signals import StepMetrics, overshoot, peak, settling_time, steady_state, step_metrics

STEP = 1e-3
FLOOR = 1e-9


def second_order(damping: float, frequency: float, duration: float, start: float = 0.0, final: float = 1.0):
    """The step response of a second-order system, from its closed form (Ogata, Modern Control Engineering, 5.3)."""
    time = np.arange(round(duration / STEP) + 1) * STEP
    damped = frequency * math.sqrt(1.0 - damping**2)
    phase = damped * time
    decay = np.exp(-damping * frequency * time)
    unit = 1.0 - decay * (np.cos(phase) + damping / math.sqrt(1.0 - damping**2) * np.sin(phase))
    return time, start + (final - start) * unit


@pytest.mark.parametrize('damping', [0.2, 0.4, 0.6, 0.8])
@pytest.mark.parametrize('final', [1.0, -0.05])
def test_the_overshoot_of_a_second_order_system(damping: float, final: float) -> None:
    time, signal = second_order(damping, 8.0, 10.0, final=final)
    metrics = step_metrics(time, signal, FLOOR)
    assert metrics.steady_state == pytest.approx(final, rel=1e-4)
    expected = math.exp(-math.pi * damping / math.sqrt(1.0 - damping**2))
    assert metrics.overshoot == pytest.approx(expected, abs=2e-4)
    assert metrics.peak == pytest.approx(final * (1.0 + expected), rel=2e-4)


@pytest.mark.parametrize('start', [5.0, -3.0])
def test_the_far_side_is_the_one_away_from_the_start(start: float) -> None:
    time, signal = second_order(0.5, 8.0, 10.0, start=start)
    signal[0] = 0.0
    expected = math.exp(-math.pi * 0.5 / math.sqrt(0.75)) * abs(start - 1.0)
    assert step_metrics(time, signal, FLOOR).overshoot == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize('time_constant', [0.1, 0.5, 1.0])
def test_a_first_order_system_settles_after_ln_50_time_constants(time_constant: float) -> None:
    time = np.arange(20001) * STEP
    metrics = step_metrics(time, 1.0 - np.exp(-time / time_constant), FLOOR)
    assert metrics.settling_time == pytest.approx(time_constant * math.log(50.0), abs=2 * STEP)
    assert metrics.overshoot == pytest.approx(0.0, abs=1e-6)


def test_settling_of_an_oscillation_against_its_envelope() -> None:
    damping, frequency = 0.1, 20.0
    time, signal = second_order(damping, frequency, 12.0)
    envelope = math.log(50.0 / math.sqrt(1.0 - damping**2)) / (damping * frequency)
    settling = step_metrics(time, signal, FLOOR).settling_time
    assert envelope - math.pi / frequency <= settling <= envelope


def test_the_first_sample_is_from_before_the_step() -> None:
    time = np.arange(3001) * STEP
    signal = 1.0 + np.exp(-time / 0.1)
    signal[0] = -100.0
    metrics = step_metrics(time, signal, FLOOR)
    assert metrics.peak == pytest.approx(2.0, rel=0.02)
    assert metrics.overshoot == pytest.approx(0.0, abs=1e-6)


def test_a_constant_signal_is_settled_at_once() -> None:
    time = np.arange(201) * 0.01
    assert step_metrics(time, np.full(201, 3.0), FLOOR) == StepMetrics(3.0, 3.0, 0.0, 0.0)


@pytest.mark.parametrize(
    'signal',
    [
        lambda t: t,
        lambda t: np.exp(0.5 * t),
        lambda t: np.sin(10.0 * t),
        lambda t: 1.0 + 0.03 * np.sin(20.0 * t),
        lambda t: np.where(t > 4.99, np.nan, 1.0),
        lambda t: np.where(t > 4.99, np.inf, 1.0),
    ],
    ids=['ramp', 'growth', 'oscillation', 'ripple', 'nan', 'inf'],
)
def test_what_has_not_settled_has_no_steady_state(signal) -> None:
    time = np.arange(5001) * STEP
    metrics = step_metrics(time, signal(time), FLOOR)
    assert metrics.steady_state is None
    assert metrics.overshoot is None
    assert metrics.settling_time is None


def test_the_band_of_a_settled_signal_is_2_percent_in_all() -> None:
    time = np.arange(2001) * STEP
    wave = np.sin(40.0 * math.pi * time)
    assert steady_state(time, 1.0 + 0.0099 * wave, FLOOR) == pytest.approx(1.0, abs=1e-4)
    assert steady_state(time, 1.0 + 0.0101 * wave, FLOOR) is None
    assert steady_state(time, 1.0 + 0.0101 * wave, 0.03) is not None


def test_less_than_a_second_is_never_steady() -> None:
    time = np.arange(100) * 0.01
    assert steady_state(time, np.ones(100), FLOOR) is None
    assert steady_state(time[:1], np.ones(1), FLOOR) is None


def test_what_returns_to_zero_has_a_settling_time_but_no_relative_overshoot() -> None:
    time = np.arange(10001) * STEP
    metrics = step_metrics(time, np.where(time < 2.0, 0.5, 0.0), 1e-5)
    assert metrics == StepMetrics(0.0, 0.5, None, pytest.approx(2.0 - STEP))


VALUES = st.floats(-1e12, 1e12) | st.sampled_from([math.nan, math.inf, -math.inf, 0.0, 1e-300])


@settings(deadline=None, max_examples=200)
@given(numpy_st.arrays(np.float64, st.integers(0, 40), elements=VALUES), st.floats(1e-9, 1.0), st.booleans())
def test_no_figure_is_ever_nan(signal: np.ndarray, floor: float, settled: bool) -> None:
    metrics = step_metrics(np.arange(len(signal)) * 0.1, signal, floor, settled)
    assert all(value is None or math.isfinite(value) for value in metrics)


@settings(deadline=None, max_examples=100)
@given(
    st.floats(0.1, 0.9), st.floats(-5.0, 5.0), st.floats(-5.0, 5.0), st.floats(1e-3, 1e3)
)
def test_figures_scale_with_the_signal(damping: float, start: float, final: float, scale: float) -> None:
    time, signal = second_order(damping, 20.0, 6.0, start=start, final=final)
    if abs(final) < 1e-2:
        return
    plain, scaled = step_metrics(time, signal, 1e-9), step_metrics(time, -scale * signal, 1e-9 * scale)
    if plain.steady_state is None:
        return
    assert scaled.steady_state == pytest.approx(-scale * plain.steady_state)
    assert scaled.peak == pytest.approx(-scale * plain.peak)
    assert scaled.overshoot == pytest.approx(plain.overshoot, abs=1e-9)
    assert scaled.settling_time == pytest.approx(plain.settling_time, abs=STEP)


def test_parts_by_hand() -> None:
    time, signal = np.arange(5) * 1.0, np.array([9.0, 0.0, 3.0, 1.0, 2.0])
    assert peak(signal) == 3.0
    assert overshoot(signal, 2.0) == 0.5
    assert settling_time(time, signal, 2.0, 0.0) == 3.0
    assert settling_time(time, signal, 2.0, 1.0) == 1.0
