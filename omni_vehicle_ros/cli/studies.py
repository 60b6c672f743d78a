"""Commands that say what a vehicle does over many of its values."""

from pathlib import Path
from typing import Annotated

import typer

from omni_vehicle_ros.cli.options import Settings, choose, results_directory
from omni_vehicle_ros.results import new_directory


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
    directory = results_directory(out, 'thesis')
    with ProgressBar('thesis', reproduction.jobs, 'jobs') as bar:
        reproduction.write(directory, bar.advance)
    print(f'page    {directory / "index.html"}')


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

    directory = results_directory(out, 'map')
    with new_directory(directory):
        with ProgressBar('map', len(request.radii), 'radii') as bar:
            found = turn_map(request, bar.advance)
        write_tables(found, directory)
        write_picture(found, directory / 'map.png')
    limit_table(found)
    print(f'map     {directory / "map.png"}\ntables  {directory / "map.csv"}, {directory / "limit.csv"}')


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
    directory = results_directory(out, 'sweep')
    with ProgressBar('sweep', study.turns, 'turns') as bar:
        found = sweep_study(study, directory, scheduler, bar.advance)
    print(f'{found.driven} turns in {found.wall:.1f} s, {study.turns - found.driven} were there')
    print(f'table   {found.table}\npage    {found.page}')
