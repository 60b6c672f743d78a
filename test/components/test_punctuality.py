"""Answers by the wall clock: late ones, missed cycles and ticks, percentiles."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omni_vehicle_ros.components.punctuality import BINS, PERIODS, Histogram, Lateness, Punctuality
from omni_vehicle_ros.control.health import OK, WARN

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


def said(late: set[int], cycles: int) -> list[tuple[float, int, str]]:
    """Return when and what is said if the answers of some cycles come after the next tick."""
    found = Punctuality(TOPICS, PERIOD)
    lateness, notes = Lateness(found), []
    for cycle in range(cycles):
        wall = cycle * PERIOD
        found.tick(cycle * STEP, wall)
        if (note := lateness.look(wall)) is not None:
            notes.append((wall, *note))
        if cycle not in late:
            for topic in TOPICS:
                found.answer(topic, cycle * STEP, wall + 0.001)
    return notes


def test_missed_cycles_are_said_once_a_second_and_then_that_there_are_no_more():
    notes = said({*range(300, 310), 450}, 1500)
    assert [level for _, level, _ in notes] == [WARN, WARN, OK]
    assert notes[0][2].startswith('10 of 200 cycles of 5 ms')
    assert notes[1][2].startswith('1 of 200 cycles of 5 ms')
    assert all(b[0] - a[0] >= 1.0 for a, b in pairwise(notes))


def test_who_is_punctual_says_nothing():
    assert said(set(), 1500) == []


@settings(max_examples=20, deadline=None)
@given(st.sets(st.integers(1, 998), max_size=20))
def test_what_is_said_adds_up_to_all_that_was_missed(late):
    notes = said(late, 1401)
    assert sum(int(text.split()[0]) for _, level, text in notes if level == WARN) == len(late)


def test_no_cycle_is_missed_while_time_stands_still():
    found = Punctuality(TOPICS, PERIOD)
    for number, wall in enumerate((0.0, PERIOD, 10.0, 10.0 + PERIOD)):
        if wall == 10.0:
            found.rest()
        found.tick(number * STEP, wall)
        for topic in TOPICS:
            found.answer(topic, number * STEP, wall + 0.001)
    assert (found.cycles, found.missed) == (2, 0)
