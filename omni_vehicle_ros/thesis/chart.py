"""Lines over one variable: the picture and the table come from the same numbers."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure

from omni_vehicle_ros.analysis.signals import Array
from omni_vehicle_ros.analysis.style import ACCENT, GRID, INK, MUTED, SECOND, WHEEL_COLOURS, line
from omni_vehicle_ros.thesis.figure import Picture
from omni_vehicle_ros.thesis.tasks import Recording
from omni_vehicle_ros.thesis.words import wheel_words
from omni_vehicle_ros.wheels import WHEELS

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SIZE = (5.6, 3.7)
TIME, RADIUS = 'time [s]', 'radius [m]'
SIDE_SLIP, STEER_ANGLE, SPEED = 'side slip [deg]', 'steer angle [deg]', 'speed [m/s]'
NO_TURN = 'past the limit'
COLOURS = (INK, SECOND, ACCENT)
"""Of runs that are held against each other."""

DASHED: dict[str, Any] = {'linestyle': (0, (4, 3)), 'linewidth': 1.1}
_LONGEST_LEGEND, _HANDLE = 72, 6  # characters: of a row, and in the place of a handle
_COVERED = 0.01  # of the range of all lines
_ROOM = 0.12  # of the ordinate, above and below the lines

Range = tuple[float, float]


class Line(NamedTuple):
    """A line: its name, values of shape (n,), NaN where it has a gap, colour, and whether it is a thin dashed one."""

    name: str
    values: Array
    colour: Any
    dashed: bool = False


class Span(NamedTuple):
    """A part of the abscissa to shade, with words."""

    begin: float
    end: float
    words: str


@dataclass(frozen=True)
class Chart:
    """Lines over one variable.

    Attributes
    ----------
    lines
        What is drawn.
    x
        Where, shape (n,).
    y_name, x_name
        What it is, with its unit in square brackets.
    spans
        Parts to shade.
    limits
        Range of the ordinate, if it isn't to hold all values.
    closer
        Range of a second panel that shows the same lines again, if any.
    difference
        Whether a second panel shows the first line minus the second.
    """

    lines: tuple[Line, ...]
    x: Array
    y_name: str
    x_name: str = TIME
    spans: tuple[Span, ...] = ()
    limits: Range | None = None
    closer: Range | None = None
    difference: bool = False

    def picture(self, sentence: str) -> Picture:
        """Return the picture with its table."""
        return Picture(self.draw(), sentence, self.table())

    def table(self) -> dict[str, Array]:
        """Return the abscissa and the lines as columns, their quantity in each name."""
        return {self.x_name: self.x, **{f'{entry.name}: {self.y_name}': entry.values for entry in self.lines}}

    def draw(self) -> Figure:
        """Draw it."""
        figure = Figure(figsize=SIZE, layout='constrained')
        two = self.difference or self.closer is not None
        rows = figure.subplots(2 if two else 1, 1, sharex=True, squeeze=False)[:, 0]
        self._fill(rows[0], self.lines)
        rows[0].set_ylabel(_shown(self.y_name))
        if self.limits is not None:
            rows[0].set_ylim(self.limits)
        if self.closer is not None:
            self._fill(rows[1], self.lines)
            rows[1].set(ylabel='the same, closer', ylim=self.closer)
        elif self.difference:
            first, second = self.lines[:2]
            self._fill(rows[1], (Line('', first.values - second.values, MUTED),))
            rows[1].set_ylabel(f'difference {_shown(self.y_name[self.y_name.index("[") :])}')
        rows[-1].set_xlabel(_shown(self.x_name))
        legend(rows[0])
        return figure

    def _fill(self, axes: 'Axes', lines: tuple[Line, ...]) -> None:
        for entry in lines:
            line(axes, self.x, entry.values, entry.colour, entry.name, **(DASHED if entry.dashed else {}))
        axes.set_xlim(self.x[0], self.x[-1])
        axes.margins(y=_ROOM)
        shade(axes, self.spans)


def _shown(name: str) -> str:
    return name.replace('[deg]', '[°]').removesuffix(' [1]')


def legend(axes: 'Axes') -> None:
    """Name the lines above the axes."""
    names = axes.get_legend_handles_labels()[1]
    if len(names) > 1:
        length = sum(len(name) + _HANDLE for name in names)
        columns = len(names) if length <= _LONGEST_LEGEND else (len(names) + 1) // 2
        axes.legend(loc='lower right', bbox_to_anchor=(1.0, 1.0), ncol=columns, columnspacing=1.4, borderpad=0.1)


def shade(axes: 'Axes', spans: Sequence[Span]) -> None:
    """Shade parts of the abscissa and say what they are."""
    for span in spans:
        axes.axvspan(span.begin, span.end, facecolor=GRID, alpha=0.6, linewidth=0.0, zorder=0)
        axes.annotate(
            span.words,
            (0.5 * (span.begin + span.end), 1.0),
            (0.0, -3.0),
            xycoords=axes.get_xaxis_transform(),
            textcoords='offset points',
            ha='center',
            va='top',
            color=MUTED,
            fontsize=7.5,
            zorder=5,
        )


def wheel_lines(values: Array) -> tuple[Line, ...]:
    """Return the lines of a signal of the four wheels, shape (n, 4); right ones dashed where they cover left ones."""
    left, right = values[:, ::2], values[:, 1::2]
    covered = float(np.max(np.abs(left - right))) < _COVERED * float(np.ptp(values))
    return tuple(
        Line(wheel_words(wheel), values[:, i], WHEEL_COLOURS[i], covered and i % 2 == 1)
        for i, wheel in enumerate(WHEELS)
    )


def side_slips(
    recording: Recording,
    spans: tuple[Span, ...] = (),
    within: Range = (0.0, math.inf),
    closer_from: float | None = None,
) -> Chart:
    """Return the chart of the side slip of the four tyres over time [deg].

    Parameters
    ----------
    recording
        The run.
    spans
        Times to shade.
    within
        When to begin and to end [s].
    closer_from
        If given, a second panel shows what the slips do from this time on [s].
    """
    slips = np.degrees(recording.side_slip)
    closer = None if closer_from is None else around(slips[recording.rows(closer_from, math.inf)])
    rows = recording.rows(*within)
    return Chart(wheel_lines(slips[rows]), recording.time[rows], SIDE_SLIP, spans=spans, closer=closer)


def around(values: Array) -> Range:
    """Return a range that shows values and 0, with room."""
    low, high = min(0.0, float(np.nanmin(values))), max(0.0, float(np.nanmax(values)))
    room = 0.2 * (high - low) or 1.0
    return low - room, high + room


def steer_angles(recording: Recording) -> Chart:
    """Return the chart of the steer angles of the four wheels over time [deg]."""
    return Chart(wheel_lines(np.degrees(recording.steer_angle)), recording.time, STEER_ANGLE)


def compared(names: tuple[str, ...], recordings: Sequence[Recording], wheel: int = 0) -> tuple[Line, ...]:
    """Return the lines of the side slip of one wheel in several runs [deg]; the second is dashed."""
    return tuple(
        Line(name, np.degrees(found.side_slip[:, wheel]), COLOURS[i], i == 1)
        for i, (name, found) in enumerate(zip(names, recordings, strict=True))
    )
