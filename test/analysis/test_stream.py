"""The reducers of a stream: any samples, split in any way."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as numpy_st

from omni_vehicle_ros.analysis.stream.envelope import Envelope
from omni_vehicle_ros.analysis.stream.join import Join
from omni_vehicle_ros.analysis.stream.path import Samples
from omni_vehicle_ros.analysis.stream.statistics import Quantiles, RunningStatistics

signals = numpy_st.arrays(np.float64, st.integers(1, 400), elements=st.floats(-1e6, 1e6))
splits = st.lists(st.integers(0, 400), max_size=5)


def pieces(split: list[int], *arrays: np.ndarray) -> list[tuple[np.ndarray, ...]]:
    edges = sorted({0, len(arrays[0]), *(edge for edge in split if edge < len(arrays[0]))})
    return [tuple(array[a:b] for array in arrays) for a, b in pairwise(edges)]


@settings(deadline=None, max_examples=60)
@given(signals, splits, st.integers(1, 10**10))
def test_an_envelope_keeps_samples_and_extremes(signal: np.ndarray, split: list[int], period: int) -> None:
    times = np.arange(len(signal)) * period
    envelope = Envelope(1, 32)
    for some, values in pieces(split, times, signal[:, np.newaxis]):
        envelope.add(some, values)
    when, what = envelope.line(0)
    assert len(when) <= 64
    assert (what.min(), what.max()) == (signal.min(), signal.max())
    assert np.all(np.diff(when) >= 0.0)
    rows = np.rint(when * 1e9 / period).astype(int)
    np.testing.assert_array_equal(signal[rows], what)


@settings(deadline=None, max_examples=60)
@given(signals, splits)
def test_running_statistics_are_those_of_the_whole(signal: np.ndarray, split: list[int]) -> None:
    statistics = RunningStatistics(1)
    for times, values in pieces(split, np.arange(len(signal)), signal[:, np.newaxis]):
        statistics.add(times, values)
    found = statistics.figures(0)
    scale = float(np.max(np.abs(signal)))
    assert found['count'] == len(signal)
    assert found['mean'] == pytest.approx(np.mean(signal), rel=1e-9, abs=1e-12 * scale)
    assert found['deviation'] == pytest.approx(np.std(signal), rel=1e-9, abs=1e-8 * scale)
    assert (found['minimum'], found['maximum']) == (signal.min(), signal.max())
    assert found['maximum_at'] == np.argmax(signal) * 1e-9


@settings(deadline=None, max_examples=40)
@given(numpy_st.arrays(np.float64, st.integers(1, 300), elements=st.floats(1e-6, 10.0)), st.floats(0.01, 1.0))
def test_quantiles_are_right_to_the_width_of_a_bin(values: np.ndarray, share: float) -> None:
    quantiles = Quantiles()
    quantiles.add(values)
    exact = float(np.quantile(values, share, method='inverted_cdf'))
    assert exact <= quantiles.quantile(share) * (1.0 + 1e-9)
    assert quantiles.quantile(share) <= exact * 10.0 ** (1.0 / 200.0) * (1.0 + 1e-9)


@settings(deadline=None, max_examples=40)
@given(st.lists(st.integers(0, 200), min_size=1, max_size=60), st.lists(st.integers(0, 200), max_size=60), splits)
def test_a_join_gives_each_row_what_was_said_last(rows: list[int], said: list[int], split: list[int]) -> None:
    times, other_times = np.sort(np.array(rows)), np.sort(np.array(said, dtype=np.int64))
    taken: list[tuple[int, float]] = []
    join = Join((1,), lambda when, _, beside: taken.extend(zip(when.tolist(), beside[:, 0].tolist(), strict=True)))
    for some in pieces(split, times, times[:, np.newaxis].astype(float)):
        join.add(*some)
        known = other_times[other_times <= some[0][-1]]
        if len(known):
            join.add_other(0, known, known[:, np.newaxis].astype(float))
            other_times = other_times[len(known) :]
    join.finish()
    assert [when for when, _ in taken] == times.tolist()
    for when, value in taken:
        before = [time for time in said if time <= when]
        assert value == max(before) if before else np.isnan(value)


def test_samples_of_topics_with_the_same_stamps_stay_together() -> None:
    times = np.arange(10_000) * 5_000_000
    one, other = Samples(1, 100), Samples(1, 100)
    one.add(times, times[:, np.newaxis].astype(float))
    for begin in range(0, 10_000, 37):
        other.add(times[begin : begin + 37], times[begin : begin + 37, np.newaxis].astype(float))
    np.testing.assert_array_equal(one.times, other.times)
    assert 50 <= len(one.times) <= 100
