"""Commands that put the vehicle to the test with faults."""

import os
from pathlib import Path
from typing import Annotated

import typer

from omni_vehicle_ros.campaign.draw import CAMPAIGN_MODES, MIXED
from omni_vehicle_ros.cli.options import choose, results_directory
from omni_vehicle_ros.errors import RunError


def campaign(
    runs: Annotated[int, typer.Option('--runs', metavar='N', help='How many drives.', min=1)] = 200,
    seed: Annotated[int, typer.Option('--seed', help='The same seed draws the same drives.', min=0)] = 0,
    out: Annotated[
        Path | None,
        typer.Option(
            '--out', metavar='DIR',
            help='Directory for the results; the same command goes on with what is there. Default: '
            'runs/campaign-<date>.',
        ),
    ] = None,
    mode: Annotated[
        str, typer.Option('--mode', help=f'One of: {", ".join(CAMPAIGN_MODES)}. Mixed: processes where one fails.')
    ] = MIXED,
    jobs: Annotated[
        int, typer.Option('--jobs', metavar='N', help='Drives at a time, each in a ROS domain of its own.', min=1)
    ] = 1,
) -> None:
    """Drive with each shipped fault, then with random pairs; judge each drive, leave table and page in DIR."""
    from omni_vehicle_ros.campaign.campaign import run_campaign
    from omni_vehicle_ros.campaign.store import Request
    from omni_vehicle_ros.campaign.tables import PAGE
    from omni_vehicle_ros.console import ProgressBar

    choose('--mode', mode, CAMPAIGN_MODES)
    directory = results_directory(out, 'campaign')
    request = Request(runs, seed, mode, jobs, int(os.environ.get('ROS_DOMAIN_ID') or 0))
    with ProgressBar('campaign', runs, 'runs') as bar:
        verdicts = run_campaign(request, directory, bar.advance)
    failed = [str(verdict.drive.number) for verdict in verdicts if not verdict.passed]
    print(f'{runs - len(failed)} of {runs} drives passed')
    print(f'table   {directory / "runs.csv"}\npage    {directory / PAGE}')
    if failed:
        raise RunError(f'not passed: {", ".join(failed)}; their results are in {directory}')
