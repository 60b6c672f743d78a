"""Answers by the wall clock: late ones, missed cycles and ticks, percentiles."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from omni_vehicle_ros.components.punctuality import BINS, PERIODS, Histogram, Punctuality

PERIOD = 0.005
STEP = 5_000_000
TOPICS = ('a', 'b')


def drive(delays: list[tuple[float, float]], skipped: int = 0) -> Punctuality:
    """Return what is found if both answer each tick after their delays; some ticks don't come before the last one."""
    found = Punctuality(TOPICS, PERIOD)
    events = []
    for cycle, pair in enumerate(delays):
        wall = (cycle + (skipped if cycle == len(delays) - 1 else 0)) * PERIOD
        events.append((wall, 0, '', cycle * STEP))
        events += [(wall + delay, 1, topic, cycle * STEP) for topic, delay in zip(TOPICS, pair, strict=True)]
    for wall, _, topic, stamp in sorted(events):
        if topic:
            found.answer(topic, stamp, wall)
        else:
            found.tick(stamp, wall)
    return found


def test_punctual_answers_miss_nothing_and_have_no_jitter():
    figures = drive([(0.001, 0.002)] * 100).figures()
    assert (figures['cycles'], figures['missed']) == (99, 0)
    assert figures['answer']['largest'] == pytest.approx(0.002)
    assert figures['jitter']['largest'] == pytest.approx(0.0, abs=1e-12)


def test_an_answer_after_the_next_tick_is_a_missed_cycle_and_timed_nevertheless():
    delays = [(0.001, 0.001)] * 100
    delays[50:52] = (0.001, 1.5 * PERIOD), (0.001, 0.6 * PERIOD)
    figures = drive(delays).figures()
    assert figures['missed'] == 1
    assert figures['answer']['largest'] == pytest.approx(1.5 * PERIOD)
    assert figures['jitter']['largest'] == pytest.approx(1.5 * PERIOD - 0.001)


def test_ticks_that_do_not_come_are_missed():
    assert drive([(0.001, 0.001)] * 100, skipped=3).missed == 3


def test_nothing_counts_before_all_have_answered():
    found = Punctuality(TOPICS, PERIOD)
    for cycle in range(100):
        found.tick(cycle * STEP, cycle * PERIOD)
        found.answer('a', cycle * STEP, cycle * PERIOD + 0.001)
    assert found.figures() == {'period': PERIOD, 'cycles': 0, 'missed': 0, 'answer': None, 'jitter': None}


def test_an_answer_from_before_its_tick_is_of_another_vehicle():
    found = Punctuality(TOPICS, PERIOD)
    found.tick(0, 10.0)
    for topic in TOPICS:
        found.answer(topic, 0, 9.0)
    found.tick(STEP, 10.0 + PERIOD)
    assert found.figures()['cycles'] == 0 and found.figures()['answer'] is None


@given(st.lists(st.floats(0.0, 2.0 * PERIODS * PERIOD), min_size=1, max_size=200))
def test_percentiles_are_those_of_the_times_to_a_bin(times):
    histogram = Histogram(PERIOD)
    for time in times:
        histogram.add(time)
    spread = histogram.spread()
    assert spread.largest == max(times)
    width, ordered = PERIOD * PERIODS / BINS, np.minimum(np.sort(times), PERIOD * PERIODS)
    for share, found in ((0.5, spread.p50), (0.99, spread.p99)):
        exact = ordered[int(np.ceil(share * len(times))) - 1]
        assert exact - 1e-12 <= found <= exact + width + 1e-12
