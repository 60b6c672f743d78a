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
from omni_vehicle_ros.executables import ENDING, EXIT_SIGNAL
from omni_vehicle_ros.run import MODES, PACINGS, Interrupted, RunResult, new_directory, run_scenario, start_vehicle
from omni_vehicle_ros.scenarios import load_scenario, scenario_directory, scenario_names

EXIT_USAGE = 2
GRACE = 10  # s, of an end by a signal

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
    dead = start_vehicle(loaded, directory, namespace=namespace, publish_clock=clock)
    if dead is None:
        print('stopped before the vehicle was up: there is nothing to analyse', file=sys.stderr)
        return
    from omni_vehicle_ros.console import complaints

    for line in complaints(directory):
        print(line)
    print(f'bag     {directory / "bag"}\nreport  {directory / "report.html"}')
    if dead:
        raise RunError('; '.join(dead))


@app.command()
def scenarios() -> None:
    """List the scenarios, folder by folder, a line each; their files say more."""
    before = ''
    for name in scenario_names():
        folder = name.rpartition('/')[0]
        if folder != before:
            print()
        before = folder
        print(f'{name:24} {load_scenario(name).summary}')
    print(f'\nfiles: {scenario_directory()}')


@app.command()
def thesis(
    figure: Annotated[str | None, typer.Option('--figure', metavar='N', help='One figure only, such as 4.15.')] = None,
    chapter: Annotated[str | None, typer.Option('--chapter', metavar='N', help='Figures of a chapter: 4 or 5.')] = None,
    out: Annotated[
        Path | None,
        typer.Option('--out', metavar='DIR', help='Directory for all; must not exist. Default: runs/thesis-<date>.'),
    ] = None,
) -> None:
    """Reproduce the figures of the thesis and judge its claims; leave pictures, data and index.html in DIR."""
    from omni_vehicle_ros.console import ProgressBar
    from omni_vehicle_ros.thesis.reproduce import Reproduction

    reproduction = Reproduction(figure, chapter)
    directory = out or Path('runs') / f'thesis-{time.strftime("%Y%m%d-%H%M%S")}'
    with ProgressBar('thesis', reproduction.jobs, 'jobs') as bar:
        reproduction.write(directory, bar.advance)
    print(f'page    {directory / "index.html"}')


@app.command('map')
def draw_map(
    vehicle: Annotated[
        Path | None,
        typer.Option(
            '--vehicle',
            metavar='FILE',
            help='YAML file of the vehicle: ROS parameters, a scenario, or vehicle parameters. Default: the vehicle of '
            'the thesis.',
        ),
    ] = None,
    settings: Annotated[
        list[str] | None,
        typer.Option('--set', metavar='NAME=VALUE', help='Override a vehicle parameter; may be given again.'),
    ] = None,
    friction: Annotated[
        float | None,
        typer.Option(
            '--friction',
            metavar='MU',
            help='Friction coefficient under all wheels. Default: that of FILE, if it is one of ROS parameters, a '
            'scenario, or has plant: {friction: [FL, FR, RL, RR]} beside vehicle:; else 0.9.',
        ),
    ] = None,
    radius: Annotated[str, typer.Option('--radius', metavar='LOW:HIGH', help='Radii of the command [m].')] = '2:20',
    speed: Annotated[str, typer.Option('--speed', metavar='LOW:HIGH', help='Forward speeds [m/s].')] = '0.5:15',
    out: Annotated[
        Path | None, typer.Option('--out', metavar='DIR', help='Directory for the results. Default: runs/map-<date>.')
    ] = None,
) -> None:
    """Draw where over radius and speed slow driving leads to a stable steady turn; leave map and tables in DIR."""
    from omni_vehicle_ros.analysis.map_request import read_request

    request = read_request(vehicle, settings or [], friction, radius, speed)
    from omni_vehicle_ros.analysis.stability_map import write_picture
    from omni_vehicle_ros.analysis.turn_map import turn_map, write_tables
    from omni_vehicle_ros.console import ProgressBar, limit_table

    directory = out or Path('runs') / f'map-{time.strftime("%Y%m%d-%H%M%S")}'
    with new_directory(directory):
        with ProgressBar('map', len(request.radii), 'radii') as bar:
            found = turn_map(request, bar.advance)
        write_tables(found, directory)
        write_picture(found, directory / 'map.png')
    limit_table(found)
    print(f'map     {directory / "map.png"}\ntables  {directory / "map.csv"}, {directory / "limit.csv"}')


def choose(option: str, value: str, allowed: tuple[str, ...]) -> None:
    """Check a word against what is allowed."""
    if value not in allowed:
        raise RunError(f'{option}: {value!r} is not one of {", ".join(allowed)}')


def interrupt(number: int, frame: FrameType | None) -> None:
    """Turn a signal into an end without a trace; a run has its own handlers while nodes are up."""
    ignore_signals()
    signal.alarm(GRACE)  # kills this process, should a destructor or a callback have swallowed the exception
    raise Interrupted('interrupted', number)


def ignore_signals() -> None:
    """Let nothing disturb the end, that of the interpreter included."""
    for number in ENDING:
        signal.signal(number, signal.SIG_IGN)


def main() -> None:
    """Run the command line; what the user got wrong is one line and exit code 2, a signal 128 plus its number."""
    for number in ENDING:
        signal.signal(number, interrupt)
    try:
        try:
            app()
        finally:
            ignore_signals()
    except Interrupted as error:
        print(error, file=sys.stderr)
        sys.exit(EXIT_SIGNAL + error.number)
    except OmniVehicleError as error:
        print(f'error: {error}', file=sys.stderr)
        sys.exit(EXIT_USAGE)
