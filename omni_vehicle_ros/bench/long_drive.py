"""A recorded drive in lock step, in one process, and what that process holds while simulated time goes on."""

import os
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

from omni_vehicle_ros.bench.footprint import Footprint, footprint
from omni_vehicle_ros.bench.frame import Progress
from omni_vehicle_ros.errors import RunError
from omni_vehicle_ros.graph import Graph
from omni_vehicle_ros.interface import NODES
from omni_vehicle_ros.network import network_environment
from omni_vehicle_ros.results import write_scenario
from omni_vehicle_ros.scenarios.scenario import Scenario, make_scenario

STALL = 60.0
"""Wall time without a cycle after which a drive counts as stuck [s]."""


class Sample(NamedTuple):
    """What was held at a time.

    Attributes
    ----------
    simulated, wall
        Time since the vehicle moved first [s].
    held
        By its process.
    recorded
        Size of the bag [byte].
    """

    simulated: float
    wall: float
    held: Footprint
    recorded: int


class LongDrive(NamedTuple):
    """Samples of a drive, and messages that were recorded and lost."""

    samples: list[Sample]
    messages: int
    lost: int


def scenario(duration: float) -> Scenario:
    """Return a drive of ``duration`` [s] in circles to the left and to the right in turn, with side-slip control."""
    turns = [
        {'at': at, 'icr': [0.0, 10.0 if number % 2 else -10.0], 'speed': 4.0}
        for number, at in enumerate(range(0, max(int(duration), 1), 20))
    ]
    return make_scenario('load', {
        'duration': duration, 'side_slip_control': True, 'plant': {'initial_speed': 4.0}, 'commands': turns,
    })


def drive(duration: float, period: float, progress: Progress = lambda done: None) -> LongDrive:
    """Drive and record for ``duration`` [s] of simulated time; look each ``period`` [s] of it.

    Raises
    ------
    RunError
        The process ended before its time, or nothing happened for `STALL`.
    """
    os.environ.update(network_environment())
    with tempfile.TemporaryDirectory() as folder:
        directory, driven = Path(folder), scenario(duration)
        write_scenario(directory, driven)
        graph = Graph(
            directory, driven, NODES, one_process=True, pacing='lockstep', namespace=f'/load_{os.getpid()}',
            publish_clock=False,
        )
        watch = _Watch(graph, directory / 'bag', period)
        try:
            graph.start()
            while not graph.processes.ended():
                watch.look()
                progress(watch.simulated / duration)
        finally:
            graph.stop()
    for role, code in graph.processes.ended().items():
        if code:
            raise RunError(f'{role} ended with code {code} at {watch.simulated:.0f} s')
    return LongDrive(watch.samples, graph.messages, graph.lost)


class _Watch:
    """Takes a sample now and then."""

    def __init__(self, graph: Graph, bag: Path, period: float) -> None:
        self.samples: list[Sample] = []
        self.simulated = 0.0
        self._graph, self._bag, self._period = graph, bag, period
        self._due = 0.0
        self._begun = self._moved = time.monotonic()

    def look(self) -> None:
        """See how far the vehicle is, and take a sample when it is time."""
        before = self.simulated
        self._graph.read(self._graph.processes.lines(0.1), self._advance)
        wall = time.monotonic()
        if self.simulated > before:
            self._moved = wall
            self._begun = self._begun if before else wall
        elif wall > self._moved + STALL:
            raise RunError(f'nothing happened for {STALL:g} s at {self.simulated:.0f} s; is the machine busy?')
        if self.simulated > before and self.simulated >= self._due:
            (process,) = self._graph.processes.numbers().values()
            size = sum(path.stat().st_size for path in self._bag.glob('*.mcap'))
            self.samples.append(Sample(self.simulated, wall - self._begun, footprint(process), size))
            self._due += self._period

    def _advance(self, simulated: float) -> None:
        self.simulated = simulated
