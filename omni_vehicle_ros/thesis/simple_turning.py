"""Scenario 1, simple turning: Fig. 4.1-4.4 and 4.9-4.11 (thesis sec. 4.2); Fig. 4.5-4.8 are in `slip_maps`."""

import numpy as np
from matplotlib import colormaps

from omni_vehicle_ros.analysis.signals import Array
from omni_vehicle_ros.analysis.style import INK
from omni_vehicle_ros.thesis import sentences
from omni_vehicle_ros.thesis.chart import RADIUS, SPEED, Chart, Line, side_slips, steer_angles
from omni_vehicle_ros.thesis.figure import Picture, ThesisFigure
from omni_vehicle_ros.thesis.steady import Limits, SpeedRatios
from omni_vehicle_ros.thesis.tasks import Recording, Results, Run, km_per_h, run
from omni_vehicle_ros.thesis.words import degrees, number, percent, sentence

TURN_RADIUS = 2.0
TURN_SPEEDS = (6, 10, 14)
"""Of Fig. 4.1-4.4: radius [m] and speeds [km/h]."""

LOSS_RADII = tuple((np.arange(4, 21) / 2.0).tolist())
LOSS_SPEEDS = tuple(range(4, 25, 4))
"""Of Fig. 4.11: radii [m] and initial speeds [km/h]."""

SHOWN = 2.0  # s, after which nothing changes any more
HIGHEST = 20.0  # m/s, where the search for a limit ends
LIMIT = Limits(run('small_radius'), (TURN_RADIUS,), HIGHEST)


def turn(speed: int) -> Run:
    """Return the 2 m turn at a speed [km/h]."""
    return run('small_radius', speed=km_per_h(speed))


def loss(radius: float) -> Run:
    """Return the turn without drive at a radius [m]."""
    return run('speed_loss', radius=radius)


def ratios(radius: float) -> SpeedRatios:
    """Return what is left of the initial speeds after a turn at a radius [m]."""
    return SpeedRatios(radius, tuple(map(km_per_h, LOSS_SPEEDS)))


def until_sideways(recording: Recording) -> slice:
    """Return the rows before the vehicle first moves to the side faster than ahead: 45 deg of body side slip."""
    beyond = np.flatnonzero(np.abs(recording.vy) > np.abs(recording.vx))
    return slice(0, int(beyond[0]) if len(beyond) else len(recording.time))


def _steering(results: Results) -> Picture:
    recording = results[turn(TURN_SPEEDS[0])]
    return steer_angles(recording).picture(sentence(sentences.steering(recording, TURN_RADIUS)))


def _turn(name: str, speed: int) -> ThesisFigure:
    def draw(results: Results) -> Picture:
        recording = results[turn(speed)]
        (limit,) = results[LIMIT]
        if recording.metrics['steady']['reached'] or limit.speed is None:
            chart = side_slips(recording, within=(0.0, SHOWN), closer_from=SHOWN)
            return chart.picture(sentences.steady_turn(recording))
        rows = until_sideways(recording)
        first = side_slips(recording, within=(0.0, float(recording.time[rows.stop - 1])))
        return first.picture(
            f'No steady state at a held speed: the limit for {number(TURN_RADIUS)} m is {number(3.6 * limit.speed)} '
            'km/h. The vehicle spins; shown is what comes before it moves to the side faster than ahead, at '
            f'{number(float(recording.time[rows.stop - 1]))} s, when the front left slip is '
            f'{degrees(float(recording.side_slip[rows, 0][-1]))}.'
        )

    caption = f'Side slip of the four tyres: {TURN_RADIUS:g} m, {speed} km/h'
    return ThesisFigure(name, caption, draw, (turn(speed), LIMIT))


def _loss(name: str, radius: float) -> ThesisFigure:
    def draw(results: Results) -> Picture:
        recording = results[loss(radius)]
        speed = Line('forward', recording.vx, INK)
        first, last = float(recording.vx[0]), float(recording.vx[-1])
        return Chart((speed,), recording.time, SPEED, limits=(0.0, 1.1 * first)).picture(
            f'The speed falls from {number(first)} to {number(last)} m/s in {number(recording.time[-1])} s: '
            f'{percent(last / first, 3)} of it is left.'
        )

    caption = f'Forward speed in a turn of {radius:g} m without drive'
    return ThesisFigure(name, caption, draw, (loss(radius),))


def _ratios(results: Results) -> Picture:
    found = np.array([results[ratios(radius)] for radius in LOSS_RADII])
    shades = colormaps['viridis_r'](np.linspace(0.1, 1.0, len(LOSS_SPEEDS)))
    lines = tuple(Line(f'{speed} km/h', found[:, i], tuple(shades[i])) for i, speed in enumerate(LOSS_SPEEDS))
    row, column = np.unravel_index(int(np.argmin(found)), found.shape)
    return Chart(lines, np.array(LOSS_RADII), 'speed after 10 s / at the start [1]', RADIUS).picture(
        f'{_order(found)} Least is left at {number(LOSS_RADII[row])} m and {LOSS_SPEEDS[column]} km/h: '
        f'{percent(float(found[row, column]), 3)}.'
    )


def _order(found: Array) -> str:
    radius = 'rises' if np.all(np.diff(found, axis=0) > 0.0) else 'does not always rise'
    speed = 'falls' if np.all(np.diff(found, axis=1) < 0.0) else 'does not always fall'
    return f'The share {radius} with the radius and {speed} with the initial speed.'


FIGURES = (
    ThesisFigure(
        '4.1', f'Steer angle of each wheel in a turn of {TURN_RADIUS:g} m', _steering, (turn(TURN_SPEEDS[0]),)
    ),
    *(_turn(f'4.{2 + i}', speed) for i, speed in enumerate(TURN_SPEEDS)),
)
LOSS_FIGURES = (
    _loss('4.9', 5.0),
    _loss('4.10', 10.0),
    ThesisFigure(
        '4.11',
        'Share of its speed that a vehicle keeps in 10 s of turning without drive, over radius and initial speed',
        _ratios,
        tuple(map(ratios, LOSS_RADII)),
    ),
)
