"""Pictures and tables as files."""

import csv
import math
from pathlib import Path
from typing import NamedTuple

import matplotlib

from omni_vehicle_ros.analysis.style import MUTED, PAPER, house_style
from omni_vehicle_ros.thesis.figure import Picture, ThesisFigure
from omni_vehicle_ros.thesis.tasks import Results


class Shown(NamedTuple):
    """A figure that was drawn: the sentence of what is seen, and whether a table lies beside it."""

    sentence: str
    has_table: bool


def draw(figure: ThesisFigure, results: Results, directory: Path) -> Shown:
    """Draw a figure into a directory: a picture ``<number>.svg``, and its data as ``<number>.csv``, if it has any.

    The picture says its number in small type, and number and caption as its title. The first line of the data
    names the columns, as readers of CSV want it; which figure they belong to is the name of the file.

    Parameters
    ----------
    figure
        What to draw.
    results
        Of what it needs.
    directory
        Where to; there must be one.
    """
    with house_style(), matplotlib.rc_context({'svg.hashsalt': figure.number}):
        picture = figure.draw(results)
        picture.figure.text(0.0, 0.0, figure.label, ha='left', va='top', color=MUTED, fontsize=7.5)
        picture.figure.savefig(
            directory / f'{figure.number}.svg',
            facecolor=PAPER,
            metadata={'Date': None, 'Title': figure.title},
            bbox_inches='tight',
            pad_inches=0.08,
        )
    if picture.table:
        write_table(picture, directory / f'{figure.number}.csv')
    return Shown(picture.sentence, bool(picture.table))


def write_table(picture: Picture, path: Path) -> None:
    """Write the data of a picture as CSV, a line of the picture a column; a cell is empty where the line has a gap."""
    columns = [column.tolist() for column in picture.table.values()]
    with path.open('w', encoding='utf-8', newline='') as file:
        writer = csv.writer(file)
        writer.writerow(picture.table)
        writer.writerows(map(_cell, row) for row in zip(*columns, strict=True))


def _cell(value: float | str) -> str:
    if isinstance(value, str):
        return value
    return '' if math.isnan(value) else f'{value + 0.0:.7g}'  # not -0
