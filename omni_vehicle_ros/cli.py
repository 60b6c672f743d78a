"""The command ``omni_vehicle``."""

import json
import os
import signal
import sys
import time
from functools import partial
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING, Annotated, Any

import typer

from omni_vehicle_ros import __version__
from omni_vehicle_ros.bench import BENCHES
from omni_vehicle_ros.ending import ENDING, EXIT_SIGNAL
from omni_vehicle_ros.errors import OmniVehicleError, RunError
from omni_vehicle_ros.run import (
    MODES,
    PACINGS,
    Interrupted,
    RunResult,
    new_directory,
    run_scenario,
    scenario_beside,
    start_vehicle,
)
from omni_vehicle_ros.scenarios import Scenario, load_scenario, scenario_directory, scenario_names

if TYPE_CHECKING:
    from omni_vehicle_ros.console import ProgressBar

EXIT_USAGE = 2
GRACE = 10  # s, of an end by a signal
AGAIN = 0.01  # s, until an end that was swallowed is tried again

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
    commands: Annotated[
        Path | None,
        typer.Option(
            '--commands', metavar='BAG',
            help="Bag of a run whose commands and environment to play in place of the scenario's.",
        ),
    ] = None,
) -> None:
    """Run a scenario; leave a bag, metrics.json and report.html in DIR."""
    choose('--mode', mode, MODES)
    choose('--pacing', pacing, PACINGS)
    loaded = load_scenario(scenario, settings or [])
    directory = out or Path('runs') / f'{loaded.name}-{time.strftime("%Y%m%d-%H%M%S")}'
    run_to_the_end(
        loaded, directory, mode=mode, pacing=pacing, namespace=namespace, publish_clock=clock, commands=commands
    )


def run_to_the_end(scenario: Scenario, directory: Path, **options: Any) -> None:
    """Do as `run_scenario`, with a progress bar and a table of results."""
    from omni_vehicle_ros.console import ProgressBar, results_table

    with ProgressBar(scenario.name, scenario.duration) as bar:
        result: RunResult = run_scenario(scenario, directory, progress=bar.advance, **options)
    results_table(scenario, result)
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
def replay(
    bag: Annotated[Path, typer.Argument(help='Bag directory or file: MCAP, or what else rosbag2 writes.')],
    rate: Annotated[float, typer.Option('--rate', metavar='R', help='Time of the bag over wall time.')] = 1.0,
    start: Annotated[float, typer.Option('--start', metavar='S', help='Begin so far into the bag [s].')] = 0.0,
    duration: Annotated[
        float | None, typer.Option('--duration', metavar='D', help='How long, in time of the bag [s]. Default: all.')
    ] = None,
    topics: Annotated[
        list[str] | None,
        typer.Option('--topics', metavar='NAMES', help='Only these, with commas between; may be given again.'),
    ] = None,
    loop: Annotated[bool, typer.Option('--loop', help='Begin again at the end.')] = False,
    clock: Annotated[
        bool, typer.Option('--clock', help='Make /clock from the times of the messages, in place of that in the bag.')
    ] = False,
    commands_only: Annotated[
        bool,
        typer.Option(
            '--commands-only',
            help='Only what drives a vehicle: to the one that is running, with stamps that mean now; or with --out '
            'to one of its own, in lock step, as it was recorded.',
        ),
    ] = False,
    out: Annotated[
        Path | None,
        typer.Option(
            '--out', metavar='DIR',
            help='With --commands-only: drive the vehicle of the scenario.yaml beside BAG; leave a bag, metrics.json '
            'and report.html in DIR.',
        ),
    ] = None,
    mode: Annotated[str, typer.Option('--mode', help=f'With --out; one of: {", ".join(MODES)}.')] = 'processes',
) -> None:
    """Publish the messages of a bag as they were recorded; services ~/pause, ~/resume and ~/step."""
    from omni_vehicle_ros.bags.player import PlayerSettings

    player = PlayerSettings(rate, start, duration, loop, clock)
    names = tuple(name for entry in topics or [] for name in entry.replace(',', ' ').split())
    if out is not None:
        choose('--mode', mode, MODES)
        if not commands_only or names or player != PlayerSettings():
            raise RunError('--out: goes with --commands-only and --mode; the other options are for a plain replay')
        from omni_vehicle_ros.components.recorded_commands import RecordedCommands

        scenario = load_scenario(str(scenario_beside(bag)))
        recorded = RecordedCommands(bag, scenario)
        run_to_the_end(
            scenario, out, mode=mode, namespace=recorded.namespace, publish_clock=recorded.has_clock, commands=bag
        )
        return
    if commands_only and clock:
        raise RunError('--clock: the vehicle that takes the commands has its own clock; leave one of both options out')
    from omni_vehicle_ros.processes import network_environment

    os.environ.update(network_environment())
    from omni_vehicle_ros.nodes.replay import Replay, play

    raise typer.Exit(play(Replay(bag, names, commands_only, player)))


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


