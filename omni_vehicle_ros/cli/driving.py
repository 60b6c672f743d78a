"""Commands that drive a vehicle, or play again how it was driven."""

import json
import os
import sys
from pathlib import Path
from typing import Annotated, Any

import typer

from omni_vehicle_ros.cli.options import ClockOwner, Namespace, Out, Restart, Settings, choose, results_directory
from omni_vehicle_ros.errors import RunError
from omni_vehicle_ros.results import scenario_beside
from omni_vehicle_ros.run import MODES, PACINGS, RunResult, run_scenario, start_vehicle
from omni_vehicle_ros.scenarios import Scenario, load_scenario, scenario_directory, scenario_names


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
    restart: Restart = False,
) -> None:
    """Run a scenario; leave a bag, metrics.json and report.html in DIR."""
    choose('--mode', mode, MODES)
    choose('--pacing', pacing, PACINGS)
    loaded = load_scenario(scenario, settings or [])
    directory = results_directory(out, loaded.name)
    run_to_the_end(
        loaded, directory, mode=mode, pacing=pacing, namespace=namespace, publish_clock=clock, commands=commands,
        restart=restart,
    )


def run_to_the_end(scenario: Scenario, directory: Path, **options: Any) -> None:
    """Do as `run_scenario`, with a progress bar and a table of results."""
    from omni_vehicle_ros.console import ProgressBar, results_table

    with ProgressBar(scenario.name, scenario.duration) as bar:
        result: RunResult = run_scenario(scenario, directory, progress=bar.advance, **options)
    results_table(scenario, result)
    if result.dead:
        raise RunError('; '.join(result.dead))


def start(
    scenario: Annotated[str, typer.Argument(help='Whose vehicle to start; its commands are not used.')] = 'demo',
    settings: Settings = None,
    out: Out = None,
    namespace: Namespace = '',
    clock: ClockOwner = True,
    fault_injection: Annotated[
        bool, typer.Option('--fault-injection', help='Take faults, on the topic faults and by the parameters fault.*.')
    ] = False,
    restart: Restart = False,
) -> None:
    """Start a vehicle in real time, for anyone to drive, and record it until Ctrl-C."""
    loaded = load_scenario(scenario, settings or [])
    directory = results_directory(out, 'start')
    print(
        f'starting; publish on driver/icr and driver/speed, or on cmd_vel, to drive; Ctrl-C ends. Results: {directory}',
        flush=True,
    )
    dead = start_vehicle(
        loaded, directory, namespace=namespace, publish_clock=clock, fault_injection=fault_injection, restart=restart
    )
    if dead is None:
        print('stopped before the vehicle was up: there is nothing to analyse', file=sys.stderr)
        return
    from omni_vehicle_ros.console import complaints, restart_lines

    restarts = json.loads((directory / 'metrics.json').read_text(encoding='utf-8')).get('restarts', {})
    for line in (*restart_lines(restarts), *complaints(directory)):
        print(line)
    print(f'bag     {directory / "bag"}\nreport  {directory / "report.html"}')
    if dead:
        raise RunError('; '.join(dead))


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
    from omni_vehicle_ros.network import network_environment

    os.environ.update(network_environment())
    from omni_vehicle_ros.nodes.replay import Replay, play

    raise typer.Exit(play(Replay(bag, names, commands_only, player)))


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
