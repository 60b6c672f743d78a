"""Runs a scenario: in processes, in one process or in plain Python; bag, metrics and report in the end."""

import json
import re
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from omni_vehicle_ros.control.stability import side_slip_gain_limit
from omni_vehicle_ros.errors import OmniVehicleError, RunError
from omni_vehicle_ros.interface import DRIVER, NODES, SIDE_SLIP_CONTROLLER
from omni_vehicle_ros.scenarios import Scenario

MODES = ('processes', 'one-process', 'offline')
PACINGS = ('lockstep', 'realtime')
IDEAL = 1e-9  # of a cycle: time constant of an actuator that has none

Progress = Callable[[float], None]


class Interrupted(RunError):
    """A signal ended the run before its time; what was recorded is there."""


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
    start, rate
        Wall time until the vehicle moved [s]; simulated time over wall time from then on.
    """

    directory: Path
    metrics: dict[str, Any]
    messages: int
    lost: int
    dead: tuple[str, ...]
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


def check_loop(scenario: Scenario, mode: str = 'processes') -> None:
    """Check that wheel_slip control with ideal actuators is sampled below its limit, or solved exactly.

    Raises
    ------
    RunError
        Proportional and derivative gain of a wheel are at the limit or beyond it.
    ScenarioError
        An offline run has gains without an exact form.
    """
    if not (scenario.side_slip_control and scenario.wheel_module.ideal_actuators):
        return
    if mode == 'offline':
        from omni_vehicle_ros.simulation import exact_gains

        exact_gains(scenario)
        return
    if scenario.side_slip.controller != 'wheel_slip':
        return
    # From one cycle to the next a derivative acts as a proportional gain of its own over its filter.
    law = scenario.side_slip
    pairs = zip(law.proportional_gains, law.derivative_gains, strict=True)
    gain, limit = max(p + d / law.derivative_time_constant for p, d in pairs), side_slip_gain_limit(IDEAL, 0.0, 1.0)
    if gain >= limit:
        raise RunError(
            f'side_slip: proportional gain plus derivative gain over its time constant, {gain:g}, is not below '
            f'{limit:g}, where the sampled loop diverges with ideal actuators; set wheel_module.ideal_actuators=false, '
            'or solve it exactly by --mode offline, without derivative'
        )


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


def new_directory(directory: Path) -> Path:
    """Make the directory of a run.

    Raises
    ------
    RunError
        It is there already, or can't be made.
    """
    try:
        directory.mkdir(parents=True)
    except FileExistsError:
        raise RunError(f'{directory}: exists already; name a directory that does not') from None
    except OSError as error:
        raise RunError(f'{directory}: {error.strerror}; name a directory that can be made') from None
    return directory


def run_scenario(
    scenario: Scenario,
    directory: Path,
    *,
    mode: str = 'processes',
    pacing: str = 'lockstep',
    namespace: str = '',
    publish_clock: bool = True,
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
    progress
        Called with the simulated time [s] now and then.

    Raises
    ------
    RunError
        The directory exists, a node failed, an offline run was to keep real time, or the side-slip loop would
        diverge.
    """
    if mode == 'offline' and pacing == 'realtime':
        raise RunError('mode offline has no wall clock; choose --pacing lockstep, or --mode processes')
    check_loop(scenario, mode)
    check_namespace(namespace)
    new_directory(directory)
    (directory / 'scenario.yaml').write_text(scenario.as_yaml(), encoding='utf-8')
    progress(0.0)
    watch = Stopwatch(progress)
    dead: tuple[str, ...] = ()
    if mode == 'offline':
        from omni_vehicle_ros.simulation import simulate

        journal = simulate(scenario, directory / 'bag', namespace, watch.advance)
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
        )
        try:
            graph.run(watch.advance)
        except RunError as error:
            raise RunError(f'{error}{_salvage(directory, scenario)}') from None
        messages, lost, dead = graph.messages, graph.lost, tuple(graph.dead.values())
        if graph.interrupted:
            raise Interrupted(f'interrupted; {messages} messages lie in {directory / "bag"}')
    metrics = analyse(directory, scenario)
    return RunResult(directory, metrics, messages, lost, dead, watch.start, watch.rate)


def _salvage(directory: Path, scenario: Scenario) -> str:
    """Analyse what was recorded before a node died; say where it is."""
    try:
        analyse(directory, scenario)
    except OmniVehicleError:
        return ''
    return f'; what was recorded before: {directory / "report.html"}'


def start_vehicle(
    scenario: Scenario, directory: Path, *, namespace: str = '', publish_clock: bool = True
) -> tuple[str, ...]:
    """Start the vehicle of a scenario in real time without a driver; record until a signal comes, then analyse.

    Returns
    -------
    tuple of str
        A line for each node that ended before its time.

    Raises
    ------
    RunError
        The directory exists, a node failed, or a side-slip loop would diverge.
    """
    from omni_vehicle_ros.graph import Graph

    nodes = tuple(node for node in participants(scenario) if node != DRIVER)
    check_loop(scenario)
    check_namespace(namespace)
    new_directory(directory)
    driven = replace(
        scenario, name='start', description='Driven from outside.', commands=(), environment=(), values={}
    )
    (directory / 'scenario.yaml').write_text(driven.as_yaml(), encoding='utf-8')
    graph = Graph(
        directory,
        driven,
        nodes,
        one_process=False,
        pacing='realtime',
        namespace=namespace,
        publish_clock=publish_clock,
    )
    graph.run(lambda time: None)
    ended = recorded_time(directory)
    if ended is None:
        raise Interrupted('stopped before the vehicle was up: there is nothing to analyse')
    driven = replace(driven, duration=ended)
    (directory / 'scenario.yaml').write_text(driven.as_yaml(), encoding='utf-8')
    analyse(directory, driven)
    return tuple(graph.dead.values())


def recorded_time(directory: Path) -> float | None:
    """Return how long the vehicle was up in a run [s]; None if it never was."""
    from omni_vehicle_ros.bags import open_bag

    bag = open_bag(directory / 'bag')
    return float(bag['odom'].stamp[-1]) if 'odom' in bag and len(bag['odom']) > 1 else None


def analyse(directory: Path, scenario: Scenario) -> dict[str, Any]:
    """Write metrics.json and report.html for the bag of a run; return the metrics."""
    from omni_vehicle_ros.analysis import compute_metrics, write_report
    from omni_vehicle_ros.bags import open_bag

    metrics = compute_metrics(open_bag(directory / 'bag'), scenario.vehicle)
    text = json.dumps(metrics, indent=2, allow_nan=False) + '\n'
    (directory / 'metrics.json').write_text(text, encoding='utf-8')
    write_report(directory)
    return metrics
