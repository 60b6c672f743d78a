"""The page about a sweep: what was asked for, what came of it, and how to read its table."""

from pathlib import Path
from typing import Any

import jinja2

from omni_vehicle_ros import __version__
from omni_vehicle_ros.sweep.cells import Cells
from omni_vehicle_ros.sweep.maps import label
from omni_vehicle_ros.sweep.parts import TABLE
from omni_vehicle_ros.sweep.study import Study
from omni_vehicle_ros.sweep.turns import COLUMNS


def render(study: Study, found: Cells, summary: str, pictures: tuple[Path, ...]) -> str:
    """Return index.html."""
    packages = ('omni_vehicle_ros.sweep', 'omni_vehicle_ros.analysis')
    environment = jinja2.Environment(
        loader=jinja2.ChoiceLoader([jinja2.PackageLoader(package) for package in packages]),
        autoescape=True, trim_blocks=True, lstrip_blocks=True, undefined=jinja2.StrictUndefined,
    )
    return environment.get_template('sweep.html.j2').render(
        study=study, summary=summary, facts=_facts(study), figures=_figures(study, found), axes=_axes(study),
        picture=next((path.name for path in pictures if path.suffix == '.svg'), None),
        over=[label(edges.axis) for edges in found.axes], columns=COLUMNS, table=TABLE, version=__version__,
    )


def _facts(study: Study) -> list[str]:
    facts = [f'{study.turns:,} turns']
    if study.grid:
        facts.append(f'grid {" × ".join(map(str, study.grid))}')
    if any(axis.distribution for axis in study.axes):
        facts.append(f'{study.samples:,} samples, {study.sampling}, seed {study.seed}')
    return facts + [f'{name} = {value}' for name, value in study.settings]


def _figures(study: Study, found: Cells) -> list[tuple[str, str]]:
    words = {
        'settled': 'Settled', 'left_linear': 'A tyre left its linear region', 'lifted': 'A wheel lifted',
        'spun': 'Spun',
    }  # fmt: skip
    return [(text, f'{100.0 * found.flags[flag] / study.turns:.2f}') for flag, text in words.items()]


def _axes(study: Study) -> list[tuple[str, str, Any]]:
    return [(axis.name, axis.text, axis.unit) for axis in study.axes]
