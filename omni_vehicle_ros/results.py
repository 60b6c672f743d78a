"""What a command leaves behind: its directory, and there the bag of a run, its metrics and its report."""

import json
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from omni_vehicle_ros.errors import RunError
from omni_vehicle_ros.scenarios import Scenario
from omni_vehicle_ros.scenarios.yaml_text import parse

_NOTHING: Mapping[str, Any] = {}


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


def write_scenario(directory: Path, scenario: Scenario) -> None:
    """Write what was run beside what comes of it."""
    (directory / 'scenario.yaml').write_text(scenario.as_yaml(), encoding='utf-8')


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


def recorded_messages(bag: Path) -> str:
    """Return in words, to be added to others, how many messages lie in a bag; nothing if none do."""
    from omni_vehicle_ros.bags.metadata import FILE_NAME, ROOT

    try:
        count = parse((bag / FILE_NAME).read_bytes())[ROOT]['message_count']
    except OSError:
        return ''
    return f'; {count} messages lie in {bag}' if count else ''


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
