"""Vehicles in namespaces of one machine, driven and recorded in real time: which cycles are missed, and said."""

import os
import re
import tempfile
import time
from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType
from typing import NamedTuple

import rclpy
from rclpy.context import Context
from rclpy.experimental import EventsExecutor
from rclpy.signals import SignalHandlerOptions

from omni_vehicle_ros.bench.long_drive import scenario
from omni_vehicle_ros.errors import RunError
from omni_vehicle_ros.graph import Graph
from omni_vehicle_ros.interface import NODES, PLANT, resolve, topic
from omni_vehicle_ros.messages import SECOND, Diagnostics, decode
from omni_vehicle_ros.network import network_environment
from omni_vehicle_ros.nodes.ports import subscribe_to
from omni_vehicle_ros.results import write_scenario

START_LIMIT = 150.0
"""In which all vehicles must drive [s]."""
SETTLE = 4.0
"""How long they drive before it counts [s]."""
ENDLESS = 3600.0
LAST_WORDS = 1.0
"""In which what was said at the end has come [s]."""

_MISSED = re.compile(r'(\d+) of (\d+) cycles of .* were missed')


class Vehicle(NamedTuple):
    """What one vehicle of several did.

    Attributes
    ----------
    rate
        Simulated over wall time while it counted.
    cpu
        Share of a core that all its processes took then.
    memory
        That they held then [byte].
    cycles, missed
        That its plant counted, from its start to its end.
    said
        Missed cycles that its plant said on /diagnostics in the same time.
    """

    rate: float
    cpu: float
    memory: int
    cycles: int
    missed: int
    said: int


class Ear:
    """Hears on /diagnostics what the plants say.

    Attributes
    ----------
    times
        By the name of a plant: simulated time [ns] that it said last, and the wall time at which that came [s].
    said
        By the name of a plant: missed cycles that it has said.
    """

    def __init__(self, plants: list[str]) -> None:
        self.times: dict[str, tuple[int, float]] = {}
        self.said = dict.fromkeys(plants, 0)
        self._context = Context()
        rclpy.init(context=self._context, signal_handler_options=SignalHandlerOptions.NO)
        self._node = rclpy.create_node('ear', context=self._context)
        subscribe_to(self._node, topic('/diagnostics'), '', self._take, depth=1000)
        self._executor = EventsExecutor(context=self._context)
        self._executor.add_node(self._node)

    def _take(self, data: bytes) -> None:
        said: Diagnostics = decode(topic('/diagnostics').type, data)
        for status in said.statuses:
            plant, _, about = status.name.partition(': ')
            if plant in self.said:
                self.times[plant] = said.stamp, time.monotonic()
                found = _MISSED.match(status.message) if about == 'punctuality' else None
                self.said[plant] += int(found[1]) if found else 0

    def listen(self, span: float) -> None:
        """Take what comes in the next ``span`` [s]."""
        end = time.monotonic() + span
        while (left := end - time.monotonic()) > 0.0:
            self._executor.spin_once(timeout_sec=left)

    def close(self) -> None:
        """Let go of all that is ROS."""
        self._executor.shutdown(timeout_sec=1.0)
        self._node.destroy_node()
        self._context.try_shutdown()


class Crowd:
    """Vehicles in real time, each of them recorded, for a ``with`` block; what they say is heard.

    Parameters
    ----------
    namespaces
        Of the vehicles.
    nodes
        Of each.
    one_process
        All nodes of a vehicle in one process, instead of one process each.

    Attributes
    ----------
    ear
        What was said.
    plants
        Their full names.
    graphs
        The processes of each vehicle.
    """

    def __init__(self, namespaces: list[str], nodes: tuple[str, ...], *, one_process: bool) -> None:
        os.environ.update(network_environment())
        self.plants = [resolve(PLANT, name) for name in namespaces]
        self.ear = Ear(self.plants)
        self._stack = ExitStack()
        self._stack.callback(self.ear.close)
        self.graphs: list[Graph] = []
        for name in namespaces:
            directory, driven = Path(self._stack.enter_context(tempfile.TemporaryDirectory())), scenario(ENDLESS)
            write_scenario(directory, driven)
            self.graphs.append(Graph(
                directory, driven, nodes, one_process=one_process, pacing='realtime', namespace=name,
                publish_clock=False,
            ))

    def __enter__(self) -> 'Crowd':
        """Start all, and wait until they have driven for a while.

        Raises
        ------
        RunError
            A process ended before its time, or not all drove within `START_LIMIT`.
        """
        try:
            for graph in self.graphs:
                graph.start()
            end = time.monotonic() + START_LIMIT
            while len(self.ear.times) < len(self.plants):
                if time.monotonic() > end:
                    raise RunError(f'{len(self.ear.times)} of {len(self.plants)} drive after {START_LIMIT:g} s')
                self.watch(0.5)
            self.watch(SETTLE)
        except BaseException:
            self._stop()
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Stop all, and hear their last words."""
        self._stop()

    def _stop(self) -> None:
        with self._stack:
            for graph in self.graphs:
                graph.stop()
            self.ear.listen(LAST_WORDS)

    def watch(self, span: float) -> None:
        """Listen for ``span`` [s], and take what the processes print.

        Raises
        ------
        RunError
            One of them has ended.
        """
        end = time.monotonic() + span
        while time.monotonic() < end:
            self.ear.listen(0.2)
            for graph in self.graphs:
                graph.read(graph.processes.lines(0.0), lambda simulated: None)
                for role in graph.processes.ended():
                    raise RunError(graph.processes.last_words(role))

    def rates(self, times: Mapping[str, tuple[int, float]]) -> list[float]:
        """Return simulated over wall time of each vehicle since `Ear.times` were ``times``."""
        pairs = [(times[plant], self.ear.times[plant]) for plant in self.plants]
        return [(b[0] - a[0]) / SECOND / (b[1] - a[1]) if b[1] > a[1] else 0.0 for a, b in pairs]


def drive(count: int, span: float, *, one_process: bool) -> list[Vehicle]:
    """Let ``count`` vehicles drive in real time, watch them for ``span`` [s], and return what each of them did.

    Raises
    ------
    RunError
        As `Crowd`.
    """
    names = [f'/load_{os.getpid()}_{number}' for number in range(count)]
    with Crowd(names, NODES, one_process=one_process) as crowd:
        times, cpu, wall = dict(crowd.ear.times), list(map(_cpu, crowd.graphs)), time.monotonic()
        crowd.watch(span)
        wall = time.monotonic() - wall
        shares = [(_cpu(graph) - before) / wall for graph, before in zip(crowd.graphs, cpu, strict=True)]
        sizes = [sum(graph.processes.resident_sizes().values()) for graph in crowd.graphs]
        rates = crowd.rates(times)
    counted = [(graph.real_time['cycles'], graph.real_time['missed']) for graph in crowd.graphs]
    said = [crowd.ear.said[plant] for plant in crowd.plants]
    rows = zip(rates, shares, sizes, counted, said, strict=True)
    return [Vehicle(rate, share, size, *count, words) for rate, share, size, count, words in rows]


def _cpu(graph: Graph) -> float:
    return sum(graph.processes.cpu_times().values())
