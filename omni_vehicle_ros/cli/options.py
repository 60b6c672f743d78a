"""What the commands share: options, and where results go."""

import time
from pathlib import Path
from typing import Annotated

import typer

from omni_vehicle_ros.errors import RunError

Settings = Annotated[
    list[str] | None,
    typer.Option(
        '--set', metavar='KEY=VALUE', help='Override a value of the scenario, in SI units; may be given again.'
    ),
]
Out = Annotated[
    Path | None,
    typer.Option(
        '--out', metavar='DIR', help='Directory for the results; must not exist. Default: runs/<scenario>-<date>.'
    ),
]
Namespace = Annotated[str, typer.Option('--namespace', help='Namespace of the vehicle.')]
ClockOwner = Annotated[
    bool, typer.Option('--clock/--no-clock', help='Whether this vehicle owns /clock; one of several does.')
]

Restart = Annotated[
    bool,
    typer.Option(
        '--restart', help='Start nodes again that die, up to 5 times each; not the plant, and not the recorder.'
    ),
]


def results_directory(out: Path | None, name: str) -> Path:
    """Return where results go: what the user says, or a directory named after the work and the time."""
    return out or Path('runs') / f'{name}-{time.strftime("%Y%m%d-%H%M%S")}'


def choose(option: str, value: str, allowed: tuple[str, ...]) -> None:
    """Check a word against what is allowed."""
    if value not in allowed:
        raise RunError(f'{option}: {value!r} is not one of {", ".join(allowed)}')
