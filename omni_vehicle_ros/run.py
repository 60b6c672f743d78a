"""Runs a scenario: in processes, in one process or in plain Python; bag, metrics and report in the end."""

import json
import os
import re
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from omni_vehicle_ros.control.commands import check_cmd_vel, check_icr
from omni_vehicle_ros.control.loop_check import check_gains
from omni_vehicle_ros.errors import CommandError, OmniVehicleError, ParameterError, RunError
from omni_vehicle_ros.interface import DRIVER, NODES, SIDE_SLIP_CONTROLLER
from omni_vehicle_ros.messages import Point, Twist
from omni_vehicle_ros.scenarios import Scenario
from omni_vehicle_ros.scenarios.yaml_text import parse

if TYPE_CHECKING:
    from omni_vehicle_ros.graph import Graph

MODES = ('processes', 'one-process', 'offline')
PACINGS = ('lockstep', 'realtime')

Progress = Callable[[float], None]

_NOTHING: Mapping[str, Any] = {}


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


def check_commands(scenario: Scenario) -> None:
    """Check that the vehicle can turn to where the driver of a scenario will say.

    Raises
    ------
    RunError
        A command asks for more than the wheels' range.
    """
    for number, command in enumerate(scenario.commands):
        try:
            if isinstance(command.icr, tuple):
                check_icr(Point(0, *command.icr), scenario.vehicle, scenario.steering)
            if command.twist is not None:
                topic = 'teleop' if command.cmd_vel is None else 'cmd_vel'
                check_cmd_vel(Twist(0, *command.twist), scenario.vehicle, scenario.steering, topic)
        except CommandError as error:
            raise RunError(f'{scenario.name}: commands[{number}]: {error}') from None


def check_loop(scenario: Scenario, mode: str = 'processes') -> None:
    """Check that the loop of the side-slip controller settles: sampled, or solved exactly.

    Raises
    ------
    RunError
        Gains are at the limit of the sampled loop or beyond it.
    ScenarioError
        An offline run has gains without an exact form.
    """
    if not scenario.side_slip_control:
        return
    if mode == 'offline':
        from omni_vehicle_ros.simulation import exact_gains

        if exact_gains(scenario) is not None:
            return
    try:
        check_gains(scenario.side_slip, scenario.vehicle, scenario.wheel_module, scenario.plant.control_period)
    except ParameterError as error:
        raise RunError(f'side_slip.{error}') from None


def check_namespace(namespace: str) -> None:
    """Check that ROS takes a namespace.

    Raises
    ------
    RunError
        It has something other than letters, digits and underscores between slashes.
    """
    if '__' in namespace or not re.fullmatch(r'/?([A-Za-z_]\w*(/[A-Za-z_]\w*)*)?/?', namespace, re.ASCII):
        raise RunError(
            f'--namespace: {namespace!r} must be letters, digits and single underscores between slashes, such as car1'
        )


@contextmanager
def new_directory(directory: Path) -> Iterator[None]:
    """Make a directory for results, for a ``with`` block; take away again, with those above it, what stayed empty.

    Raises
    ------
    RunError
        It is there already, or can't be made.
    """
    made = [path for path in (directory, *directory.parents) if not os.path.exists(path)]
    try:
        _make(directory)
        yield
    finally:
        with suppress(OSError):  # the first that holds something is the last to look at
            for path in made:
                path.rmdir()


