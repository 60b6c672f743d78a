"""Starts the nodes of a vehicle as processes, watches them, and leaves none behind."""

import os
import selectors
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import IO, Any

import yaml

from omni_vehicle_ros.ending import ENDING, hold_signals, release_signals
from omni_vehicle_ros.errors import RunError
from omni_vehicle_ros.interface import DRIVER, PLANT, RECORDER, resolve
from omni_vehicle_ros.parameters import PacingParameters
from omni_vehicle_ros.scenarios import Scenario, scenario_directory
from omni_vehicle_ros.scenarios.parameter_file import parameter_file

BOOT = (
    'import sys; sys.path[:] = filter(None, sys.path); '
    'from omni_vehicle_ros.executables import main; main(sys.argv.pop(1))'
)
"""What Python runs: never a module that happens to lie in the current directory."""

STOP_LIMIT = 8.0
WATCH_PERIOD = 0.1
PARENT = 'OMNI_VEHICLE_PARENT'
"""Environment variable: a node whose parent is no longer this process ends."""


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
        self._processes: dict[str, subprocess.Popen[bytes]] = {}
        self._selector = selectors.DefaultSelector()
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
            self._start()
            self._watch(progress)
        finally:
            self._stop()
            for number, handler in handlers.items():
                signal.signal(number, handler)

    def _interrupt(self, number: int, frame: Any) -> None:
        self.interrupted = self.interrupted or number

    def _start(self) -> None:
        if self._one_process:
            options = ['--namespace', self._namespace, '--nodes', *self._participants]
            self._spawn('vehicle', 'vehicle', options, '')
            return
        for role in self._participants:
            wheel, _, _ = role.rpartition('/')
            self._spawn(role, role.split('/')[-1], [], resolve(wheel, self._namespace))

    def _spawn(self, role: str, executable: str, options: list[str], namespace: str) -> None:
        """Start one process, in a session of its own: a Ctrl-C in the terminal is for us to pass on.

        It inherits held signals, and lets them through when it can handle them.
        """
        remap = ['-r', f'__ns:={namespace}'] if namespace else []
        command = [sys.executable, '-c', BOOT, f'nodes.{executable}', *options]
        command += ['--ros-args', '--params-file', str(self._parameters), *remap]
        hold_signals()
        with self._log(role).open('wb') as log:
            process = subprocess.Popen(
                command,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=log,
                env=node_environment(),
                start_new_session=True,
            )
        release_signals()
        self._processes[role] = process
        assert process.stdout is not None
        os.set_blocking(process.stdout.fileno(), False)
        self._selector.register(process.stdout, selectors.EVENT_READ, role)

    def _log(self, role: str) -> Path:
        return self._directory / 'log' / f'{role.replace("/", "_")}.log'

    def _watch(self, progress: Callable[[float], None]) -> None:
        last = RECORDER if not self._one_process else 'vehicle'
        while not self.interrupted:
            self._read(progress, WATCH_PERIOD)
            for role, process in self._processes.items():
                code = process.poll()
                if code is None:
                    continue
                if role == last and code == 0:
                    self._read(progress, 0.0)
                    return
                self._note_death(role, f'{role} ended with code {code}{self._last_words(role)}')

    def _note_death(self, role: str, text: str) -> None:
        """Go on without a node that the others can do without; those who miss it name it on /diagnostics."""
        if role in (PLANT, DRIVER, RECORDER, 'vehicle') or not self._moving:
            raise RunError(text)
        self.dead.setdefault(role, text)

    def _read(self, progress: Callable[[float], None], timeout: float) -> None:
        """Take what the nodes print: the time from the driver, the count from the recorder."""
        for key, _ in self._selector.select(timeout):
            stream: IO[bytes] = key.fileobj  # type: ignore[assignment]
            data = stream.read()
            if not data:
                self._selector.unregister(stream)
                continue
            for line in data.decode(errors='replace').splitlines():
                words = line.split()
                if len(words) == 2 and words[0] == 'time':
                    self._moving = True
                    progress(float(words[1]))
                elif words[:1] == ['recorded']:
                    self.messages, self.lost = int(words[1]), int(words[3])

    def _last_words(self, role: str) -> str:
        lines = self._log(role).read_text(errors='replace').splitlines()
        said = [line for line in lines if line.strip()]
        return f': {said[-1].removeprefix("error: ")}' if said else ''

    def _stop(self) -> None:
        """Ask all to end, the recorder last; kill what does not."""
        roles = sorted(self._processes, key=lambda role: role == RECORDER)
        others = [role for role in roles if role != RECORDER]
        for group in (others, [role for role in roles if role == RECORDER]):
            for role in group:
                if self._processes[role].poll() is None:
                    self._processes[role].send_signal(signal.SIGINT)
            until = time.monotonic() + STOP_LIMIT
            for role in group:
                self._await(self._processes[role], until)
        self._read(lambda time: None, 0.0)
        for process in self._processes.values():
            if process.stdout is not None:
                process.stdout.close()
        self._selector.close()

    def _await(self, process: 'subprocess.Popen[bytes]', until: float) -> None:
        try:
            process.wait(max(until - time.monotonic(), 0.1))
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def node_environment() -> dict[str, str]:
    """Return the environment of a node that ends with this process."""
    return {**network_environment(), PARENT: str(os.getpid())}


def network_environment() -> dict[str, str]:
    """Return the environment of a node: this machine only, found soon, unless the user has said otherwise."""
    environment = dict(os.environ)
    environment.setdefault('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST')
    environment.setdefault('FASTRTPS_DEFAULT_PROFILES_FILE', str(scenario_directory().parent / 'fastdds.xml'))
    return environment


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
