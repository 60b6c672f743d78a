"""Runs a scenario: in processes, in one process or in plain Python; bag, metrics and report in the end."""

import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from omni_vehicle_ros.checks import check_commands, check_loop, check_namespace
from omni_vehicle_ros.errors import OmniVehicleError, RunError
from omni_vehicle_ros.interface import DRIVER, NODES, SIDE_SLIP_CONTROLLER
from omni_vehicle_ros.results import analyse, new_directory, recorded_messages, recorded_time, write_scenario
from omni_vehicle_ros.scenarios import Scenario

if TYPE_CHECKING:
    from omni_vehicle_ros.graph import Graph

MODES = ('processes', 'one-process', 'offline')
PACINGS = ('lockstep', 'realtime')

Progress = Callable[[float], None]


class Interrupted(BaseException):
    """A signal ended the command before its time; what was recorded is there.

    No `Exception`, as KeyboardInterrupt is none: nobody who tries whether something works may take it for a failure.

    Parameters
    ----------
    text
        What to tell the user.
    number
        Of the signal.
    """

    def __init__(self, text: str, number: int) -> None:
        super().__init__(text)
        self.number = number


@dataclass(frozen=True)
class RunResult:
    """What a run left behind.

    Attributes
    ----------
    directory
        Where all of it lies.
    metrics
        As in metrics.json.
    messages, lost
        How many messages were recorded, and how many were lost on the way (lock step) or not said in time (real time).
    dead
        A line for each node that ended before its time.
    restarts
        How often each node was started again that was.
    start, rate
        Wall time until the vehicle moved [s]; simulated time over wall time from then on.
    """

    directory: Path
    metrics: dict[str, Any]
    messages: int
    lost: int
    dead: tuple[str, ...]
    restarts: Mapping[str, int]
    start: float
    rate: float


class Stopwatch:
    """Passes progress on, and measures how fast it is."""

    def __init__(self, progress: Progress) -> None:
        self._progress = progress
        self._made = self._first = self._last = time.monotonic()
        self._from = self._to = 0.0

    def advance(self, simulated: float) -> None:
        """Note the simulated time [s]."""
        self._last, self._to = time.monotonic(), simulated
        if self._from == 0.0:
            self._first, self._from = self._last, self._to
        self._progress(simulated)

    @property
    def start(self) -> float:
        """Wall time until the simulated time moved [s]."""
        return self._first - self._made

    @property
    def rate(self) -> float:
        """Simulated time over wall time, from then on."""
        return (self._to - self._from) / max(self._last - self._first, 1e-9)


def participants(scenario: Scenario) -> tuple[str, ...]:
    """Return the nodes that a scenario needs."""
    return tuple(node for node in NODES if node != SIDE_SLIP_CONTROLLER or scenario.side_slip_control)


def run_scenario(
    scenario: Scenario,
    directory: Path,
    *,
    mode: str = 'processes',
    pacing: str = 'lockstep',
    namespace: str = '',
    publish_clock: bool = True,
    commands: Path | None = None,
    restart: bool = False,
    progress: Progress = lambda time: None,
) -> RunResult:
    """Run a scenario and analyse it.

    Parameters
    ----------
    scenario
        What to run.
    directory
        Where ``bag/``, ``metrics.json``, ``report.html`` and ``scenario.yaml`` go; must not exist.
    mode, pacing
        One of `MODES` and of `PACINGS`.
    namespace, publish_clock
        Of the vehicle, and whether it owns /clock.
    commands
        Bag of a run whose commands and environment to play in place of the scenario's.
    restart
        Whether nodes that die are started again; see `omni_vehicle_ros.graph.Graph`.
    progress
        Called with the simulated time [s] now and then.

    Raises
    ------
    RunError
        The directory exists, a node failed, an offline run was to keep real time, a command asks for what no wheel
        reaches, the side-slip loop would diverge, or there are no processes to start again.
    BagError
        There are no commands in the bag.
    Interrupted
        A signal ended the nodes.
    """
    _check_modes(mode, pacing, restart)
    check_commands(scenario)
    check_loop(scenario, mode)
    check_namespace(namespace)
    script, takes_faults = None, scenario.faults or commands
    if commands is not None:
        from omni_vehicle_ros.components.recorded_commands import RecordedCommands

        script = RecordedCommands(commands, scenario)
        text = f'Driven by the commands of {commands}.'
        scenario = replace(scenario, description=text, commands=(), environment=(), faults=(), values={})
    with new_directory(directory), _saying_what_lies_there(directory):
        write_scenario(directory, scenario)
        progress(0.0)
        watch = Stopwatch(progress)
        if mode == 'offline':
            from omni_vehicle_ros.simulation import simulate

            journal = simulate(
                scenario, directory / 'bag', namespace, watch.advance, script, publish_clock=publish_clock
            )
            driven = _Driven(journal.written, journal.lost)
        else:
            from omni_vehicle_ros.graph import Graph

            graph = Graph(
                directory,
                scenario,
                participants(scenario),
                one_process=mode == 'one-process',
                pacing=pacing,
                namespace=namespace,
                publish_clock=publish_clock,
                commands=commands,
                fault_injection=bool(takes_faults),
                restart=restart,
            )
            driven = _drive(graph, directory, scenario, watch.advance)
        metrics = analyse(directory, scenario, driven.real_time, driven.restarts)
        return RunResult(
            directory, metrics, driven.messages, driven.lost, driven.dead, driven.restarts, watch.start, watch.rate
        )