def _make(directory: Path) -> None:
    try:
        directory.mkdir(parents=True)
    except FileExistsError:
        raise RunError(f'{directory}: exists already; name a directory that does not') from None
    except OSError as error:
        raise RunError(f'{directory}: {error.strerror}; name a directory that can be made') from None


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
    if mode == 'offline' and pacing == 'realtime':
        raise RunError('mode offline has no wall clock; choose --pacing lockstep, or --mode processes')
    if restart and mode != 'processes':
        raise RunError(f'--restart: starts processes again, and mode {mode} has none for its nodes; choose processes')
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
        (directory / 'scenario.yaml').write_text(scenario.as_yaml(), encoding='utf-8')
        progress(0.0)
        watch = Stopwatch(progress)
        dead: tuple[str, ...] = ()
        restarts: Mapping[str, int] = {}
        real_time: dict[str, Any] = {}
        if mode == 'offline':
            from omni_vehicle_ros.simulation import simulate

            journal = simulate(
                scenario, directory / 'bag', namespace, watch.advance, script, publish_clock=publish_clock
            )
            messages, lost = journal.written, journal.lost
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
            _drive(graph, directory, scenario, watch.advance)
            messages, lost, dead = graph.messages, graph.lost, tuple(graph.dead.values())
            real_time, restarts = graph.real_time, graph.restarts
        metrics = analyse(directory, scenario, real_time, restarts)
        return RunResult(directory, metrics, messages, lost, dead, restarts, watch.start, watch.rate)


def scenario_beside(bag: Path) -> Path:
    """Return the scenario of the run that a bag belongs to.

    Raises
    ------
    RunError
        There is none.
    """
    directory = bag.resolve() if bag.is_dir() else bag.resolve().parent
    found = directory.parent / 'scenario.yaml'
    if not found.is_file():
        raise RunError(
            f'{found} does not exist, so that nobody knows which vehicle it was; name one: '
            f'omni_vehicle run SCENARIO --commands {bag}'
        )
    return found


def _drive(graph: 'Graph', directory: Path, scenario: Scenario, progress: Progress) -> None:
    """Run the nodes to the end of a scenario."""
    try:
        graph.run(progress)
    except RunError as error:
        raise RunError(f'{error}{_salvage(directory, scenario)}') from None
    if graph.interrupted:
        raise Interrupted('interrupted', graph.interrupted)


@contextmanager
def _saying_what_lies_there(directory: Path) -> Iterator[None]:
    """Add to the words of an interruption what of the run is in its directory."""
    try:
        yield
    except Interrupted as error:
        raise Interrupted(f'{error}{_recorded(directory / "bag")}', error.number) from None


def _recorded(bag: Path) -> str:
    from omni_vehicle_ros.bags.metadata import FILE_NAME, ROOT

    try:
        count = parse((bag / FILE_NAME).read_bytes())[ROOT]['message_count']
    except OSError:
        return ''
    return f'; {count} messages lie in {bag}' if count else ''


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
        (directory / 'scenario.yaml').write_text(driven.as_yaml(), encoding='utf-8')
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
        (directory / 'scenario.yaml').write_text(driven.as_yaml(), encoding='utf-8')
        analyse(directory, driven, graph.real_time, graph.restarts)
    return tuple(graph.dead.values())


def recorded_time(directory: Path) -> float | None:
    """Return how long the vehicle was up in a run [s]; None if it never was."""
    from omni_vehicle_ros.bags import open_bag

    if not (directory / 'bag').exists():
        return None
    bag = open_bag(directory / 'bag')
    return float(bag['odom'].stamp[-1]) if 'odom' in bag and len(bag['odom']) > 1 else None


def analyse(
    directory: Path,
    scenario: Scenario,
    real_time: Mapping[str, Any] = _NOTHING,
    restarts: Mapping[str, int] = _NOTHING,
) -> dict[str, Any]:
    """Write metrics.json and report.html for the bag of a run; return the metrics.

    Parameters
    ----------
    directory
        Of the run.
    scenario
        What was run.
    real_time, restarts
        `Graph.real_time` and `Graph.restarts`, if there is something in them.
    """
    from omni_vehicle_ros.analysis import compute_metrics, write_report
    from omni_vehicle_ros.bags import open_bag

    metrics = compute_metrics(open_bag(directory / 'bag'), scenario.vehicle)
    if real_time:
        metrics['real_time'] = dict(real_time)
    if restarts:
        metrics['restarts'] = dict(restarts)
    text = json.dumps(metrics, indent=2, allow_nan=False) + '\n'
    (directory / 'metrics.json').write_text(text, encoding='utf-8')
    write_report(directory)
    return metrics