@app.command()
def sweep(
    scenario: Annotated[str, typer.Argument(help='Name of a scenario, or a YAML file.')],
    vary: Annotated[
        list[str] | None,
        typer.Option(
            '--vary', metavar='NAME=VALUES',
            help='What to vary: START:STOP:COUNT, A,B,C, or a distribution such as normal(0.8,0.05); may be given '
            "again. Default: the scenario's own.",
        ),
    ] = None,
    settings: Settings = None,
    samples: Annotated[
        int | None, typer.Option('--samples', metavar='N', help='How often to draw from the distributions.')
    ] = None,
    sampling: Annotated[str, typer.Option('--sampling', help='One of: random, latin.')] = 'random',
    seed: Annotated[int, typer.Option('--seed', help='The same seed draws the same samples.', min=0)] = 0,
    scheduler: Annotated[
        str | None,
        typer.Option(
            '--scheduler', metavar='ADDRESS', help='Dask scheduler whose workers drive. Default: all cores here.'
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            '--out', metavar='DIR',
            help='Directory for the results; the same command goes on with what is there. Default: runs/sweep-<date>.',
        ),
    ] = None,
) -> None:
    """Drive a scenario for every combination of values, or for many samples; leave table, maps and page in DIR."""
    from omni_vehicle_ros.console import ProgressBar
    from omni_vehicle_ros.sweep.command import sweep as sweep_study
    from omni_vehicle_ros.sweep.study import SAMPLINGS, read_study

    choose('--sampling', sampling, SAMPLINGS)
    study = read_study(scenario, vary or [], settings or [], samples, sampling, seed)
    directory = out or Path('runs') / f'sweep-{time.strftime("%Y%m%d-%H%M%S")}'
    with ProgressBar('sweep', study.turns, 'turns') as bar:
        found = sweep_study(study, directory, scheduler, bar.advance)
    print(f'{found.driven} turns in {found.wall:.1f} s, {study.turns - found.driven} were there')
    print(f'table   {found.table}\npage    {found.page}')


@app.command()
def repair(
    bag: Annotated[Path, typer.Argument(help='Bag directory, or one MCAP file; it is not touched.')],
    out: Annotated[
        Path | None,
        typer.Option('--out', metavar='DIR', help='The new bag; must not exist. Default: <bag>_repaired, here.'),
    ] = None,
) -> None:
    """Put all that makes sense in a bag that was cut off or damaged into a new one; say what is saved and lost."""
    from omni_vehicle_ros.bags.repair.repair import repair as repair_bag
    from omni_vehicle_ros.console import ProgressBar

    directory = out or Path(f'{bag.resolve().stem}_repaired')
    with ProgressBar('repair', 100.0, '%') as bar:
        result = repair_bag(bag, directory, lambda done: bar.advance(round(100.0 * done, 1)))
    for line in result.lines:
        print(line)


@app.command('analyse')
def analyse_bags(
    bags: Annotated[
        list[Path], typer.Argument(metavar='BAG...', help='Bag directories or files, or directories of runs.')
    ],
    out: Annotated[
        Path | None,
        typer.Option('--out', metavar='DIR', help='Directory for all; must not exist. Default: runs/analyse-<date>.'),
    ] = None,
    scenario: Annotated[
        str | None,
        typer.Option('--scenario', help='Whose limits and dimensions hold. Default: scenario.yaml beside the bag.'),
    ] = None,
    namespace: Annotated[
        str | None, typer.Option('--namespace', help='Namespace of the vehicle. Default: that of the only one.')
    ] = None,
) -> None:
    """Analyse any bag, or compare several; leave metrics.json and report.html in DIR."""
    from omni_vehicle_ros.analysis.bags.analysis import analyse, read_subjects
    from omni_vehicle_ros.analysis.bags.report import write_analysis
    from omni_vehicle_ros.console import ProgressBar

    subjects = read_subjects(bags, load_scenario(scenario) if scenario else None)
    directory = out or Path('runs') / f'analyse-{time.strftime("%Y%m%d-%H%M%S")}'
    with new_directory(directory):
        with ProgressBar('analyse', sum(subject.reader.size for subject in subjects), 'MB') as bar:
            found = analyse(subjects, namespace, bar.advance)
        write_analysis(found, directory)
    for bag in found.metrics['bags']:
        for topic, text in bag['missing'].items():
            print(f'{bag["bag"]}: no {topic}: left out {text}')
        for line in bag['damage']:
            print(line)
    print(f'metrics {directory / "metrics.json"}\nreport  {directory / "report.html"}')


