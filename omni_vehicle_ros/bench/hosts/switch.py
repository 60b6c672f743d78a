"""A network switch in user space: forwards Ethernet frames between TAP devices, loses some and delays the others."""

import contextlib
import heapq
import os
import random
import select
import threading
import time
from collections.abc import Sequence
from itertools import count
from typing import NamedTuple

FRAME = 2048
"""More than any Ethernet frame has [byte]."""
MULTICAST = bytes.fromhex('01005e')
"""How the address of a frame to an IPv4 group begins (RFC 1112, section 6.4)."""
BURST = 64
"""Frames taken from one port before it is the turn of the next."""
IDLE = 0.05
"""How soon the switch sees that it is to end [s]."""


class Disturbance(NamedTuple):
    """What the network does to frames.

    Attributes
    ----------
    loss
        Share of the frames that get lost, each by itself [1].
    delay
        Mean time under way [s].
    jitter
        The time under way is uniform within this share of the delay to either side [1]. A frame that another one would
        overtake on the way from port to port waits: a cable keeps the order.
    multicast
        Whether IP multicast goes through, which many networks do not let.
    """

    loss: float = 0.0
    delay: float = 0.0
    jitter: float = 0.0
    multicast: bool = True


class Switch(threading.Thread):
    """Learns from the sender of each frame which address is where, as switches do; `close` ends it.

    Parameters
    ----------
    ports
        Open TAP devices, without packet information and not blocking; their owner closes them after the switch.
    seed
        Of losses and jitter.

    Attributes
    ----------
    disturbance
        What happens to frames that come from now on.
    cut
        Ports whose cable is cut.
    forwarded, lost
        Frames so far.
    load
        Share of a core that it took, when it has ended.
    """

    def __init__(self, ports: Sequence[int], seed: int = 0) -> None:
        super().__init__(name='switch', daemon=True)
        self.disturbance = Disturbance()
        self.cut: frozenset[int] = frozenset()
        self.forwarded = self.lost = 0
        self.load = 0.0
        self._ports = tuple(ports)
        self._random = random.Random(seed)
        self._where: dict[bytes, int] = {}
        self._due: list[tuple[float, int, int, bytes]] = []
        self._latest: dict[tuple[int, int], float] = {}
        self._numbers = count()
        self._ended = False

    def run(self) -> None:
        """Forward until `close`."""
        begun = time.monotonic()
        while not self._ended:
            self._deliver()
            wait = self._due[0][0] - time.monotonic() if self._due else IDLE
            ready, _, _ = select.select(self._ports, (), (), min(max(wait, 0.0), IDLE))
            for port in ready:
                self._take(port)
        self.load = time.thread_time() / (time.monotonic() - begun)

    def close(self) -> None:
        """End, and wait for that."""
        self._ended = True
        self.join()

    def _take(self, source: int) -> None:
        """Take the frames that wait at a port."""
        with contextlib.suppress(BlockingIOError):
            for _ in range(BURST):
                frame = os.read(source, FRAME)
                self._where[frame[6:12]] = source
                known = self._where.get(frame[:6])
                for port in self._ports if known is None else (known,):
                    if port != source:
                        self._send(source, port, frame)

    def _send(self, source: int, port: int, frame: bytes) -> None:
        loss, delay, jitter, multicast = self.disturbance
        barred = not multicast and frame.startswith(MULTICAST)
        if barred or {source, port} & self.cut or self._random.random() < loss:
            self.lost += 1
            return
        way = source, port
        due = time.monotonic() + delay * (1.0 + jitter * self._random.uniform(-1.0, 1.0))
        due = self._latest[way] = max(due, self._latest.get(way, 0.0))
        heapq.heappush(self._due, (due, next(self._numbers), port, frame))
        if delay == 0.0:
            self._deliver()

    def _deliver(self) -> None:
        """Hand over all that has arrived by now."""
        now = time.monotonic()
        while self._due and self._due[0][0] <= now:
            _, _, port, frame = heapq.heappop(self._due)
            with contextlib.suppress(OSError):  # a full queue, or a host that has gone: the frame is lost
                os.write(port, frame)
                self.forwarded += 1
