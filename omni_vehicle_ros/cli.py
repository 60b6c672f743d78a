"""The command ``omni_vehicle``."""

import signal
import sys
import time
from pathlib import Path
from types import FrameType
from typing import Annotated

import typer

from omni_vehicle_ros import __version__
from omni_vehicle_ros.errors import OmniVehicleError, RunError
from omni_vehicle_ros.executables import ENDING, release_signals
from omni_vehicle_ros.run import MODES, PACINGS, Interrupted, RunResult, run_scenario, start_vehicle
from omni_vehicle_ros.scenarios import load_scenario, scenario_names

EXIT_USAGE = 2

app = typer.Typer(add_completion=False, no_args_is_help=True, rich_markup_mode=None, pretty_exceptions_enable=False)

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


def print_version(wanted: bool) -> None:
    """Print the version and end."""
    if wanted:
        print(__version__)
        raise typer.Exit


@app.callback()
def omni_vehicle(
    version: Annotated[
        bool, typer.Option('--version', callback=print_version, is_eager=True, help='Print the version.')
    ] = False,
) -> None:
    """Steer-by-wire for a vehicle whose four wheels steer and drive independently."""


@app.command()
def run(
    scenario: Annotated[str, typer.Argument(help='Name of a scenario, or a YAML file.')],
    settings: Settings = None,
    mode: Annotated[str, typer.Option('--mode', help=f'One of: {", ".join(MODES)}.')] = 'processes',
    pacing: Annotated[str, typer.Option('--pacing', help=f'One of: {", ".join(PACINGS)}.')] = 'lockstep',
    out: Out = None,
    namespace: Namespace = '',
    clock: ClockOwner = True,
) -> None:
    """Run a scenario; leave a bag, metrics.json and report.html in DIR."""
    choose('--mode', mode, MODES)
    choose('--pacing', pacing, PACINGS)
    loaded = load_scenario(scenario, settings or [])
    directory = out or Path('runs') / f'{loaded.name}-{time.strftime("%Y%m%d-%H%M%S")}'
    from omni_vehicle_ros.console import ProgressBar, results_table

    with ProgressBar(loaded.name, loaded.duration) as bar:
        result: RunResult = run_scenario(
            loaded, directory, mode=mode, pacing=pacing, namespace=namespace, publish_clock=clock, progress=bar.advance
        )
    results_table(loaded, result)
    if result.dead:
        raise RunError('; '.join(result.dead))


@app.command()
def start(
    scenario: Annotated[str, typer.Argument(help='Whose vehicle to start; its commands are not used.')] = 'demo',
    settings: Settings = None,
    out: Out = None,
    namespace: Namespace = '',
    clock: ClockOwner = True,
) -> None:
    """Start a vehicle in real time, for anyone to drive, and record it until Ctrl-C."""
    loaded = load_scenario(scenario, settings or [])
    directory = out or Path('runs') / f'start-{time.strftime("%Y%m%d-%H%M%S")}'
    print(
        f'starting; publish on driver/icr and driver/speed, or on cmd_vel, to drive; Ctrl-C ends. Results: {directory}',
        flush=True,
    )
    start_vehicle(loaded, directory, namespace=namespace, publish_clock=clock)
    from omni_vehicle_ros.console import complaints

    for line in complaints(directory):
        print(line)
    print(f'bag     {directory / "bag"}\nreport  {directory / "report.html"}')


@app.command()
def scenarios() -> None:
    """List the scenarios."""
    for name in scenario_names():
        print(f'{name:20} {load_scenario(name).description.splitlines()[0]}')


def choose(option: str, value: str, allowed: tuple[str, ...]) -> None:
    """Check a word against what is allowed."""
    if value not in allowed:
        raise RunError(f'{option}: {value!r} is not one of {", ".join(allowed)}')


def interrupt(number: int, frame: FrameType | None) -> None:
    """Turn a signal into an end without a trace; a run has its own handlers while nodes are up."""
    raise Interrupted('interrupted')


def main() -> None:
    """Run the command line; what the user got wrong is one line and exit code 2."""
    for number in ENDING:
        signal.signal(number, interrupt)
    try:
        release_signals()
        app()
    except Interrupted as error:
        print(error, file=sys.stderr)
    except OmniVehicleError as error:
        print(f'error: {error}', file=sys.stderr)
        sys.exit(EXIT_USAGE)
