"""Up to which speed slow driving leads to a steady turn: the limit of each radius, on a dry road and on snow."""

from dataclasses import dataclass
from typing import NamedTuple

from omni_vehicle_ros.model.steady_turn import Limit
from omni_vehicle_ros.thesis.steady import branch
from omni_vehicle_ros.thesis.tasks import Results, Run, run
from omni_vehicle_ros.thesis.words import number

FRICTIONS = (0.9, 0.5)
RADII = tuple(float(radius) for radius in range(2, 11))
TOP_SPEED = 40.0  # m/s

_CAUSES = {
    'fold': 'the steady turn that slow driving leads to ends',
    'divergence': 'the vehicle diverges',
    'oscillation': 'the vehicle oscillates more and more',
    'skid': 'the vehicle skids sideways',
    'lift': 'a wheel lifts',
}


class LimitTurns(NamedTuple):
    """The limit of a radius, and the radius of the path [m] at its speeds, None where there is no such speed."""

    limit: Limit
    at_limit: float | None
    at_most_grip: float | None
    at_slide: float | None


@dataclass(frozen=True)
class LimitPaths:
    """The limits of the turns of a study, with the paths of the vehicle there.

    Attributes
    ----------
    study
        Whose vehicle and road count.
    radii
        Of the turns [m].
    top_speed
        Where the search ends [m/s].
    """

    study: Run
    radii: tuple[float, ...]
    top_speed: float

    def work(self) -> tuple[LimitTurns, ...]:
        """Find them."""
        return tuple(self._limit_turns(radius) for radius in self.radii)

    def _limit_turns(self, radius: float) -> LimitTurns:
        turns = branch(self.study, radius, self.top_speed)
        speeds = turns.limit.speed, turns.limit.grip_speed, turns.limit.slide_speed
        found = (turns.turn(speed) if speed else None for speed in speeds)
        return LimitTurns(turns.limit, *(turn.path_radius if turn else None for turn in found))


TASKS = tuple(
    LimitPaths(run('turning_map', **{'plant.friction': [friction] * 4}), RADII, TOP_SPEED) for friction in FRICTIONS
)
"""Of a dry road and of snow; radii of the thesis [m]; where the search ends."""


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


def _in_words(turns: LimitTurns) -> str:
    speed, cause, grip_speed, slide_speed = turns.limit
    if speed is None or cause is None:
        words = [f'none up to {number(3.6 * TOP_SPEED)} km/h']
    else:
        words = [f'{_place(speed, turns.at_limit)}: {_CAUSES[cause]}']
    if grip_speed is not None:
        words.append(f'from {_place(grip_speed, turns.at_most_grip)} on it only runs wide')
    if slide_speed is not None:
        words.append(f'from {_place(slide_speed, turns.at_slide)} on both tyres of an axle slide')
    return '; '.join(words)


def _place(speed: float, path_radius: float | None) -> str:
    return f'{number(3.6 * speed)} km/h (path {number(path_radius)} m)'
