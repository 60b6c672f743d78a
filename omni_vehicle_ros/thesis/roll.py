"""Scenario 4, what roll does to the side slip: Fig. 4.35-4.50 (thesis sec. 4.5)."""

import numpy as np

from omni_vehicle_ros.analysis.signals import Array
from omni_vehicle_ros.thesis.chart import COLOURS, NO_TURN, RADIUS, SIDE_SLIP, Chart, Line, Span
from omni_vehicle_ros.thesis.figure import Picture, ThesisFigure
from omni_vehicle_ros.thesis.slip_maps import MAP, RADII
from omni_vehicle_ros.thesis.steady import SlipMapTask
from omni_vehicle_ros.thesis.tasks import Results, km_per_h, run
from omni_vehicle_ros.thesis.words import degrees, number, percent, wheel_words
from omni_vehicle_ros.wheels import WHEELS

LOAD_TRANSFER, ROLL_STEER = 'load transfer', 'roll steer'
SPEEDS = (10, 20)
"""Of the turns [km/h]."""

_WITHOUT = {
    effect: SlipMapTask(study, RADII, tuple(map(km_per_h, SPEEDS)))
    for effect, study in (
        (LOAD_TRANSFER, run('load_transfer', **{'vehicle.load_transfer': 'false'})),
        (ROLL_STEER, run('roll_steer', roll_steer=0.0)),
    )
}


def tasks(effect: str) -> tuple[SlipMapTask, SlipMapTask]:
    """Return the steady slips with an effect and without it."""
    return MAP, _WITHOUT[effect]


def with_and_without(results: Results, effect: str, speed: int) -> tuple[Array, Array]:
    """Return the steady slips with an effect and without it at a speed [km/h], shape (radii, 4) [rad]."""
    one, other = (results[task].side_slip[:, task.speeds.index(km_per_h(speed))] for task in tasks(effect))
    return one, other


def _figure(number_: str, effect: str, speed: int, wheel: int) -> ThesisFigure:
    def draw(results: Results) -> Picture:
        one, other = (found[:, wheel] for found in with_and_without(results, effect, speed))
        radii = np.array(RADII)
        lines = (
            Line(f'with {effect}', np.degrees(one), COLOURS[0]),
            Line('without', np.degrees(other), COLOURS[1], dashed=True),
        )
        first = radii[np.isfinite(one) | np.isfinite(other)][0]
        spans = (Span(radii[0], float(first), NO_TURN),) if first > radii[0] else ()
        chart = Chart(lines, radii, SIDE_SLIP, RADIUS, spans=spans, difference=True)
        return chart.picture(_sentence(effect, one, other))

    caption = f'Steady side slip of the {wheel_words(WHEELS[wheel])} tyre with and without {effect} at {speed} km/h'
    return ThesisFigure(number_, caption, draw, tasks(effect))


def _sentence(effect: str, one: Array, other: Array) -> str:
    both = np.flatnonzero(np.isfinite(one) & np.isfinite(other))
    words = []
    for row in (both[0], both[-1]):
        change = float(one[row] - other[row])
        words.append(f'{degrees(change)} ({percent(change / float(other[row]))}) at {number(RADII[row])} m')
    gaps = [float(RADII[int(np.flatnonzero(np.isfinite(found))[0])]) for found in (one, other)]
    tight = (
        f' The tightest steady turn of slow driving is {number(gaps[0])} m with it and {number(gaps[1])} m without.'
        if max(gaps) > RADII[0]
        else ''
    )
    return f'{effect[0].upper()}{effect[1:]} changes the slip by {words[0]} and by {words[1]}.{tight}'


FIGURES = tuple(
    _figure(f'4.{35 + 8 * i + 4 * j + wheel}', effect, speed, wheel)
    for i, effect in enumerate(_WITHOUT)
    for j, speed in enumerate(SPEEDS)
    for wheel in range(4)
)
