"""One process: signals, an executor with finite waits, and an end without traces."""

import gc
import math
import os
import signal
import sys
import time
from collections.abc import Callable, Sequence
from types import FrameType
from typing import Protocol

import rclpy
from rclpy.context import Context
from rclpy.executors import Executor
from rclpy.experimental import EventsExecutor
from rclpy.signals import SignalHandlerOptions

from omni_vehicle_ros.ending import ENDING, PARENT
from omni_vehicle_ros.network import profile_environment
from omni_vehicle_ros.nodes.allocator import give_back
from omni_vehicle_ros.nodes.exchange import Exchange
from omni_vehicle_ros.nodes.refusals import REFUSALS, one_line

EXIT_USAGE = 2
LOOK_PERIOD = 0.02
"""From one look to the next at who listens; messages are taken no longer in one go [s]."""
GARBAGE = 10_000
"""Objects more than before that set off a search for garbage; Python's own 700 come within a cycle or two."""


class Served(Protocol):
    """A node that is served here."""

    finished: bool

    def poll(self) -> None:
        """Do what no message calls for."""

    def wait(self) -> float:
        """Return for how long there is nothing to do but to take messages [s]."""

    def end(self) -> None:
        """Finish what must not be left half done; called once, before the node is destroyed."""

    def destroy_node(self) -> None:
        """Let go of all that is ROS."""


class Stop:
    """Set by SIGINT and SIGTERM, at any moment and as often as they come."""

    def __init__(self) -> None:
        self.asked = False
        self._parent = int(os.environ.get(PARENT, '0'))
        for number in ENDING:
            signal.signal(number, self._note)

    def _note(self, number: int, frame: FrameType | None) -> None:
        self.asked = True

    def orphaned(self) -> bool:
        """Whether the process that started this one, if it wants to be known, has gone."""
        return self._parent != 0 and os.getppid() != self._parent


Make = Callable[[Context, Exchange], Sequence[Served]]
"""Makes the nodes of a process."""


def run(make: Make, make_executor: Callable[..., Executor] = EventsExecutor) -> int:
    """Make nodes and serve them until one has finished or a signal comes; return the exit code."""
    stop = Stop()
    give_back()
    context = Context()
    try:
        os.environ.update(profile_environment())
        rclpy.init(context=context, signal_handler_options=SignalHandlerOptions.NO)
        _live(make, make_executor, context, stop)
    except REFUSALS as error:
        print(f'error: {one_line(error)}', file=sys.stderr)
        return EXIT_USAGE
    finally:
        # Python hands signals back to the system at its end; one that comes then must not kill.
        for number in ENDING:
            signal.signal(number, signal.SIG_IGN)
        context.try_shutdown()
    return 0


def _live(make: Make, make_executor: Callable[..., Executor], context: Context, stop: Stop) -> None:
    """Make the nodes, serve them, and end them whatever happened."""
    executor, exchange = make_executor(context=context), Exchange()
    nodes: Sequence[Served] = ()
    try:
        nodes = make(context, exchange)
        for node in nodes:
            executor.add_node(node)
        spare_garbage_collection()
        serve(executor, exchange, nodes, stop)
    finally:
        for number in ENDING:
            signal.signal(number, signal.SIG_IGN)
        executor.shutdown(timeout_sec=1.0)
        for node in nodes:
            node.end()
            node.destroy_node()


class Taking:
    """Takes messages, one after the other, and looks at the clock after each.

    Not by ``spin_until_future_complete``: each call of that keeps some memory for ever in the wheels of PyPI, most
    likely by pybind11 3.0 (https://github.com/pybind/pybind11/pull/6010), and looks at its time-out only when no
    message waits.

    Parameters
    ----------
    executor
        Of the nodes.
    exchange
        Of the process.
    """

    def __init__(self, executor: Executor, exchange: Exchange) -> None:
        self._exchange = exchange
        self._take = executor.spin_once
        self._over = False

    def take(self, timeout: float) -> None:
        """Take messages until ``timeout`` [s] is over; without one, those that wait, for up to `LOOK_PERIOD`."""
        self._over, now = False, time.monotonic()
        until, last = now + timeout, now + LOOK_PERIOD
        while not self._over:
            heard = self._exchange.heard
            self._take(timeout_sec=max(until - now, 0.0))
            now = time.monotonic()
            if now >= until and (timeout > 0.0 or now >= last or heard == self._exchange.heard):
                return

    def end(self) -> None:
        """Come to an end with the message that is being taken."""
        self._over = True


def spare_garbage_collection() -> None:
    """Never look again at what is there before the first cycle: a search through all of it takes 0.1 s."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(GARBAGE)


def serve(executor: Executor, exchange: Exchange, nodes: Sequence[Served], stop: Stop) -> None:
    """Take messages and poll the nodes until one has finished; every wait is finite.

    Nodes that answer each other through the exchange may never come to an end: DDS has its turn at each poll, too.
    """
    taking, due, look_due = Taking(executor, exchange), 0.0, 0.0
    exchange.wake = taking.end
    while not stop.asked:
        now = time.monotonic()
        if now >= due:
            for node in nodes:
                node.poll()
            if now >= look_due:
                exchange.look()
                look_due = now + LOOK_PERIOD
            if stop.orphaned() or any(node.finished for node in nodes):
                return
            due = math.inf
        due = min(due, now + min(node.wait() for node in nodes))
        exchange.deliver(due)
        taking.take(0.0 if exchange.waits else min(max(due - time.monotonic(), 0.0), LOOK_PERIOD))
