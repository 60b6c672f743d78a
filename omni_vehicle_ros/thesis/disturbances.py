"""Scenario 3, disturbances: Fig. 4.19-4.24 and 4.28-4.34, of bank, wind and friction (thesis sec. 4.4).

The lateral force coefficient and the diagrams of the aerodynamic centre, Fig. 4.25-4.27, are in `aerodynamics`.
"""

import numpy as np

from omni_vehicle_ros.analysis.signals import BAND, WINDOW, StepMetrics
from omni_vehicle_ros.thesis import sentences
from omni_vehicle_ros.thesis.chart import SIDE_SLIP, Chart, Range, Span, around, compared, side_slips, steer_angles
from omni_vehicle_ros.thesis.figure import Picture, ThesisFigure
from omni_vehicle_ros.thesis.tasks import Recording, Results, Run, km_per_h, run
from omni_vehicle_ros.thesis.words import degrees, listed, number, percent, sentence, wheel_words
from omni_vehicle_ros.wheels import WHEELS

BEGIN, END = 10.0, 12.0
SHOWN: Range = (9.5, 14.0)
FRICTION_SHOWN = 2.0
"""When a disturbance acts, and what is drawn of it and of the turns [s]."""

WIND, CENTRES = 2.0, (0.0, 0.1, -0.1)
FRICTIONS, FRICTION_RADIUS, FRICTION_SPEED = (0.9, 0.5), 10.0, 20
SLOW, FAST = 20, 80
"""Wind [m/s] and aerodynamic centres ahead of the centre of gravity [m]; radius [m] and speeds [km/h]."""


def bank(angle: float, speed: int) -> Run:
    """Return the run over a bank [rad] at a speed [km/h]."""
    return run('bank', bank=angle, speed=km_per_h(speed), duration=SHOWN[1])


def wind(strength: float, speed: int, centre: float = 0.0) -> Run:
    """Return the run through a wind [m/s] at a speed [km/h] with an aerodynamic centre [m]."""
    return run('wind', wind=strength, speed=km_per_h(speed), aerodynamic_centre=centre, duration=SHOWN[1])


def friction(coefficient: float) -> Run:
    """Return the turn on a road of this friction."""
    return run('friction', friction=coefficient)


def responses(recording: Recording) -> list[StepMetrics]:
    """Return how each tyre answers the begin of a disturbance, by what it does until its end."""
    return [recording.step(wheel, BEGIN, END) for wheel in range(4)]


def _disturbed(name: str, caption: str, task: Run, words: str, note: str = '') -> ThesisFigure:
    def draw(results: Results) -> Picture:
        recording = results[task]
        steps = responses(recording)
        steady = [step.steady_state for step in steps]
        settled = (
            f'They settle at {sentences.each_wheel(steady)}. {sentences.response(steps)}'
            if None not in steady
            else _changing(recording, steps)
        )
        chart = side_slips(recording, (Span(BEGIN, END, words),), SHOWN)
        peaks = sentences.each_wheel([step.peak for step in steps])
        return chart.picture(f'The slips reach {peaks}. {settled}{note}')

    return ThesisFigure(name, caption, draw, (task,))


def _changing(recording: Recording, steps: list[StepMetrics]) -> str:
    """Say which slips have no steady state before the disturbance ends, and by how much they still change."""
    slips = recording.side_slip[recording.rows(END - WINDOW, END)]
    shares = np.ptp(slips, axis=0) / np.abs(np.mean(slips, axis=0))
    words = [
        f'{wheel_words(wheel)} by {percent(share, 3)}'
        for wheel, share, step in zip(WHEELS, shares.tolist(), steps, strict=True)
        if step.steady_state is None
    ]
    return (
        f'Over the last {number(WINDOW)} s before it ends the slip still changes at {listed(words)}, more than the '
        f'{percent(BAND)} of a steady state; the claims hold it longer.'
    )


