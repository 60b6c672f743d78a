"""Commands for what lies in bags."""

from pathlib import Path
from typing import Annotated

import typer

from omni_vehicle_ros.cli.options import choose, results_directory
from omni_vehicle_ros.results import new_directory
from omni_vehicle_ros.scenarios import load_scenario


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
    directory = results_directory(out, 'analyse')
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
    directory = results_directory(out, 'export')
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
