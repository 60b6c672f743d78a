"""Who takes messages looks at the clock: neither a flood nor silence keeps it."""

from types import SimpleNamespace

import pytest

from omni_vehicle_ros.nodes import process
from omni_vehicle_ros.nodes.exchange import Exchange
from omni_vehicle_ros.nodes.process import LOOK_PERIOD, Taking

MESSAGE = 1e-4
"""What each takes [s]."""
ENDLESS = float('inf')


class Executor:
    """Has so many messages, and waits for its time-out when there are no more; time goes on by that alone."""

    def __init__(self, messages: float) -> None:
        self.exchange = Exchange()
        self.messages, self.taken, self.now = messages, 0, 0.0
        self.taking = Taking(self, self.exchange)
        self.ends = False

    def spin_once(self, timeout_sec: float) -> None:
        """Take one message."""
        if self.taken == self.messages:
            self.now += timeout_sec
            return
        self.taken += 1
        self.exchange.heard += 1
        self.now += MESSAGE
        if self.ends:
            self.taking.end()


@pytest.fixture
def having(monkeypatch: pytest.MonkeyPatch):
    """Return an executor that has so many messages, by whose clock all goes."""

    def make(messages: float) -> Executor:
        executor = Executor(messages)
        monkeypatch.setattr(process, 'time', SimpleNamespace(monotonic=lambda: executor.now))
        return executor

    return make


@pytest.mark.parametrize('messages', [0, 3, ENDLESS])
def test_the_time_is_kept_whatever_comes(having, messages):
    executor = having(messages)
    executor.taking.take(0.01)
    assert 0.01 <= executor.now < 0.01 + 2 * MESSAGE
    assert executor.taken == messages or messages == ENDLESS


def test_without_time_all_that_waits_is_taken(having):
    executor = having(20)
    executor.taking.take(0.0)
    assert executor.taken == 20


def test_a_flood_ends_the_taking_without_time(having):
    executor = having(ENDLESS)
    executor.taking.take(0.0)
    assert LOOK_PERIOD <= executor.now < LOOK_PERIOD + 2 * MESSAGE


def test_who_is_woken_comes_back_with_the_message_that_is_taken(having):
    executor = having(ENDLESS)
    executor.ends = True
    executor.taking.take(10.0)
    assert executor.taken == 1