def _bank(name: str, angle: float, speed: int) -> ThesisFigure:
    caption = f'Side slip of the four tyres on a bank of {number(angle)} rad at {speed} km/h'
    return _disturbed(name, caption, bank(angle, speed), 'bank')


def _wind(name: str, strength: float, speed: int) -> ThesisFigure:
    caption = f'Side slip of the four tyres in a lateral wind of {number(strength)} m/s at {speed} km/h'
    note = f' The caption of the thesis says {speed} m/s; by its Table 4.2 it means km/h.'
    return _disturbed(name, caption, wind(strength, speed), 'wind', note)


def _centres(results: Results) -> Picture:
    recordings = [results[wind(WIND, SLOW, centre)] for centre in CENTRES]
    rows = recordings[0].rows(*SHOWN)
    lines = compared(tuple(f'lw = {number(centre)} m' for centre in CENTRES), recordings)
    cut = tuple(line._replace(values=line.values[rows]) for line in lines)
    chart = Chart(cut, recordings[0].time[rows], SIDE_SLIP, spans=(Span(BEGIN, END, 'wind'),))
    peaks = [
        f'{degrees(found.step(0, BEGIN, END).peak)} for lw = {number(centre)} m'
        for centre, found in zip(CENTRES, recordings, strict=True)
    ]
    return chart.picture(f'The slip of the front left tyre reaches {listed(peaks)}.')


def _steering(results: Results) -> Picture:
    recording = results[friction(FRICTIONS[0])]
    return steer_angles(recording).picture(sentence(sentences.steering(recording, FRICTION_RADIUS)))


def _frictions(results: Results) -> Picture:
    recordings = [results[friction(coefficient)] for coefficient in FRICTIONS]
    lines = compared(tuple(f'friction {coefficient:g}' for coefficient in FRICTIONS), recordings)
    rows = recordings[0].rows(0.0, FRICTION_SHOWN)
    lines = tuple(line._replace(values=line.values[rows]) for line in lines)
    closer = around(np.array([line.values[len(line.values) // 2 :] for line in lines]))
    steps = [found.step(0) for found in recordings]
    each = [
        f'steady {degrees(step.steady_state)}, overshoot {number(100.0 * (step.overshoot or 0.0))} %, settling time '
        f'{number(step.settling_time)} s on {coefficient:g}'
        for coefficient, step in zip(FRICTIONS, steps, strict=True)
    ]
    chart = Chart(lines, recordings[0].time[rows], SIDE_SLIP, closer=closer)
    return chart.picture(f'Front left tyre: {"; ".join(each)}.')


FIGURES = (
    _bank('4.19', 0.01, SLOW),
    _bank('4.20', -0.01, SLOW),
    _bank('4.21', 0.01, FAST),
    _bank('4.22', -0.01, FAST),
    _bank('4.23', 0.02, SLOW),
    _bank('4.24', -0.02, SLOW),
)
WIND_FIGURES = (
    _wind('4.28', WIND, SLOW),
    _wind('4.29', -WIND, SLOW),
    _wind('4.30', WIND, FAST),
    _wind('4.31', -WIND, FAST),
    ThesisFigure(
        '4.32',
        f'Side slip of the front left tyre in a lateral wind at {SLOW} km/h, with the aerodynamic centre at, ahead '
        'of and behind the centre of gravity (lw)',
        _centres,
        tuple(wind(WIND, SLOW, centre) for centre in CENTRES),
    ),
)
FRICTION_FIGURES = (
    ThesisFigure(
        '4.33', f'Steer angle of each wheel in a turn of {FRICTION_RADIUS:g} m', _steering, (friction(FRICTIONS[0]),)
    ),
    ThesisFigure(
        '4.34',
        f'Side slip of the front left tyre in a turn of {FRICTION_RADIUS:g} m at {FRICTION_SPEED} km/h on a dry '
        'road and on snow',
        _frictions,
        tuple(map(friction, FRICTIONS)),
    ),
)
