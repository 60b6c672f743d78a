"""What a figure of the thesis is, and how the sections of the registry hold them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from matplotlib.figure import Figure

from omni_vehicle_ros.analysis.signals import Array
from omni_vehicle_ros.thesis.tasks import Results, Task


@dataclass(frozen=True)
class Picture:
    """A figure as it is drawn.

    Attributes
    ----------
    figure
        The drawing.
    sentence
        What is seen, worked out from the data.
    table
        The data: columns of equal length, by name with unit; empty for a diagram.
    """

    figure: Figure
    sentence: str
    table: Mapping[str, Array] = field(default_factory=dict)


@dataclass(frozen=True)
class ThesisFigure:
    """A figure of the thesis.

    Attributes
    ----------
    number
        As in the thesis, such as ``4.15``.
    caption
        What it shows, in our words.
    draw
        Draws it from the results of what it needs, in the style of the house.
    needs
        What has to be computed first.
    """

    number: str
    caption: str
    draw: Callable[[Results], Picture]
    needs: tuple[Task[Any], ...] = ()

    @property
    def label(self) -> str:
        """What stands below the picture: ``Fig. 4.15``; the caption of one that is not in the thesis."""
        return f'Fig. {self.number}' if self._numbered else self.caption

    @property
    def title(self) -> str:
        """Number and caption."""
        return f'{self.label} · {self.caption}' if self._numbered else self.caption

    @property
    def _numbered(self) -> bool:
        return self.number[0].isdigit()


@dataclass(frozen=True)
class Section:
    """Figures that belong together.

    Attributes
    ----------
    chapter
        Of the thesis, such as ``4``.
    number, title
        Of the section, such as ``4.2``; one that is not in the thesis has a word for its number.
    figures
        In the order of their numbers.
    """

    chapter: str
    number: str
    title: str
    figures: tuple[ThesisFigure, ...]
