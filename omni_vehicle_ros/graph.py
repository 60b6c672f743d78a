"""Starts the nodes of a vehicle as processes, watches them, and leaves none behind."""

import json
import signal
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import yaml

from omni_vehicle_ros.cores import Core
from omni_vehicle_ros.ending import DIED, ENDING, READY, WITHOUT
from omni_vehicle_ros.errors import RunError
from omni_vehicle_ros.faults import PROCESSES
from omni_vehicle_ros.interface import DRIVER, PLANT, RECORDER, resolve
from omni_vehicle_ros.parameters import PacingParameters
from omni_vehicle_ros.processes import Processes
from omni_vehicle_ros.scenarios import Scenario
from omni_vehicle_ros.scenarios.parameter_file import parameter_file

WATCH_PERIOD = 0.1
LOAD_PERIOD = 0.5

BESIDE = ('rear_left/wheel_module', 'rear_right/wheel_module')
"""Nodes that act while the other modules do, on the neighbour of the core that all others share in lock step."""

RESTARTS = 5
"""How often a node is started again that died."""

REFUSED = 2
"""Exit code of a node that has said why it does not work; it would say the same again."""


class Graph:
    """The processes of one vehicle.

    Parameters
    ----------
    directory
        Of the run: gets ``parameters.yaml``, ``log/`` and ``bag/``.
    scenario
        Gives the parameters of all nodes, and the driver's commands if a driver takes part.
    participants
        Which nodes to start.
    one_process
        All nodes in one process, instead of one process each.
    pacing, namespace, publish_clock, commands
        As in :func:`omni_vehicle_ros.run.run_scenario`.
    fault_injection
        Whether the nodes take faults.
    restart
        Whether nodes that die are started again, up to `RESTARTS` times each. The plant is not, which is the world,
        nor the recorder, whose bag ends with it.

    Attributes
    ----------
    interrupted
        Number of the signal that ended the run, or 0.
    restarts
        How often each node was started again that was.
    messages, lost, dead
        As in :class:`omni_vehicle_ros.run.RunResult`.
    real_time
        After a run in real time: see :meth:`omni_vehicle_ros.components.punctuality.Punctuality.figures`, and by
        process ``cpu``, share of a core from the first cycle to the last, and ``memory`` [byte].
    """

    def __init__(
        self,
        directory: Path,
        scenario: Scenario,
        participants: tuple[str, ...],
        *,
        one_process: bool,
        pacing: str,
        namespace: str = '',
        publish_clock: bool = True,
        commands: Path | None = None,
        fault_injection: bool = False,
        restart: bool = False,
    ) -> None:
        self.interrupted = 0  # or the number of the signal
        self.restarts: dict[str, int] = {}
        self._restart = restart
        self._mourned: set[str] = set()
        self._awaited: set[str] = set()
        self.messages, self.lost = 0, 0
        self.dead: dict[str, str] = {}
        self.real_time: dict[str, Any] = {}
        self._begun: tuple[float, dict[str, float]] | None = None
        self._load: dict[str, Any] = {}
        self._weighed = 0.0
        self._weighs = pacing == 'realtime'
        self._moving = DRIVER not in participants
        self._takes_turns, self._core = pacing == 'lockstep' and not one_process, Core()
        self._directory, self._participants = directory, participants
        self._one_process, self._namespace = one_process, namespace.strip('/')
        self._parameters = directory / 'parameters.yaml'
        self.processes = Processes(directory / 'log')
        self._doomed = {PROCESSES.get(event.fault.component) for event in scenario.faults}
        settings = PacingParameters(
            pacing=pacing, participants=participants, publish_clock=publish_clock, fault_injection=fault_injection
        )
        text = node_parameters(scenario, directory.resolve(), settings, commands)
        self._parameters.write_text(text, encoding='utf-8')
        (directory / 'log').mkdir()

    def run(self, progress: Callable[[float], None]) -> None:
        """Start all, wait until the scenario is over or a signal comes, stop all.

        Raises
        ------
        RunError
            A node could not be started, or ended before its time.
        """
        handlers = {number: signal.signal(number, self._interrupt) for number in ENDING}
        try:
            self.start()
            self._watch(progress)
        finally:
            self.stop()
            for number, handler in handlers.items():
                signal.signal(number, handler)

    def _interrupt(self, number: int, frame: Any) -> None:
        self.interrupted = self.interrupted or number

    def start(self) -> None:
        """Start all nodes."""
        if self._takes_turns:
            self._core.claim()
        if self._one_process:
            options = ['--namespace', self._namespace, '--nodes', *self._participants]
            self._spawn('vehicle', 'vehicle', options, '')
            return
        for role in self._participants:
            self._spawn_node(role)

    def _spawn_node(self, role: str, *arguments: str) -> None:
        wheel, _, executable = role.rpartition('/')
        self._spawn(role, executable, [], resolve(wheel, self._namespace), *arguments)

    def _spawn(self, role: str, executable: str, options: list[str], namespace: str, *arguments: str) -> None:
        remap = ['-r', f'__ns:={namespace}'] if namespace else []
        options = [*options, '--ros-args', '--params-file', str(self._parameters), *remap, *arguments]
        self.processes.spawn(role, f'nodes.{executable}', options, core=self._core_of(role))

    def _core_of(self, role: str) -> int | None:
        """Return the core that a node stays on: those who take turns share one, and two modules work beside."""
        if role == RECORDER:
            return None
        return self._core.neighbour if role in BESIDE else self._core.number

    def _watch(self, progress: Callable[[float], None]) -> None:
        last = RECORDER if not self._one_process else 'vehicle'
        while not self.interrupted:
            self.read(self.processes.lines(WATCH_PERIOD), progress)
            if self._weighs and self._moving and time.monotonic() - self._weighed >= LOAD_PERIOD:
                self._weigh()
            for role, code in self.processes.ended().items():
                if role == last and code == 0:
                    self.read(self.processes.lines(0.0), progress)
                    return
                if role not in self._mourned:
                    self._note_death(role, code)

    def _note_death(self, role: str, code: int) -> None:
        """Start a node again; or go on without it, if the others can, and those who miss it name it on /diagnostics.

        One that a fault of the scenario kills has not ended before its time.
        """
        self.processes.tell(DIED, role)
        if self._may_restart(role, code):
            self._start_again(role)
            return
        self._mourned.add(role)
        self.processes.tell(WITHOUT, role)
        if role in self._doomed and role not in self.restarts:
            return
        if role in (PLANT, DRIVER, RECORDER, 'vehicle') or not self._moving:
            raise RunError(self.processes.last_words(role))
        self.dead.setdefault(role, self.processes.last_words(role))

    def _start_again(self, role: str) -> None:
        """Start a node that has died; in lock step the others wait until it is connected, but not for ever."""
        self.restarts[role] = self.restarts.get(role, 0) + 1
        self._begun = None  # what a process takes is measured from here on
        self._awaited.add(role)
        self._spawn_node(role, *(('-p', 'restarted:=true') if role == DRIVER else ()))

    def _may_restart(self, role: str, code: int) -> bool:
        lasting = role in (PLANT, RECORDER, 'vehicle') or code == REFUSED or not self._moving
        return self._restart and not lasting and self.restarts.get(role, 0) < RESTARTS

    def read(self, lines: list[str], progress: Callable[[float], None]) -> None:
        """Take what the nodes print: the time from the driver, the count from the recorder."""
        for line in lines:
            words = line.split()
            if words[:1] == [READY]:
                self._note_ready(words[1])
            elif len(words) == 2 and words[0] == 'time':
                self._moving = True
                progress(float(words[1]))
            elif words[:1] == ['recorded']:
                self.messages, self.lost = int(words[1]), int(words[3])
            elif words[:1] == ['punctual']:
                self.real_time = json.loads(line.removeprefix('punctual'))

    def _note_ready(self, role: str) -> None:
        self.processes.note_segments()
        if role in self._awaited:
            self._awaited.remove(role)
            self.processes.tell(WITHOUT, role)

    def stop(self) -> None:
        """Ask all to end, the recorder last."""
        self.read(self.processes.stop(last=RECORDER), lambda time: None)
        self._core.let_go()
        if self.real_time:
            self.real_time.update(self._load)

    def _weigh(self) -> None:
        """Note what each process takes, while all of them are there."""
        self._weighed, now = time.monotonic(), self.processes.cpu_times()
        if self._begun is None:
            self._begun = self._weighed, now
        elif not self.processes.ended():
            begin, before = self._begun
            cpu = {role: (now[role] - before[role]) / (self._weighed - begin) for role in now}
            self._load = {'cpu': cpu, 'memory': self.processes.resident_sizes()}


def node_parameters(
    scenario: Scenario, directory: Path, pacing: PacingParameters, commands: Path | None = None
) -> str:
    """Return the parameter file of all nodes of a scenario whose run lies in ``directory``; see `Graph`."""
    text = parameter_file(
        vehicle=scenario.vehicle,
        steering=scenario.steering,
        wheel_module=scenario.wheel_module,
        side_slip=scenario.side_slip,
        plant=scenario.plant,
        pacing=pacing,
    )
    driver = {'scenario': directory / 'scenario.yaml', **({'commands': commands.resolve()} if commands else {})}
    paths = {DRIVER: driver, RECORDER: {'directory': directory / 'bag'}}
    sections = {
        f'/**/{node}': {'ros__parameters': {name: str(path) for name, path in entry.items()}}
        for node, entry in paths.items()
    }
    return f'{text}\n{yaml.safe_dump(sections)}'
