"""How fast the graph goes in lock step, in processes and in one, beside a bare rclpy chain of the same shape."""

import os
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager
from functools import partial
from itertools import count
from pathlib import Path
from statistics import median

import rclpy
from rclpy.context import Context
from rclpy.experimental import EventsExecutor
from rclpy.signals import SignalHandlerOptions

from omni_vehicle_ros.bench.frame import CALIBRATION, Line, Progress, Result, Time, at_least, at_most, interleaved
from omni_vehicle_ros.errors import RunError
from omni_vehicle_ros.graph import Graph
from omni_vehicle_ros.interface import DRIVER, NODES, RECORDER, resolve, topic
from omni_vehicle_ros.messages import SECOND, Diagnostics, decode
from omni_vehicle_ros.network import network_environment
from omni_vehicle_ros.nodes.ports import subscribe_to
from omni_vehicle_ros.processes import Processes
from omni_vehicle_ros.results import write_scenario
from omni_vehicle_ros.scenarios.scenario import Scenario, make_scenario

SEVEN = tuple(role for role in NODES if role not in (DRIVER, RECORDER))
PERIOD = SECOND // 200
START_LIMIT, GROWTH_LIMIT = 30.0, 600.0
WARM_UP = SECOND
"""Simulated time from which on it counts: what is met for the first time has been met [ns]."""
SPAN = 3.0
"""How long each chain is watched [s]."""
ROUNDS = 3
MEMORY = 120
"""What a node in a process of its own should stay below [MB]."""

LONG = 20 * SECOND, 80 * SECOND
"""Simulated times between which the growth of memory is measured [ns]."""
GROWTH = 1.0
"""What that growth should stay below [MB]: a recording holds the same however long it is, but allocators breathe."""

Start = Callable[[str, Path], AbstractContextManager[Processes]]

_numbers = count()


class Watch:
    """Knows the simulated time of a plant from what it says on /diagnostics, once in each second of it."""

    def __init__(self, namespace: str) -> None:
        self._name = resolve('plant', namespace)
        self._context = Context()
        rclpy.init(context=self._context, signal_handler_options=SignalHandlerOptions.NO)
        self._node = rclpy.create_node('watch', context=self._context, namespace=namespace)
        subscribe_to(self._node, topic('/diagnostics'), namespace, self._take)
        self._executor = EventsExecutor(context=self._context)
        self._executor.add_node(self._node)
        self._stamp = -1

    def _take(self, data: bytes) -> None:
        said: Diagnostics = decode(topic('/diagnostics').type, data)
        if any(status.name == self._name for status in said.statuses):
            self._stamp = said.stamp

    def until(self, stamp: int, processes: Processes, limit: float) -> int:
        """Wait until simulated time is ``stamp`` [ns] or later; return it.

        Raises
        ------
        RunError
            A node has ended, or it took longer than ``limit`` [s].
        """
        end = time.monotonic() + limit
        while self._stamp < stamp:
            self._executor.spin_once(timeout_sec=0.1)
            for role in processes.ended():
                raise RunError(processes.last_words(role))
            if time.monotonic() > end:
                raise RunError(f'the nodes did nothing for {limit:g} s; is the machine busy, or ROS_DOMAIN_ID in use?')
        return self._stamp

    def close(self) -> None:
        """Let go of all that is ROS."""
        self._executor.shutdown(timeout_sec=1.0)
        self._node.destroy_node()
        self._context.try_shutdown()


def bench(progress: Progress = lambda done: None, *, span: float = SPAN, rounds: int = ROUNDS) -> Result:
    """Run our graph and the bare chain in turn, and return cycles/s and CPU time per cycle.

    Parameters
    ----------
    progress
        Told the share that is done.
    span
        How long each chain is watched in each round, at least [s].
    rounds
        As in `interleaved`.
    """
    os.environ.update(network_environment())
    works: dict[str, Callable[[], Time]] = {}
    sizes: dict[str, dict[str, int]] = {}
    for one_process, where in ((False, 'in processes'), (True, 'in one process')):
        for name, start in (
            ('bare', partial(bare_chain, one_process)),
            ('seven nodes', partial(our_graph, SEVEN, one_process)),
            ('with driver and recorder', partial(our_graph, NODES, one_process)),
        ):
            memory = sizes[f'{name} {where}'] = {}
            works[f'{name} {where}'] = partial(cycle_time, start, span, memory)
    times = interleaved(works, progress, rounds)
    return Result((*_lines(times), *_memory(sizes), _growth()), times[CALIBRATION])


