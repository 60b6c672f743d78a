"""Scenario 6, side-slip control: Fig. 5.3-5.13 (thesis sec. 5.2); the diagrams 5.1 and 5.2 are in `block_diagrams`."""

import numpy as np
from matplotlib.figure import Figure

from omni_vehicle_ros.analysis.signals import Array
from omni_vehicle_ros.analysis.style import ACCENT, INK
from omni_vehicle_ros.thesis import sentences
from omni_vehicle_ros.thesis.chart import DASHED, SIDE_SLIP, TIME, Chart, Line, around, legend, steer_angles
from omni_vehicle_ros.thesis.figure import Picture, ThesisFigure
from omni_vehicle_ros.thesis.tasks import Recording, Results, Run, run
from omni_vehicle_ros.thesis.words import degrees, number, percent, sentence, wheel_words
from omni_vehicle_ros.wheels import WHEELS, PerWheel

NO_GAINS: PerWheel = (0.0, 0.0, 0.0, 0.0)
FIRST_GAINS: PerWheel = (5.0, 5.0, 0.0, 0.0)
SECOND_GAINS: PerWheel = (5.0, 1.0, 0.0, 0.0)
TURN_RADIUS = 5.0
"""Proportional gains of the thesis, fl, fr, rl, rr: without control, at first, revised. Radius [m]."""

_SHOWN, _STEERED = 3.0, 0.3  # s, what is drawn; when the steering step is over
_LOOKS = (
    ('without control', INK, False),
    ('with control', ACCENT, False),
    ('without, real actuators', INK, True),
    ('with, real actuators', ACCENT, True),
)


def exact(gains: PerWheel) -> Run:
    """Return the run in which the slips are solved for together with the trims, without any lag."""
    return run('side_slip_control', gains=list(gains), **{'wheel_module.ideal_actuators': 'true'})


def real_actuators(gains: PerWheel) -> Run:
    """Return the run of the real loop: measured once a cycle, steered by actuators that take their time."""
    return run('side_slip_control', gains=list(gains))


def runs(gains: PerWheel) -> tuple[Run, Run, Run, Run]:
    """Return what a figure compares: without control and with it, solved exactly, then both with real actuators."""
    return exact(NO_GAINS), exact(gains), real_actuators(NO_GAINS), real_actuators(gains)


def path_distance(one: Recording, other: Recording) -> Array:
    """Return how far two vehicles are from each other at the same time [m], shape (n,)."""
    return np.hypot(one.x - other.x, one.y - other.y)


def _said(gains: PerWheel) -> str:
    return f'({", ".join(f"{gain:g}" for gain in gains)})'


def _steering(results: Results) -> Picture:
    recording = results[exact(NO_GAINS)]
    return steer_angles(recording).picture(sentence(sentences.steering(recording, TURN_RADIUS)))


def _slip(name: str, gains: PerWheel, wheel: int) -> ThesisFigure:
    def draw(results: Results) -> Picture:
        recordings = [results[task] for task in runs(gains)]
        rows, steered = recordings[0].rows(0.0, _SHOWN), recordings[0].rows(_STEERED, _SHOWN)
        slips = np.degrees([found.side_slip[:, wheel] for found in recordings])
        lines = tuple(
            Line(label, values[rows], colour, dashed)
            for (label, colour, dashed), values in zip(_LOOKS, slips, strict=True)
        )
        chart = Chart(lines, recordings[0].time[rows], SIDE_SLIP, closer=around(slips[:, steered]))
        return chart.picture(_slip_sentence(recordings, wheel))

    caption = f'Side slip of the {wheel_words(WHEELS[wheel])} tyre without control and with the gains {_said(gains)}'
    return ThesisFigure(name, caption, draw, runs(gains))


def _slip_sentence(recordings: list[Recording], wheel: int) -> str:
    words = []
    for form, pair in (('Solved exactly', recordings[:2]), ('with real actuators', recordings[2:])):
        before, after = (found.step(wheel) for found in pair)
        words.append(
            f'{form}, the steady slip goes from {degrees(before.steady_state)} to {degrees(after.steady_state)}, '
            f'the overshoot from {percent(before.overshoot)} to {percent(after.overshoot)}, the settling time from '
            f'{number(before.settling_time)} to {number(after.settling_time)} s'
        )
    return f'{"; ".join(words)}.'


def _path(name: str, gains: PerWheel) -> ThesisFigure:
    def draw(results: Results) -> Picture:
        recordings = [results[task] for task in runs(gains)]
        figure = Figure(figsize=(5.6, 5.0), layout='constrained')
        axes = figure.subplots()
        table = {TIME: recordings[0].time}
        for (label, colour, dashed), found in zip(_LOOKS, recordings, strict=True):
            axes.plot(found.x, found.y, color=colour, label=label, **(DASHED if dashed else {}))
            axes.plot(found.x[-1], found.y[-1], 'o', color=colour, markersize=4.0)
            table |= {f'{label}: x [m]': found.x, f'{label}: y [m]': found.y}
        axes.set(xlabel='x [m]', ylabel='y [m]', aspect='equal')
        legend(axes)
        return Picture(figure, _path_sentence(recordings), table)

    caption = f'Path of the vehicle without control and with the gains {_said(gains)}, {TURN_RADIUS:g} m commanded'
    return ThesisFigure(name, caption, draw, runs(gains))


def _path_sentence(recordings: list[Recording]) -> str:
    radii = [number(found.metrics['path']['radius']) for found in recordings]
    gaps = [float(path_distance(one, other).max()) for one, other in (recordings[:2], recordings[2:])]
    return (
        f'The radius of the path goes from {radii[0]} to {radii[1]} m, with real actuators from {radii[2]} to '
        f'{radii[3]} m; at the same time the vehicles are up to {number(gaps[0])} m apart, with real actuators '
        f'{number(gaps[1])} m.'
    )


FIGURES = (
    ThesisFigure(
        '5.3',
        f'Steer angle of each wheel in a turn of {TURN_RADIUS:g} m without control',
        _steering,
        (exact(NO_GAINS),),
    ),
    *(_slip(f'5.{4 + wheel}', FIRST_GAINS, wheel) for wheel in range(4)),
    _path('5.8', FIRST_GAINS),
    *(_slip(f'5.{9 + wheel}', SECOND_GAINS, wheel) for wheel in range(4)),
    _path('5.13', SECOND_GAINS),
)
