"""Scenario 2, traction and brake in a turn: Fig. 4.12-4.18 (thesis sec. 4.3)."""

import math
from typing import NamedTuple

import numpy as np

from omni_vehicle_ros.analysis.style import INK
from omni_vehicle_ros.thesis import sentences
from omni_vehicle_ros.thesis.chart import (
    SIDE_SLIP,
    SPEED,
    Chart,
    Line,
    Span,
    around,
    compared,
    side_slips,
    steer_angles,
)
from omni_vehicle_ros.thesis.figure import Picture, ThesisFigure
from omni_vehicle_ros.thesis.tasks import Recording, Results, Run, run
from omni_vehicle_ros.thesis.words import degrees, number, percent

TRACTION, BRAKE = 'traction_in_turn', 'brake_in_turn'
START, ROLLING, TURNING, ACTING, FREE = 4.0, 6.0, 10.0, 15.0, 17.0
"""Times [s]: from rest, from then on rolling, turning, with traction or brake, and without again."""

TURN_RADIUS = 5.0  # m
SETTLED = 0.5  # s after the steering step
SEEN = 1e-6  # rad, the least difference of two runs
_WORDS = {TRACTION: 'traction', BRAKE: 'brake'}


def with_circle(scenario: str) -> Run:
    """Return the run whose tyres know the friction circle."""
    return run(scenario)


def without_circle(scenario: str) -> Run:
    """Return the run whose tyres give their side force whatever they pull."""
    return run(scenario, **{'vehicle.friction_circle': 'false'})


def acting(scenario: str) -> Span:
    """Return the time in which traction or brake acts while turning."""
    return Span(ACTING, FREE, _WORDS[scenario])


def at(recording: Recording, time: float) -> int:
    """Return the row of a time [s]."""
    return int(recording.rows(0.0, time).stop) - 1


class Difference(NamedTuple):
    """By how much the front left slip of one run is larger than that of another, at most.

    ``slip``: the largest difference of the sizes [rad]; ``share``: of the other slip; ``time``: when it is [s];
    ``begin``: from when on they differ [s], inf if they don't.
    """

    slip: float
    share: float
    time: float
    begin: float

    def __str__(self) -> str:
        """Return it in words."""
        return f'{"larger" if self.slip > 0.0 else "smaller"} by {degrees(abs(self.slip))}'


def difference(one: Recording, other: Recording, begin: float, end: float) -> Difference:
    """Return the largest difference of the front left slips of two runs between two times [s]."""
    rows = one.rows(begin, end)
    size = np.abs(other.side_slip[rows, 0])
    change = np.abs(one.side_slip[rows, 0]) - size
    largest = int(np.argmax(np.abs(change)))
    seen = np.flatnonzero(np.abs(change) > SEEN)
    first = float(one.time[rows][seen[0]]) if len(seen) else math.inf
    return Difference(
        float(change[largest]), float(change[largest] / size[largest]), float(one.time[rows][largest]), first
    )


def _steering(results: Results) -> Picture:
    recording = results[with_circle(TRACTION)]
    sentence = f'Straight on until {number(TURNING)} s, then {sentences.steering(recording, TURN_RADIUS)}'
    return steer_angles(recording).picture(sentence)


def _slips(name: str, scenario: str) -> ThesisFigure:
    def draw(results: Results) -> Picture:
        recording = results[with_circle(scenario)]
        chart = side_slips(recording, (acting(scenario),), closer_from=TURNING + SETTLED)
        before, after = at(recording, ACTING), at(recording, FREE)
        return chart.picture(
            f'Before {number(ACTING)} s: {sentences.each_wheel(recording.side_slip[before].tolist())}; at '
            f'{number(FREE)} s: {sentences.each_wheel(recording.side_slip[after].tolist())}. The speed goes from '
            f'{number(recording.vx[before])} to {number(recording.vx[after])} m/s meanwhile.'
        )

    caption = f'Side slip of the four tyres in a turn of {TURN_RADIUS:g} m with {_WORDS[scenario]}'
    return ThesisFigure(name, caption, draw, (with_circle(scenario),))


def _speed(name: str, scenario: str) -> ThesisFigure:
    def draw(results: Results) -> Picture:
        recording = results[with_circle(scenario)]
        spans = (Span(START, ROLLING, 'traction'), acting(scenario))
        chart = Chart((Line('forward', recording.vx, INK),), recording.time, SPEED, spans=spans)
        speeds = [recording.vx[at(recording, time)] for time in (TURNING, ACTING, FREE, recording.time[-1])]
        return chart.picture(
            f'{number(speeds[0])} m/s ({number(3.6 * speeds[0])} km/h) on the straight, {number(speeds[1])} m/s '
            f'after {number(ACTING - TURNING)} s of turning, {number(speeds[2])} m/s after the {_WORDS[scenario]} '
            f'and {number(speeds[3])} m/s at the end.'
        )

    return ThesisFigure(name, f'Forward speed with {_WORDS[scenario]} in the turn', draw, (with_circle(scenario),))


def _circle(name: str, scenario: str) -> ThesisFigure:
    def draw(results: Results) -> Picture:
        one, other = results[with_circle(scenario)], results[without_circle(scenario)]
        lines = compared(('with friction circle', 'without'), (one, other))
        limits = around(lines[0].values[one.rows(TURNING + SETTLED, one.time[-1])])
        chart = Chart(lines, one.time, SIDE_SLIP, spans=(acting(scenario),), limits=limits, difference=True)
        return chart.picture(_circle_sentence(one, other))

    caption = f'Side slip of the front left tyre with {_WORDS[scenario]}, with and without the friction circle'
    return ThesisFigure(name, caption, draw, (with_circle(scenario), without_circle(scenario)))


def _circle_sentence(one: Recording, other: Recording) -> str:
    during = difference(one, other, ACTING, FREE)
    after = difference(one, other, FREE + SETTLED, float(one.time[-1]))
    return (
        f'With the friction circle the slip is {during} at most ({percent(abs(during.share))}), at '
        f'{number(during.time)} s. Until {number(during.begin)} s it is the same: a tyre in its linear region does not '
        f'feel what it could hold at most. From {number(FREE + SETTLED)} s on it is {after} at most.'
    )


FIGURES = (
    ThesisFigure(
        '4.12', 'Steer angle of each wheel: straight on, then a turn of 5 m', _steering, (with_circle(TRACTION),)
    ),
    _slips('4.13', TRACTION),
    _speed('4.14', TRACTION),
    _circle('4.15', TRACTION),
    _slips('4.16', BRAKE),
    _speed('4.17', BRAKE),
    _circle('4.18', BRAKE),
)
