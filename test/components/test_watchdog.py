"""The watchdog strikes once when nothing has been heard for its limit, and never for the want of its own time."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from omni_vehicle_ros.components.watchdog import LISTENING, Watchdog

LIMIT = 0.1


def test_it_does_not_strike_before_the_first_message():
    watchdog = Watchdog(LIMIT)
    assert not any(watchdog.strikes(0.01 * k) for k in range(1000))
    assert watchdog.left == math.inf


@given(st.lists(st.floats(1e-4, LISTENING), min_size=1, max_size=50), st.floats(0.0, 1e6))
def test_it_strikes_once_with_the_first_look_after_the_limit(gaps, begin):
    watchdog, now, struck = Watchdog(LIMIT), begin, []
    watchdog.heard(now)
    for gap in [*gaps, *[LISTENING] * 3]:
        now += gap
        if watchdog.strikes(now):
            struck.append(now)
    first, = struck
    assert first - begin == pytest.approx(LIMIT, abs=LISTENING + 1e-6)
    assert first - begin > LIMIT - 1e-6


@given(st.lists(st.floats(0.0, 0.99 * LIMIT), max_size=50))
def test_messages_within_the_limit_keep_it_quiet(gaps):
    watchdog, now = Watchdog(LIMIT), 0.0
    for gap in gaps:
        watchdog.heard(now)
        now += gap
        assert not watchdog.strikes(now)


def test_it_strikes_again_after_another_message():
    watchdog = Watchdog(LIMIT)
    for begin in (0.0, 10.0):
        watchdog.heard(begin)
        assert [watchdog.strikes(begin + 0.03 * k) for k in range(1, 6)] == [False, False, False, True, False]


def test_who_was_not_served_blames_nobody():
    """A process that was frozen for a second looks at the clock first and takes the messages that wait then."""
    watchdog = Watchdog(LIMIT)
    watchdog.heard(0.0)
    assert not watchdog.strikes(1.0)
    watchdog.heard(1.0)
    assert not watchdog.strikes(1.09)
