"""Colours and marks that all figures of bags share."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from omni_vehicle_ros.analysis.stream.summary import all_events
from omni_vehicle_ros.analysis.stream.survey import Survey

if TYPE_CHECKING:
    from matplotlib.figure import Figure

BAG_COLOURS = ('#1f2933', '#d55e00', '#0072b2', '#009e73', '#cc79a7', '#e69f00')
EVENT_COLOURS = {
    'time-out': '#b5403a', 'missed cycles': '#7b5ea7', 'saturation': '#e69f00', 'wheel lift': '#d55e00',
    'warning': '#8a6d1b', 'error': '#8b0000',
}
_MOST_MARKS = 60
_FOOT = 0.03
"""Height of the line of a kind of event, or of a bag, over that of the axes."""


def mark_events(figure: 'Figure', surveys: Sequence[Survey]) -> None:
    """Mark events along the foot of all axes over time: each kind on a line of its own; of several bags, each bag."""
    if len(surveys) == 1:
        rows = [(EVENT_COLOURS[kind], spans) for kind, spans in _spans(surveys[0]).items()]
    else:
        spans_of = [[span for spans in _spans(survey).values() for span in spans] for survey in surveys]
        rows = list(zip(BAG_COLOURS, spans_of, strict=False))
    length = max(survey.span[1] - survey.span[0] for survey in surveys) * 1e-9
    least = length / 300.0
    for axes in figure.axes:
        for number, (colour, spans) in enumerate(rows):
            for first, last in _joined(spans, least)[:_MOST_MARKS]:
                last, foot = max(last, first + least), _FOOT * number
                if len(surveys) == 1:
                    axes.axvspan(first, last, color=colour, linewidth=0.0, alpha=0.12, zorder=0)
                axes.axvspan(first, last, ymin=foot, ymax=foot + 0.025, color=colour, linewidth=0.0, zorder=5)
        axes.set_xlim(0.0, max(length, 1e-3))


def _spans(survey: Survey) -> dict[str, list[tuple[float, float]]]:
    """Return from when to when there were events [s], by kind."""
    found: dict[str, list[tuple[float, float]]] = {}
    for event in all_events(survey)[0]:
        span = (event.begin - survey.span[0]) * 1e-9, (event.end - survey.span[0]) * 1e-9
        found.setdefault(event.kind, []).append(span)
    return found


def _joined(spans: list[tuple[float, float]], least: float) -> list[tuple[float, float]]:
    """Return spans of which those closer than can be seen are one."""
    found: list[tuple[float, float]] = []
    for first, last in sorted(spans):
        if found and first - found[-1][1] < least:
            found[-1] = (found[-1][0], max(found[-1][1], last))
        else:
            found.append((first, last))
    return found
