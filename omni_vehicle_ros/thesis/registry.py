"""All figures, section by section: what the command draws and the page shows."""

from omni_vehicle_ros.errors import RunError
from omni_vehicle_ros.parameters import did_you_mean
from omni_vehicle_ros.thesis import (
    aerodynamics,
    block_diagrams,
    controllers,
    disturbances,
    drive,
    roll,
    side_slip_control,
    simple_turning,
    slip_maps,
    traction,
)
from omni_vehicle_ros.thesis.figure import Section, ThesisFigure

CHAPTERS = {'4': 'Dynamic stability', '5': 'Control'}
SECTIONS = (
    Section('4', '4.2', 'Simple turning', simple_turning.FIGURES + slip_maps.FIGURES + simple_turning.LOSS_FIGURES),
    Section('4', '4.3', 'Traction and brake in a turn', traction.FIGURES),
    Section(
        '4',
        '4.4',
        'Disturbances: bank, wind and friction',
        disturbances.FIGURES + aerodynamics.FIGURES + disturbances.WIND_FIGURES + disturbances.FRICTION_FIGURES,
    ),
    Section('4', '4.5', 'Roll: load transfer and roll steer', roll.FIGURES),
    Section('4', '4.6', 'Front-wheel, rear-wheel and four-wheel drive', drive.FIGURES),
    Section('5', '5.2', 'Side-slip control', block_diagrams.FIGURES + side_slip_control.FIGURES),
    controllers.SECTION,
)

FIGURES = {figure.number: figure for section in SECTIONS for figure in section.figures}
"""Every figure by its number."""


def chosen(figure: str | None = None, chapter: str | None = None) -> tuple[ThesisFigure, ...]:
    """Return the figure with a number, or those of a chapter, or all.

    Raises
    ------
    RunError
        There is no such figure or chapter, or both are given.
    """
    if figure is not None and chapter is not None:
        raise RunError('--figure and --chapter: give one of them')
    if figure is not None:
        if figure not in FIGURES:
            raise RunError(f'--figure: no figure {figure!r}{did_you_mean(figure, list(FIGURES))}')
        return (FIGURES[figure],)
    if chapter is not None and chapter not in CHAPTERS:
        raise RunError(f'--chapter: {chapter!r} is not one of {", ".join(CHAPTERS)}')
    return tuple(entry for section in SECTIONS if chapter in (None, section.chapter) for entry in section.figures)
