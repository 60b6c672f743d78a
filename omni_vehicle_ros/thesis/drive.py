"""Scenario 5, front-wheel, rear-wheel and four-wheel drive: Fig. 4.51-4.54 (thesis sec. 4.6)."""

from omni_vehicle_ros.thesis import sentences
from omni_vehicle_ros.thesis.chart import (
    COLOURS,
    SIDE_SLIP,
    SPEED,
    Chart,
    Line,
    Span,
    around,
    compared,
    steer_angles,
)
from omni_vehicle_ros.thesis.figure import Picture, ThesisFigure
from omni_vehicle_ros.thesis.tasks import Recording, Results, Run, run
from omni_vehicle_ros.thesis.words import degrees, listed, number, sentence

STRAIGHT, TURN = 'drive_straight', 'drive_in_turn'
FOUR, FRONT, REAR = 'four-wheel drive', 'front-wheel drive', 'rear-wheel drive'
SHARES = {FOUR: (0.25, 0.25, 0.25, 0.25), FRONT: (0.5, 0.5, 0.0, 0.0), REAR: (0.0, 0.0, 0.5, 0.5)}
"""Which wheels drive, and the share of each in the traction."""

TIMES = {STRAIGHT: (4.0, 6.0), TURN: (15.0, 17.0)}
TURN_RADIUS = 5.0
SETTLED = 1.0
"""When traction acts [s]; radius of the turn [m]; when its steering step is over [s]."""


def driven(scenario: str, drive: str, **values: float) -> Run:
    """Return a run by its drive."""
    return run(scenario, drive_shares=list(SHARES[drive]), **values)


def all_driven(scenario: str) -> tuple[Run, ...]:
    """Return the runs of all drives."""
    return tuple(driven(scenario, drive) for drive in SHARES)


def end(scenario: str, recording: Recording) -> int:
    """Return the row in which the traction ends."""
    return int(recording.rows(0.0, TIMES[scenario][1]).stop) - 1


def _speeds(name: str, scenario: str, caption: str) -> ThesisFigure:
    def draw(results: Results) -> Picture:
        recordings = [results[task] for task in all_driven(scenario)]
        lines = tuple(
            Line(drive, found.vx, colour, drive == REAR)
            for drive, found, colour in zip(SHARES, recordings, COLOURS, strict=True)
        )
        chart = Chart(lines, recordings[0].time, SPEED, spans=(Span(*TIMES[scenario], 'traction'),))
        ends = [
            f'{number(found.vx[end(scenario, found)])} m/s with {drive}'
            for drive, found in zip(SHARES, recordings, strict=True)
        ]
        force = recordings[0].scenario.values['force']
        return chart.picture(f'When the traction, {number(force)} N on each driven wheel, ends: {listed(ends)}.')

    return ThesisFigure(name, caption, draw, all_driven(scenario))


def _steering(results: Results) -> Picture:
    recording = results[driven(TURN, FOUR)]
    return steer_angles(recording).picture(sentence(sentences.steering(recording, TURN_RADIUS)))


def _slips(results: Results) -> Picture:
    recordings = [results[task] for task in all_driven(TURN)]
    lines = compared(tuple(SHARES), recordings)
    limits = around(lines[0].values[recordings[0].rows(SETTLED, recordings[0].time[-1])])
    chart = Chart(lines, recordings[0].time, SIDE_SLIP, spans=(Span(*TIMES[TURN], 'traction'),), limits=limits)
    ends = [
        f'{degrees(float(found.side_slip[end(TURN, found), 0]))} with {drive}'
        for drive, found in zip(SHARES, recordings, strict=True)
    ]
    return chart.picture(f'When the traction ends: {listed(ends)}.')


FIGURES = (
    _speeds('4.51', STRAIGHT, 'Forward speed on the straight with front-wheel, rear-wheel and four-wheel drive'),
    ThesisFigure('4.52', f'Steer angle of each wheel in a turn of {TURN_RADIUS:g} m', _steering, (driven(TURN, FOUR),)),
    ThesisFigure('4.53', 'Side slip of the front left tyre in a turn with each drive', _slips, all_driven(TURN)),
    _speeds('4.54', TURN, 'Forward speed in a turn with each drive'),
)
