"""The page ``docs/controllers.md``: the controllers compared, and what can be won."""

from pathlib import Path
from typing import Any

from omni_vehicle_ros.parameters import VehicleParameters
from omni_vehicle_ros.thesis import controllers
from omni_vehicle_ros.thesis.bounds import TRACTION, Bound, SlipBound, linear_bounds
from omni_vehicle_ros.thesis.files import draw
from omni_vehicle_ros.thesis.manoeuvres import CONTROLLERS, MANOEUVRES, Judgement, Trial
from omni_vehicle_ros.thesis.pages import render
from omni_vehicle_ros.thesis.tasks import Results, Task
from omni_vehicle_ros.thesis.trade_off import RADIUS, SPEED
from omni_vehicle_ros.thesis.words import NONE, degrees, listed, number

BOUNDS = tuple(SlipBound(RADIUS, SPEED, traction) for traction in TRACTION)
TASKS: tuple[Task[Any], ...] = tuple(
    dict.fromkeys((*BOUNDS, *(task for figure in controllers.SECTION.figures for task in figure.needs)))
)
_EQUAL = 1e-3  # of a slip


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
        gust=gust_words(results),
    )
    (directory / 'controllers.md').write_text(page, encoding='utf-8')


def gust_words(results: Results) -> str:
    """Return what the controllers make of the gust, in words."""
    found = {controller.name: results[Trial(MANOEUVRES[-1], controller)] for controller in CONTROLLERS}
    none, moment = found['none'], found['yaw moment']
    steering, every = found['allocation, steering'], found['allocation, all']
    wheel_slips = [found[name].worst_slip for name in found if name.startswith('wheel slip')]
    change = 'larger' if min(wheel_slips) > none.worst_slip else 'not larger'
    same = abs(every.worst_slip / steering.worst_slip - 1.0) < _EQUAL
    return (
        'In the gust less slip and the path are at odds. Without control the vehicle turns away from the wind, which '
        f'relieves its tyres, and ends {_slip_and_path(none)}. Who keeps the path holds the wind: `allocation` by '
        f'steering, {_slip_and_path(steering)}; `yaw_moment` by more traction on one side, {_slip_and_path(moment)}. '
        'Traction serves `allocation` to level the slips of the axles in a turn; straight on there is none, and with '
        f'it the worst slip is {"the same" if same else degrees(every.worst_slip)}. `wheel_slip` makes the worst slip '
        f'{change}, {listed([degrees(slip) for slip in wheel_slips])}: front tyres that yield let the wind swing the '
        'vehicle farther, and the rear tyres slip more.'
    )


def _slip_and_path(judgement: Judgement) -> str:
    return f'{number(judgement.path_error)} m off the path with a worst slip of {degrees(judgement.worst_slip)}'


def _cell(value: float | str) -> str:
    return value if isinstance(value, str) else number(value) or NONE


def _words(bound: Bound) -> dict[str, str]:
    return {'worst': degrees(bound.worst), 'friction_use': number(bound.friction_use, 2)}
