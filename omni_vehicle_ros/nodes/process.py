"""One process: signals, an executor with finite waits, and an end without traces."""

import os
import signal
import sys
import time
from collections.abc import Callable, Sequence
from types import FrameType
from typing import Protocol

import rclpy
from rclpy.context import Context
from rclpy.exceptions import InvalidParameterTypeException, InvalidParameterValueException
from rclpy.executors import Executor
from rclpy.experimental import EventsExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.signals import SignalHandlerOptions

from omni_vehicle_ros.ending import ENDING
from omni_vehicle_ros.errors import OmniVehicleError

RCLError = rclpy_implementation.RCLError

PARENT = 'OMNI_VEHICLE_PARENT'
EXIT_USAGE = 2

REFUSALS = (InvalidParameterTypeException, InvalidParameterValueException, RCLError)
"""What rclpy says to parameters, files and names that it does not take."""


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


def run(make: Callable[[Context], Sequence[Served]], make_executor: Callable[..., Executor] = EventsExecutor) -> int:
    """Make nodes and serve them until one has finished or a signal comes; return the exit code."""
    stop = Stop()
    context = Context()
    try:
        rclpy.init(context=context, signal_handler_options=SignalHandlerOptions.NO)
        _live(make, make_executor, context, stop)
    except (OmniVehicleError, *REFUSALS) as error:
        print(f'error: {_one_line(error)}', file=sys.stderr)
        return EXIT_USAGE
    finally:
        # Python hands signals back to the system at its end; one that comes then must not kill.
        for number in ENDING:
            signal.signal(number, signal.SIG_IGN)
        context.try_shutdown()
    return 0


def _live(
    make: Callable[[Context], Sequence[Served]], make_executor: Callable[..., Executor], context: Context, stop: Stop
) -> None:
    """Make the nodes, serve them, and end them whatever happened."""
    executor = make_executor(context=context)
    nodes: Sequence[Served] = ()
    try:
        nodes = make(context)
        for node in nodes:
            executor.add_node(node)
        serve(executor, nodes, stop)
    finally:
        for number in ENDING:
            signal.signal(number, signal.SIG_IGN)
        executor.shutdown(timeout_sec=1.0)
        for node in nodes:
            node.end()
            node.destroy_node()


def _one_line(error: Exception) -> str:
    """Return what an error says; rcl adds where in its source it was found, after a comma and a line break."""
    return ' '.join(str(error).split(', at /')[0].split())


def serve(executor: Executor, nodes: Sequence[Served], stop: Stop) -> None:
    """Take messages and poll the nodes until one has finished; every wait is finite."""
    due = 0.0
    while not stop.asked:
        now = time.monotonic()
        if now >= due:
            for node in nodes:
                node.poll()
            if stop.orphaned() or any(node.finished for node in nodes):
                return
            due = now + min(node.wait() for node in nodes)
        executor.spin_once(timeout_sec=max(due - now, 0.0))
