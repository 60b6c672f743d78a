"""Runs a scenario: processes, one process or plain Python; and always a bag, metrics and a report at the end."""

import json
import re
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from omni_vehicle_ros.errors import RunError
from omni_vehicle_ros.interface import DRIVER, NODES, SIDE_SLIP_CONTROLLER
from omni_vehicle_ros.scenarios import Scenario

MODES = ('processes', 'one-process', 'offline')
PACINGS = ('lockstep', 'realtime')

Progress = Callable[[float], None]


class Interrupted(RunError):
    """A signal ended the run before its time; what was recorded is there."""


@dataclass(frozen=True)
class RunResult:
    """What a run left behind.

    Attributes
    ----------
    bag, report
        Paths of the bag and of the report.
    metrics
        As in metrics.json.
    messages, lost
        How many messages were recorded, and how many were lost on the way (lock step) or not said in time (real time).
    wall_time
        How long it took [s].
    """

    bag: Path
    report: Path
    metrics: dict[str, Any]
    messages: int
    lost: int
    wall_time: float


def participants(scenario: Scenario) -> tuple[str, ...]:
    """Return the nodes that a scenario needs."""
    return tuple(node for node in NODES if node != SIDE_SLIP_CONTROLLER or scenario.side_slip_control)


def check_namespace(namespace: str) -> None:
    """Check that ROS takes a namespace.

    Raises
    ------
    RunError
        It has something other than letters, digits and underscores between slashes.
    """
    if not re.fullmatch(r'/?([A-Za-z_]\w*(/[A-Za-z_]\w*)*)?/?', namespace, re.ASCII):
        raise RunError(
            f'--namespace: {namespace!r} must be letters, digits and underscores between slashes, such as car1'
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
        The directory exists, a node failed, or an offline run was to keep real time.
    """
    if mode == 'offline' and pacing == 'realtime':
        raise RunError('mode offline has no wall clock; choose --pacing lockstep, or --mode processes')
    check_namespace(namespace)
    new_directory(directory)
    (directory / 'scenario.yaml').write_text(scenario.as_yaml(), encoding='utf-8')
    progress(0.0)
    began = time.monotonic()
    if mode == 'offline':
        from omni_vehicle_ros.simulation import simulate

        journal = simulate(scenario, directory / 'bag', progress)
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
        graph.run(progress)
        messages, lost = graph.messages, graph.lost
        if graph.interrupted:
            raise Interrupted(f'interrupted; {messages} messages lie in {directory / "bag"}')
    wall_time = time.monotonic() - began
    return RunResult(
        directory / 'bag', directory / 'report.html', analyse(directory, scenario), messages, lost, wall_time
    )


def start_vehicle(scenario: Scenario, directory: Path, *, namespace: str = '', publish_clock: bool = True) -> None:
    """Start the vehicle of a scenario in real time without a driver; record until a signal comes, then analyse.

    Raises
    ------
    RunError
        The directory exists, or a node failed.
    """
    from omni_vehicle_ros.graph import Graph

    nodes = tuple(node for node in participants(scenario) if node != DRIVER)
    check_namespace(namespace)
    new_directory(directory)
    (directory / 'scenario.yaml').write_text(scenario.as_yaml(), encoding='utf-8')
    graph = Graph(
        directory,
        scenario,
        nodes,
        one_process=False,
        pacing='realtime',
        namespace=namespace,
        publish_clock=publish_clock,
    )
    graph.run(lambda time: None)
    analyse(directory, scenario)


def analyse(directory: Path, scenario: Scenario) -> dict[str, Any]:
    """Write metrics.json and report.html for the bag of a run; return the metrics."""
    from omni_vehicle_ros.analysis import compute_metrics, write_report
    from omni_vehicle_ros.bags import open_bag

    metrics = compute_metrics(open_bag(directory / 'bag'), scenario.vehicle)
    text = json.dumps(metrics, indent=2, allow_nan=False) + '\n'
    (directory / 'metrics.json').write_text(text, encoding='utf-8')
    write_report(directory)
    return metrics