def _lines(times: Mapping[str, Time]) -> list[Line]:
    lines: list[Line] = []
    for where, goal in (('in processes', 4.0), ('in one process', 15.0)):
        bare, ours, run = (
            times[f'{name} {where}'] for name in ('bare', 'seven nodes', 'with driver and recorder')
        )
        name = f'seven nodes {where}'
        lines += (
            Line(name, 'cycles/s', 1.0 / ours.wall, 1.0 / bare.wall, 'bare rclpy chain', at_least(goal)),
            Line(name, 'us CPU time/cycle', 1e6 * ours.cpu, 1e6 * bare.cpu, 'bare rclpy chain', at_most(1.0 / goal)),
            Line(f'with driver and recorder {where}', 'cycles/s', 1.0 / run.wall),
            Line(f'with driver and recorder {where}', 'us CPU time/cycle', 1e6 * run.cpu),
        )
    return lines


def _memory(sizes: Mapping[str, Mapping[str, int]]) -> list[Line]:
    bare = median(sizes['bare in processes'].values())
    return [
        Line(f'memory of {role}', 'MB', size / 1e6, bare / 1e6, 'bare rclpy node', note=f'goal below {MEMORY} MB')
        for role, size in sizes['with driver and recorder in processes'].items()
    ]


@contextmanager
def bare_chain(one_process: bool, namespace: str, directory: Path) -> Iterator[Processes]:
    """Have the bare chain run for a ``with`` block."""
    processes = Processes(directory)
    try:
        for roles in (SEVEN,) if one_process else ((role,) for role in SEVEN):
            arguments = ['--namespace', namespace, '--all', *SEVEN, '--nodes', *roles]
            processes.spawn(roles[0], 'bench.bare_chain', arguments)
        yield processes
    finally:
        processes.stop()


@contextmanager
def our_graph(nodes: tuple[str, ...], one_process: bool, namespace: str, directory: Path) -> Iterator[Processes]:
    """Have some of our nodes run in lock step for a ``with`` block."""
    scenario = endless()
    write_scenario(directory, scenario)
    graph = Graph(
        directory, scenario, nodes, one_process=one_process, pacing='lockstep', namespace=namespace, publish_clock=False
    )
    try:
        graph.start()
        yield graph.processes
    finally:
        graph.stop()


def endless() -> Scenario:
    """Return a drive that is longer than any benchmark: without a driver, straight on over a banked road."""
    return make_scenario('bench', {
        'duration': 36_000.0,
        'side_slip_control': True,
        'plant': {'initial_speed': 4.0, 'constant_speed': True, 'bank': 0.02},
        'commands': [{'at': 0.0, 'icr': [0.0, 10.0], 'speed': 4.0}],
    })


def _growth() -> Line:
    """Return how much memory a recorded run takes more with time; all nodes of it are in one process."""
    with watched(partial(our_graph, NODES, True)) as (watch, processes):
        times, sizes = [], []
        for stamp in LONG:
            times.append(watch.until(stamp, processes, GROWTH_LIMIT))
            sizes.append(sum(processes.resident_sizes().values()))
    seconds = (times[1] - times[0]) / SECOND
    note = f'in {seconds:.0f} s simulated; goal: flat, below {GROWTH:g} MB'
    return Line('memory of a recorded run grows by', 'MB', (sizes[1] - sizes[0]) / 1e6, note=note)


def cycle_time(start: Start, span: float, memory: dict[str, int]) -> Time:
    """Return the time of one control cycle: on the wall, and CPU time of all processes taken together.

    Parameters
    ----------
    start
        Has the nodes run, in a namespace and with a directory for their files.
    span
        How long they are watched, at least [s].
    memory
        Gets the resident size of each process at the end [byte].
    """
    with watched(start) as (watch, processes):
        found = _measure(watch, processes, span)
        memory.update(processes.resident_sizes())
        return found


@contextmanager
def watched(start: Start) -> Iterator[tuple[Watch, Processes]]:
    """Have nodes run in a namespace and a directory of their own for a ``with`` block, with a watch on their time."""
    namespace = f'/bench_{os.getpid()}_{next(_numbers)}'
    with tempfile.TemporaryDirectory() as folder:
        watch = Watch(namespace)
        try:
            with start(namespace, Path(folder)) as processes:
                yield watch, processes
        finally:
            watch.close()


def _measure(watch: Watch, processes: Processes, span: float) -> Time:
    first = last = watch.until(WARM_UP, processes, START_LIMIT)
    wall, cpu = time.monotonic(), sum(processes.cpu_times().values())
    while time.monotonic() - wall < span:
        last = watch.until(last + 1, processes, START_LIMIT)
    cycles = (last - first) // PERIOD
    return Time((time.monotonic() - wall) / cycles, (sum(processes.cpu_times().values()) - cpu) / cycles)