class _Driven(NamedTuple):
    """What a drive tells of itself, beside its bag; as in `RunResult`, and what a real-time graph measures."""

    messages: int
    lost: int
    dead: tuple[str, ...] = ()
    restarts: Mapping[str, int] = {}
    real_time: Mapping[str, Any] = {}


def _check_modes(mode: str, pacing: str, restart: bool) -> None:
    if mode == 'offline' and pacing == 'realtime':
        raise RunError('mode offline has no wall clock; choose --pacing lockstep, or --mode processes')
    if restart and mode != 'processes':
        raise RunError(f'--restart: starts processes again, and mode {mode} has none for its nodes; choose processes')


def _drive(graph: 'Graph', directory: Path, scenario: Scenario, progress: Progress) -> _Driven:
    """Run the nodes to the end of a scenario."""
    try:
        graph.run(progress)
    except RunError as error:
        raise RunError(f'{error}{_salvage(directory, scenario)}') from None
    if graph.interrupted:
        raise Interrupted('interrupted', graph.interrupted)
    return _Driven(graph.messages, graph.lost, tuple(graph.dead.values()), graph.restarts, graph.real_time)


@contextmanager
def _saying_what_lies_there(directory: Path) -> Iterator[None]:
    """Add to the words of an interruption what of the run is in its directory."""
    try:
        yield
    except Interrupted as error:
        raise Interrupted(f'{error}{recorded_messages(directory / "bag")}', error.number) from None


def _salvage(directory: Path, scenario: Scenario) -> str:
    """Analyse what was recorded before a node died; say where it is."""
    try:
        analyse(directory, scenario)
    except OmniVehicleError:
        return ''
    return f'; what was recorded before: {directory / "report.html"}'


def start_vehicle(
    scenario: Scenario,
    directory: Path,
    *,
    namespace: str = '',
    publish_clock: bool = True,
    fault_injection: bool = False,
    restart: bool = False,
) -> tuple[str, ...] | None:
    """Start the vehicle of a scenario in real time without a driver; record until a signal comes, then analyse.

    Returns
    -------
    tuple of str or None
        A line for each node that ended before its time; None if the signal came before the vehicle was up.

    Raises
    ------
    RunError
        The directory exists, a node failed, or a side-slip loop would diverge.
    """
    from omni_vehicle_ros.graph import Graph

    nodes = tuple(node for node in participants(scenario) if node != DRIVER)
    check_loop(scenario)
    check_namespace(namespace)
    driven = replace(
        scenario, name='start', description='Driven from outside.', commands=(), environment=(), faults=(), values={}
    )
    with new_directory(directory):
        write_scenario(directory, driven)
        graph = Graph(
            directory,
            driven,
            nodes,
            one_process=False,
            pacing='realtime',
            namespace=namespace,
            publish_clock=publish_clock,
            fault_injection=fault_injection,
            restart=restart,
        )
        graph.run(lambda time: None)
        ended = recorded_time(directory)
        if ended is None:
            return None
        driven = replace(driven, duration=ended)
        write_scenario(directory, driven)
        analyse(directory, driven, graph.real_time, graph.restarts)
    return tuple(graph.dead.values())
