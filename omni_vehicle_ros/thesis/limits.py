"""Up to which speed slow driving leads to a steady turn: the limit of each radius, on a dry road and on snow."""

from typing import NamedTuple

from omni_vehicle_ros.model.steady_turn import Limit
from omni_vehicle_ros.thesis.steady import Limits
from omni_vehicle_ros.thesis.tasks import Results, run
from omni_vehicle_ros.thesis.words import number

FRICTIONS = (0.9, 0.5)
RADII = tuple(float(radius) for radius in range(2, 11))
TOP_SPEED = 40.0  # m/s
TASKS = tuple(
    Limits(run('turning_map', **{'plant.friction': [friction] * 4}), RADII, TOP_SPEED) for friction in FRICTIONS
)
"""Of a dry road and of snow; radii of the thesis [m]; where the search ends."""

_CAUSES = {
    'fold': 'the steady turn that slow driving leads to ends',
    'divergence': 'the vehicle diverges',
    'oscillation': 'the vehicle oscillates more and more',
    'sliding': 'both tyres of an axle slide',
    'lift': 'a wheel lifts',
}


class LimitRow(NamedTuple):
    """A radius with the limit on each road, in words."""

    radius: str
    limits: tuple[str, ...]


def rows(results: Results) -> list[LimitRow]:
    """Return the limits of all radii."""
    found = zip(*(results[task] for task in TASKS), strict=True)
    return [
        LimitRow(f'{number(radius)} m', tuple(map(_in_words, limits)))
        for radius, limits in zip(RADII, found, strict=True)
    ]


def _in_words(limit: Limit) -> str:
    if limit.speed is None:
        return f'none up to {number(3.6 * TOP_SPEED)} km/h'
    wide = (
        f'; from {number(3.6 * limit.grip_speed)} km/h on it only runs wide'
        if limit.grip_speed is not None and limit.grip_speed < limit.speed * (1.0 - 1e-6)
        else ''
    )
    return f'{number(3.6 * limit.speed)} km/h: {_CAUSES[limit.cause or "fold"]}{wide}'
