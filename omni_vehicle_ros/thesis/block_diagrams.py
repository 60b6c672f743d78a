"""Block diagrams of the side-slip controller: Fig. 5.1 and 5.2 (thesis sec. 5.2)."""

from typing import TYPE_CHECKING

from matplotlib.figure import Figure
from matplotlib.patches import Circle, FancyArrowPatch, FancyBboxPatch

from omni_vehicle_ros.analysis.style import ACCENT, INK, PAPER
from omni_vehicle_ros.control.side_slip import exact_side_slip
from omni_vehicle_ros.thesis.figure import Picture, ThesisFigure
from omni_vehicle_ros.thesis.side_slip_control import FIRST_GAINS, real_actuators
from omni_vehicle_ros.thesis.tasks import Results
from omni_vehicle_ros.thesis.words import number, percent

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Place = tuple[float, float]
_SUM = 0.16  # radius of the circle in which signals are added
_INCH = 0.72  # of a unit of the drawing


def _canvas(width: float, height: float) -> tuple[Figure, 'Axes']:
    figure = Figure(figsize=(_INCH * width, _INCH * height), layout='constrained')
    axes = figure.subplots()
    axes.set(xlim=(0.0, width), ylim=(0.0, height), aspect='equal')
    axes.axis('off')
    return figure, axes


def _block(axes: 'Axes', centre: Place, size: Place, words: str, colour: str = INK) -> None:
    corner = (centre[0] - 0.5 * size[0], centre[1] - 0.5 * size[1])
    shape = FancyBboxPatch(
        corner, *size, boxstyle='round,pad=0.0,rounding_size=0.12', facecolor=PAPER, edgecolor=colour
    )
    axes.add_patch(shape)
    axes.text(*centre, words, ha='center', va='center', color=colour, fontsize=8.5)


def _sum(axes: 'Axes', centre: Place) -> None:
    axes.add_patch(Circle(centre, _SUM, facecolor=PAPER, edgecolor=INK, zorder=3))


def _wire(axes: 'Axes', *places: Place, colour: str = INK) -> None:
    """Draw a signal from place to place, with an arrow at the end."""
    axes.plot(*zip(*places, strict=True), color=colour, linewidth=1.1)
    arrow = FancyArrowPatch(
        places[-2],
        places[-1],
        arrowstyle='-|>',
        mutation_scale=9.0,
        shrinkA=0.0,
        shrinkB=0.0,
        color=colour,
        linewidth=0.0,
    )
    axes.add_patch(arrow)


def _words(axes: 'Axes', place: Place, words: str, colour: str = INK, side: str = 'center') -> None:
    axes.text(*place, words, ha=side, va='bottom', color=colour, fontsize=8.0)


def _overview(results: Results) -> Picture:
    figure, axes = _canvas(10.4, 3.9)
    _block(axes, (1.7, 3.0), (1.8, 1.0), 'ICR steering')
    _sum(axes, (3.7, 3.0))
    _block(axes, (5.5, 3.0), (1.8, 1.0), 'four wheel\nmodules')
    _block(axes, (8.0, 3.0), (1.6, 1.0), 'vehicle')
    _block(axes, (5.5, 0.8), (2.4, 1.0), 'side-slip control:\na PID for each wheel', ACCENT)
    _wire(axes, (0.0, 3.0), (0.8, 3.0))
    _wire(axes, (2.6, 3.0), (3.7 - _SUM, 3.0))
    _wire(axes, (3.7 + _SUM, 3.0), (4.6, 3.0))
    _wire(axes, (6.4, 3.0), (7.2, 3.0))
    _wire(axes, (8.8, 3.0), (10.4, 3.0))
    _wire(axes, (9.2, 3.0), (9.2, 0.8), (6.7, 0.8), colour=ACCENT)
    _wire(axes, (4.3, 0.8), (3.7, 0.8), (3.7, 3.0 - _SUM), colour=ACCENT)
    _words(axes, (0.35, 3.1), 'ICR')
    _words(axes, (3.05, 3.1), 'angles')
    _words(axes, (6.8, 3.1), 'angles')
    _words(axes, (9.7, 3.1), 'side slips')
    _words(axes, (8.0, 0.9), 'side slips', ACCENT)
    _words(axes, (3.6, 1.7), 'trims', ACCENT, 'right')
    scenario = real_actuators(FIRST_GAINS).load()
    return Picture(
        figure,
        f'Every {number(1e3 * scenario.plant.control_period)} ms the side slips of the four tyres become trims, '
        'which are added to the angles about the turn centre; the wheels follow with a time constant of '
        f'{number(1e3 * scenario.wheel_module.steer_time_constant)} ms.',
    )


def _loop(results: Results) -> Picture:
    figure, axes = _canvas(10.4, 4.4)
    first, second, third, middle = 1.3, 5.0, 6.3, 2.9
    for height, words in ((3.9, 'P:  K e'), (middle, 'I:  Ki \u222b e dt'), (1.9, 'D:  Kd de/dt')):
        _block(axes, (3.3, height), (1.6, 0.7), words, ACCENT)
        _wire(axes, (2.0, middle), (2.0, height), (2.5, height))
    _wire(axes, (4.1, 3.9), (second, 3.9), (second, middle + _SUM))
    _wire(axes, (4.1, middle), (second - _SUM, middle))
    _wire(axes, (4.1, 1.9), (second, 1.9), (second, middle - _SUM))
    _block(axes, (8.1, middle), (1.8, 1.0), 'vehicle and\nactuators')
    _wire(axes, (0.2, middle), (first - _SUM, middle))
    axes.plot((first, 2.0), (middle, middle), color=INK, linewidth=1.1)
    _wire(axes, (second + _SUM, middle), (third - _SUM, middle))
    _wire(axes, (third, 4.2), (third, middle + _SUM))
    _wire(axes, (third + _SUM, middle), (7.2, middle))
    _wire(axes, (9.0, middle), (10.4, middle))
    _wire(axes, (9.6, middle), (9.6, 0.5), (first, 0.5), (first, middle - _SUM))
    for place in (first, second, third):
        _sum(axes, (place, middle))
    _words(axes, (0.6, 3.0), 'target 0')
    _words(axes, (1.2, 2.5), '\u2212', side='right')
    _words(axes, (1.73, 3.0), 'e')
    _words(axes, (5.65, 3.0), 'trim')
    _words(axes, (third + 0.1, 3.9), 'angle about the turn centre', side='left')
    _words(axes, (9.8, 3.0), 'side slip', side='center')
    return Picture(figure, _loop_sentence())


def _loop_sentence() -> str:
    gains = real_actuators(FIRST_GAINS).load().side_slip
    each = {'P': gains.proportional_gains, 'I': gains.integral_gains, 'D': gains.derivative_gains}
    parts = [name for name, values in each.items() if any(values)]
    return (
        f'Of the three parts the thesis uses {", ".join(parts)} only. The gain {number(FIRST_GAINS[0])} leaves '
        f'{percent(exact_side_slip(1.0, FIRST_GAINS[0]), 3)} of the slip that the wheel would have in the same '
        'motion.'
    )


FIGURES = (
    ThesisFigure('5.1', 'The side-slip controller in the vehicle', _overview),
    ThesisFigure('5.2', 'The control loop of one wheel', _loop),
)
