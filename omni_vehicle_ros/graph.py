"""Starts the nodes of a vehicle as processes, watches them, and leaves none behind."""

import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any

import yaml

from omni_vehicle_ros.ending import ENDING
from omni_vehicle_ros.errors import RunError
from omni_vehicle_ros.interface import DRIVER, PLANT, RECORDER, resolve
from omni_vehicle_ros.parameters import PacingParameters
from omni_vehicle_ros.processes import Processes
from omni_vehicle_ros.scenarios import Scenario
from omni_vehicle_ros.scenarios.parameter_file import parameter_file

WATCH_PERIOD = 0.1


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
    ) -> None:
        self.interrupted = 0  # or the number of the signal
        self.messages, self.lost = 0, 0
        self.dead: dict[str, str] = {}
        self._moving = DRIVER not in participants
        self._directory, self._participants = directory, participants
        self._one_process, self._namespace = one_process, namespace.strip('/')
        self._parameters = directory / 'parameters.yaml'
        self.processes = Processes(directory / 'log')
        settings = PacingParameters(pacing=pacing, participants=participants, publish_clock=publish_clock)
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
        if self._one_process:
            options = ['--namespace', self._namespace, '--nodes', *self._participants]
            self._spawn('vehicle', 'vehicle', options, '')
            return
        for role in self._participants:
            wheel, _, _ = role.rpartition('/')
            self._spawn(role, role.split('/')[-1], [], resolve(wheel, self._namespace))

    def _spawn(self, role: str, executable: str, options: list[str], namespace: str) -> None:
        remap = ['-r', f'__ns:={namespace}'] if namespace else []
        options = [*options, '--ros-args', '--params-file', str(self._parameters), *remap]
        self.processes.spawn(role, f'nodes.{executable}', options)

    def _watch(self, progress: Callable[[float], None]) -> None:
        last = RECORDER if not self._one_process else 'vehicle'
        while not self.interrupted:
            self._read(self.processes.lines(WATCH_PERIOD), progress)
            for role, code in self.processes.ended().items():
                if role == last and code == 0:
                    self._read(self.processes.lines(0.0), progress)
                    return
                self._note_death(role)

    def _note_death(self, role: str) -> None:
        """Go on without a node that the others can do without; those who miss it name it on /diagnostics."""
        if role in (PLANT, DRIVER, RECORDER, 'vehicle') or not self._moving:
            raise RunError(self.processes.last_words(role))
        self.dead.setdefault(role, self.processes.last_words(role))

    def _read(self, lines: list[str], progress: Callable[[float], None]) -> None:
        """Take what the nodes print: the time from the driver, the count from the recorder."""
        for line in lines:
            words = line.split()
            if len(words) == 2 and words[0] == 'time':
                self._moving = True
                progress(float(words[1]))
            elif words[:1] == ['recorded']:
                self.messages, self.lost = int(words[1]), int(words[3])

    def stop(self) -> None:
        """Ask all to end, the recorder last."""
        self._read(self.processes.stop(last=RECORDER), lambda time: None)


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
