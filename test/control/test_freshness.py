"""Ages of commands: never, fresh, stale; zero stamps, other clocks, no time-out."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from omni_vehicle_ros.control.freshness import CommandMonitor, Freshness

SECOND = 1_000_000_000


def test_never_received_is_a_state_of_its_own():
    assert CommandMonitor(0.5).state(99 * SECOND) is Freshness.NEVER
    assert CommandMonitor(0.0).state(99 * SECOND) is Freshness.NEVER


@given(st.floats(0.01, 60.0), st.integers(1, 10**18))
def test_fresh_until_the_timeout_and_stale_after(timeout, now):
    monitor = CommandMonitor(timeout)
    monitor.received(now, now)
    assert monitor.state(now + round(timeout * SECOND)) is Freshness.FRESH
    assert monitor.state(now + round(timeout * SECOND) + 1) is Freshness.STALE
    monitor.received(0, now + 100 * SECOND)
    assert monitor.state(now + 100 * SECOND) is Freshness.FRESH


def test_a_command_that_was_long_under_way_is_stale_on_arrival():
    monitor = CommandMonitor(0.5)
    monitor.received(10 * SECOND, 12 * SECOND)
    assert monitor.state(12 * SECOND) is Freshness.STALE
    assert not monitor.warning


def test_zero_timeout_is_off():
    monitor = CommandMonitor(0.0)
    monitor.received(1, 1)
    assert monitor.state(10**18) is Freshness.FRESH


@pytest.mark.parametrize('stamp, now', [
    (1_700_000_000 * SECOND, 12 * SECOND),  # wall time against simulated time
    (12 * SECOND, 1_700_000_000 * SECOND),  # and the other way round
    (20 * SECOND, 12 * SECOND),
])
def test_stamps_of_another_clock_count_from_their_arrival(stamp, now):
    monitor = CommandMonitor(0.5)
    monitor.received(stamp, now)
    assert monitor.state(now) is Freshness.FRESH
    assert monitor.state(now + SECOND) is Freshness.STALE
    assert 'clock' in monitor.warning


def test_a_zero_stamp_means_now_and_is_no_reason_to_warn():
    monitor = CommandMonitor(0.5)
    monitor.received(0, 100 * SECOND)
    assert monitor.state(100 * SECOND) is Freshness.FRESH
    assert not monitor.warning


def test_a_good_stamp_takes_the_warning_back():
    monitor = CommandMonitor(0.5)
    monitor.received(99 * SECOND, SECOND)
    monitor.received(SECOND, SECOND)
    assert not monitor.warning


def test_forgetting_is_never_received():
    monitor = CommandMonitor(0.5)
    monitor.received(0, 5)
    monitor.forget()
    assert monitor.state(5) is Freshness.NEVER
