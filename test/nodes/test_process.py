"""Who takes messages looks at the clock: neither a flood nor silence keeps it."""

import time

import pytest

from omni_vehicle_ros.nodes.exchange import Exchange
from omni_vehicle_ros.nodes.process import LOOK_PERIOD, Taking

MESSAGE = 1e-4
"""What each takes [s]."""


class Executor:
    """Has so many messages; waits for its time-out when there are no more."""

    def __init__(self, exchange: Exchange, messages: float) -> None:
        self.exchange, self.messages = exchange, messages
        self.taken = 0

    def spin_once(self, timeout_sec: float) -> None:
        """Take one message."""
        if self.taken < self.messages:
            self.taken += 1
            self.exchange.heard += 1
            wait(MESSAGE)
        else:
            wait(timeout_sec)


def wait(span: float) -> None:
    """Let time pass, and no longer than that."""
    end = time.perf_counter() + span
    while time.perf_counter() < end:
        pass


def took(messages: float, timeout: float) -> tuple[int, float]:
    """Return how many messages were taken, and how long that took [s]; the least of some goes."""
    found = []
    for _ in range(5):
        exchange = Exchange()
        executor = Executor(exchange, messages)
        taking, begin = Taking(executor, exchange), time.perf_counter()
        taking.take(timeout)
        found.append((time.perf_counter() - begin, executor.taken))
    span, taken = min(found)
    return taken, span


@pytest.mark.parametrize('messages', [0, 3, float('inf')])
def test_the_time_is_kept_whatever_comes(messages):
    taken, span = took(messages, 0.01)
    assert 0.01 <= span < 0.01 + 10 * MESSAGE
    assert taken == messages or messages > 3


def test_without_time_all_that_waits_is_taken():
    taken, span = took(20, 0.0)
    assert taken == 20
    assert span < LOOK_PERIOD


def test_a_flood_ends_the_taking_without_time():
    taken, span = took(float('inf'), 0.0)
    assert taken > 20
    assert LOOK_PERIOD <= span < 2.0 * LOOK_PERIOD


def test_who_is_woken_comes_back_with_the_message_that_is_taken():
    exchange = Exchange()
    executor = Executor(exchange, float('inf'))
    taking = Taking(executor, exchange)
    real = executor.spin_once
    executor.spin_once = lambda timeout_sec: (real(timeout_sec), taking.end())
    taking = Taking(executor, exchange)
    taking.take(10.0)
    assert executor.taken == 1
