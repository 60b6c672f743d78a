"""The switch between sockets that keep the borders of messages, in place of TAP devices."""

import contextlib
import select
import socket
import time
from collections.abc import Callable, Iterator

import pytest

from omni_vehicle_ros.bench.hosts.switch import Disturbance, Switch

LIMIT = 10.0
BROADCAST = b'\xff' * 6


class Station:
    """One end of a cable, with an address."""

    def __init__(self, number: int) -> None:
        self.near, self.far = socket.socketpair(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.far.setblocking(False)
        self.address = bytes([2, 0, 0, 0, 0, number])

    def send(self, to: bytes, payload: bytes = b'') -> None:
        self.near.send(to + self.address + b'\x08\x00' + payload)

    def hear(self, limit: float = LIMIT) -> bytes | None:
        ready, _, _ = select.select([self.near], (), (), limit)
        return self.near.recv(2048)[14:] if ready else None


@contextlib.contextmanager
def joined(disturbance: Disturbance = Disturbance()) -> Iterator[tuple[Switch, list[Station]]]:  # noqa: B008
    stations = [Station(number) for number in range(3)]
    switch = Switch([station.far.fileno() for station in stations], seed=1)
    switch.disturbance = disturbance
    switch.start()
    try:
        yield switch, stations
    finally:
        switch.close()
        for station in stations:
            station.near.close()
            station.far.close()


def until(condition: Callable[[], bool]) -> None:
    """Wait for what the switch does."""
    end = time.monotonic() + LIMIT
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.0002)


@pytest.mark.parametrize('loss', [0.01, 0.1, 0.3])
def test_the_share_that_is_told_gets_lost(loss: float) -> None:
    """The number that is lost of n is binomial: five standard deviations to either side."""
    number = 2000
    with joined() as (switch, (a, b, _)):
        b.send(BROADCAST)
        assert a.hear() == b''
        switch.disturbance = Disturbance(loss)
        for index in range(number):
            a.send(b.address)
            if index % 5 == 4:  # before any queue is full
                until(lambda index=index: switch.lost + switch.forwarded == index + 3)
                while b.hear(0.0) is not None:
                    pass
    deviation = (number * loss * (1.0 - loss)) ** 0.5
    assert abs(switch.lost - number * loss) < 5.0 * deviation


def test_no_frame_is_early_and_all_keep_their_order() -> None:
    delay, jitter, number = 0.01, 0.5, 100
    with joined(Disturbance(0.0, delay, jitter)) as (_, (a, b, _)):
        sent, heard = [], []
        for index in range(number):
            sent.append(time.monotonic())
            a.send(BROADCAST, bytes([index]))
        for index in range(number):
            assert b.hear() == bytes([index])
            heard.append(time.monotonic())
    assert all(came - went >= delay * (1.0 - jitter) for went, came in zip(sent, heard, strict=True))


def test_nothing_passes_a_cut_cable_until_it_is_plugged_in_again() -> None:
    with joined() as (switch, (a, b, c)):
        switch.cut = frozenset([b.far.fileno()])
        a.send(BROADCAST, b'lost')
        assert c.hear() == b'lost'
        b.send(BROADCAST, b'lost, too')
        until(lambda: switch.lost == 3)  # one to b, two from b
        switch.cut = frozenset()
        a.send(BROADCAST, b'back')
        assert b.hear() == c.hear() == b'back'
        b.send(a.address, b'answer')
        assert a.hear() == b'answer'


def test_a_network_without_multicast_lets_all_else_through() -> None:
    """A group of IPv4 has 01:00:5e before the last 23 bits of its address: RFC 1112, section 6.4."""
    group = bytes.fromhex('01005e7f0001')
    with joined(Disturbance(multicast=False)) as (switch, (a, b, c)):
        a.send(group, b'lost')
        until(lambda: switch.lost == 2)
        a.send(BROADCAST, b'who is there')
        assert b.hear() == c.hear() == b'who is there'
        b.send(a.address, b'answer')
        assert a.hear() == b'answer'