@app.command('export')
def export_bag(
    bag: Annotated[Path, typer.Argument(help='Bag directory or file: MCAP, or what else rosbag2 writes.')],
    out: Annotated[
        Path | None,
        typer.Option('--out', metavar='DIR', help='Directory for all; must not exist. Default: runs/export-<date>.'),
    ] = None,
    kind: Annotated[str, typer.Option('--format', help='One of: parquet, csv.')] = 'parquet',
    topics: Annotated[
        list[str] | None,
        typer.Option('--topics', metavar='NAME', help='Full name of a topic; may be given again. Default: all.'),
    ] = None,
) -> None:
    """Write a table for each topic of a bag, one column a field, with SI units."""
    from omni_vehicle_ros.bags.columns.export import FORMATS, export
    from omni_vehicle_ros.console import ProgressBar

    choose('--format', kind, FORMATS)
    directory = out or Path('runs') / f'export-{time.strftime("%Y%m%d-%H%M%S")}'
    with new_directory(directory), ProgressBar('export', 100.0, '%') as bar:
        found = export(
            bag, directory, kind=kind, topics=topics, progress=lambda done: bar.advance(round(100.0 * done, 1))
        )
        bar.advance(100.0)
    for path, count in found.files.items():
        print(f'{path}: {count} messages')
    for topic, why in sorted(found.skipped.items()):
        print(f'{topic}: left out: {why}')
    for line in found.damage:
        print(line)


@app.command()
def bench(
    name: Annotated[
        str | None, typer.Argument(metavar='[NAME]', help=f'One of: {", ".join(BENCHES)}. Default: all.')
    ] = None,
    json_file: Annotated[
        Path | None, typer.Option('--json', metavar='FILE', help='Write the results there, too.')
    ] = None,
) -> None:
    """Measure how fast this package is on this machine, each figure beside a bare limit."""
    from omni_vehicle_ros.bench.frame import machine, run_bench
    from omni_vehicle_ros.console import ProgressBar

    choose('NAME', name or BENCHES[0], BENCHES)
    found: dict[str, Any] = {'machine': machine()}
    for one in BENCHES if name is None else (name,):
        with ProgressBar(f'bench {one}', 100.0, '%') as bar:
            result = run_bench(one, partial(show_share, bar))
        found[one] = result.as_json()
        for line in result.text:
            print(line, flush=True)
    if json_file is not None:
        try:
            json_file.write_text(json.dumps(found, indent=2) + '\n', encoding='utf-8')
        except OSError as error:
            raise RunError(f'{json_file}: {error.strerror}') from None


def show_share(bar: 'ProgressBar', done: float) -> None:
    """Show a share of 0 to 1 on a bar of per cent."""
    bar.advance(round(100.0 * done))


def choose(option: str, value: str, allowed: tuple[str, ...]) -> None:
    """Check a word against what is allowed."""
    if value not in allowed:
        raise RunError(f'{option}: {value!r} is not one of {", ".join(allowed)}')


def interrupt(number: int, frame: FrameType | None) -> None:
    """Turn a signal into an end without a trace; a run has its own handlers while nodes are up."""
    ignore_signals()
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    signal.alarm(GRACE)  # kills this process, should anything have swallowed the exception for good

    def again(unraisable: 'sys.UnraisableHookArgs') -> None:
        if not isinstance(unraisable.exc_value, Interrupted):
            sys.__unraisablehook__(unraisable)
            return
        signal.signal(signal.SIGALRM, lambda late, frame: interrupt(number, frame))  # a destructor has swallowed it
        signal.setitimer(signal.ITIMER_REAL, AGAIN)

    sys.unraisablehook = again
    raise Interrupted('interrupted', number)


def own_arguments(arguments: list[str]) -> list[str]:
    """Return what is not between ``--ros-args`` and ``--``: that is for the node, which finds it by itself."""
    if '--ros-args' not in arguments:
        return arguments
    begin = arguments.index('--ros-args')
    rest = arguments[begin:]
    return arguments[:begin] + (own_arguments(rest[rest.index('--') + 1 :]) if '--' in rest else [])


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
            app(own_arguments(sys.argv[1:]))
        finally:
            ignore_signals()
    except Interrupted as error:
        print(error, file=sys.stderr)
        sys.exit(EXIT_SIGNAL + error.number)
    except OmniVehicleError as error:
        print(f'error: {error}', file=sys.stderr)
        sys.exit(EXIT_USAGE)
