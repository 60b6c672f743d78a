"""Health: what is said, in which order, and for how long."""

import itertools

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omni_vehicle_ros.components.component import Reporter
from omni_vehicle_ros.control.health import ERROR, HOLD, OK, WARN, Hold, health

STEP = 5_000_000
FINE, CLIPPED, LOST = health([], 'fine'), health([(WARN, 'clipped')], 'fine'), health([(ERROR, 'lost')], 'fine')


def test_notes_are_joined_from_the_worst_on():
    state = health([(WARN, 'a'), (ERROR, 'b'), (WARN, 'c')], 'fine', (('gain', '1'),))
    assert (state.level, state.message, state.values) == (ERROR, 'b; a; c', (('gain', '1'),))
    assert (FINE.level, FINE.message) == (OK, 'fine')


def test_notes_are_added():
    assert FINE.with_notes() == FINE
    assert FINE.with_notes((WARN, 'clipped')) == CLIPPED
    assert CLIPPED.with_notes((ERROR, 'lost')).message == 'lost; clipped'


def test_what_was_wrong_is_said_for_a_second_and_no_longer():
    hold = Hold()
    assert hold.update(0, CLIPPED) == CLIPPED
    said = {stamp: hold.update(stamp, FINE) for stamp in range(STEP, 2 * HOLD, STEP)}
    assert all((state == CLIPPED) == (stamp < HOLD) for stamp, state in said.items())
    assert all(state == FINE for stamp, state in said.items() if stamp >= HOLD)


def test_what_is_worse_is_said_at_once_and_ends_by_itself():
    hold = Hold()
    hold.update(0, LOST)
    assert hold.update(HOLD // 2, CLIPPED).message == 'lost; clipped'
    assert hold.update(HOLD, FINE) == CLIPPED
    assert hold.update(2 * HOLD, LOST) == LOST


def test_a_clock_that_jumps_back_begins_anew():
    hold = Hold()
    hold.update(9 * HOLD, CLIPPED)
    assert hold.update(8 * HOLD, FINE) == FINE


def test_ever_new_nonsense_does_not_pile_up():
    hold = Hold()
    for k in range(200):
        state = hold.update(k * STEP, health([(ERROR, f'{k} is not a speed')], 'fine'))
    assert state.message.split('; ') == [f'{k} is not a speed' for k in range(194, 200)]


@settings(deadline=None, max_examples=60)
@given(st.lists(st.tuples(st.integers(0, HOLD // 3), st.sets(st.sampled_from([(WARN, 'a'), (ERROR, 'b')])))))
def test_all_that_is_wrong_is_always_said(course):
    hold, stamp = Hold(), 0
    for pause, notes in course:
        stamp += pause
        said = hold.update(stamp, health(list(notes), 'fine'))
        assert notes <= set(said.notes)
        assert said.level >= max((level for level, _ in notes), default=OK)


@pytest.mark.parametrize('cycles', [2, 13, 60])
def test_a_limit_cycle_does_not_flap(cycles):
    """A trim at its limit in half of every period of an oscillation: one change up, one down, and once a second."""
    reporter, levels = Reporter('/node'), []
    for k in range(2000):
        wrong = k < 1000 and k % cycles < cycles // 2
        outputs = reporter.report(k * STEP, CLIPPED if wrong else FINE)
        levels += [output.value.statuses[0].level for output in outputs]
    assert len(levels) <= 12
    assert sum(a != b for a, b in itertools.pairwise(levels)) == 1
    assert levels[-1] == OK
