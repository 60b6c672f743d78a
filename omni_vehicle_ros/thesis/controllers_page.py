"""The page ``docs/controllers.md``: the controllers compared, and what can be won."""

from pathlib import Path
from typing import Any

from omni_vehicle_ros.parameters import VehicleParameters
from omni_vehicle_ros.thesis import controllers
from omni_vehicle_ros.thesis.bounds import TRACTION, Bound, SlipBound, linear_bounds
from omni_vehicle_ros.thesis.files import draw
from omni_vehicle_ros.thesis.pages import render
from omni_vehicle_ros.thesis.tasks import Results, Task
from omni_vehicle_ros.thesis.trade_off import RADIUS, SPEED
from omni_vehicle_ros.thesis.words import NONE, degrees, number

BOUNDS = tuple(SlipBound(RADIUS, SPEED, traction) for traction in TRACTION)
TASKS: tuple[Task[Any], ...] = tuple(
    dict.fromkeys((*BOUNDS, *(task for figure in controllers.SECTION.figures for task in figure.needs)))
)


def write_controllers_page(results: Results, directory: Path) -> None:
    """Write ``controllers.md`` and its pictures.

    Parameters
    ----------
    results
        Of `TASKS`.
    directory
        Where to; the data of a picture lie beside it as CSV.
    """
    shown = [(figure, draw(figure, results, directory).sentence) for figure in controllers.SECTION.figures]
    table = controllers.controller_table(results)
    names = list(table)
    texts = [list(map(_cell, column.tolist())) for column in table.values()]
    linear = linear_bounds(VehicleParameters(), RADIUS, SPEED)
    equal, sides, free = (_words(results[bound]) for bound in BOUNDS)
    page = render(
        'controllers.md.j2',
        pictures=shown,
        measures=[name.replace('[deg', '[°') for name in names[2:]],
        rows=list(zip(*texts, strict=True)),
        radius=number(RADIUS),
        speed=number(3.6 * SPEED),
        linear=[degrees(slip) for slip in linear],
        steering=equal,
        every=sides,
        free=free,
    )
    (directory / 'controllers.md').write_text(page, encoding='utf-8')


def _cell(value: float | str) -> str:
    return value if isinstance(value, str) else number(value) or NONE


def _words(bound: Bound) -> dict[str, str]:
    return {'worst': degrees(bound.worst), 'friction_use': number(bound.friction_use, 2)}
