"""The report of a run: one HTML page that needs nothing else."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from omni_vehicle_ros import __version__
from omni_vehicle_ros.analysis import summary
from omni_vehicle_ros.analysis.troubles import Trouble, troubles
from omni_vehicle_ros.bags import Bag, open_bag
from omni_vehicle_ros.errors import RunError
from omni_vehicle_ros.scenarios import Scenario, load_scenario


def write_report(directory: Path) -> None:
    """Write ``report.html`` for a run.

    Parameters
    ----------
    directory
        That of the run, with ``bag/``, ``metrics.json`` and ``scenario.yaml``.

    Raises
    ------
    BagError
        The bag can't be read, or lacks a topic of the plant.
    RunError
        A file can't be read or written.
    ScenarioError
        ``scenario.yaml`` is not a scenario.
    """
    scenario = load_scenario(str(directory / 'scenario.yaml'))
    bag = open_bag(directory / 'bag')
    try:
        metrics = json.loads((directory / 'metrics.json').read_text(encoding='utf-8'))
        page = render_report(scenario, metrics, _draw(bag, scenario), troubles(bag))
        (directory / 'report.html').write_text(page, encoding='utf-8')
    except OSError as error:
        raise RunError(f'{error.filename}: {error.strerror}') from None
    except ValueError as error:
        raise RunError(f'{directory / "metrics.json"}: {error}') from None


def _draw(bag: Bag, scenario: Scenario) -> list[dict[str, str]]:
    # Drawing takes a second to import; a run that is not yet over should not pay for it.
    from omni_vehicle_ros.analysis.plots import draw_plots
    from omni_vehicle_ros.analysis.style import house_style, to_svg

    with house_style():
        return [
            {'name': plot.name, 'title': plot.title, 'text': plot.text, 'svg': to_svg(plot.figure, plot.name)}
            for plot in draw_plots(bag, scenario)
        ]


def render_report(
    scenario: Scenario, metrics: Mapping[str, Any], plots: list[dict[str, str]], complaints: Sequence[Trouble] = ()
) -> str:
    """Return the HTML page of a run.

    Parameters
    ----------
    scenario
        What was run.
    metrics
        As in ``metrics.json``.
    plots
        Name, title, text and SVG of each figure, the first one drawn larger.
    complaints
        What the nodes complained about.
    """
    import jinja2

    environment = jinja2.Environment(
        loader=jinja2.PackageLoader('omni_vehicle_ros.analysis'),
        autoescape=True, trim_blocks=True, lstrip_blocks=True, undefined=jinja2.StrictUndefined,
    )
    return environment.get_template('report.html.j2').render(
        scenario=scenario,
        facts=summary.facts(scenario),
        figures=summary.figures(metrics),
        steady=metrics['steady'],
        rows=summary.rows(metrics),
        punctual=summary.punctual(metrics.get('real_time')),
        real_time=metrics.get('real_time'),
        load=summary.load(metrics.get('real_time')),
        timeline=summary.timeline(scenario),
        changed=summary.changed(scenario),
        plots=plots,
        complaints=complaints,
        version=__version__,
    )
