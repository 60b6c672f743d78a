"""One look for all figures: colours, lines with few points, and compact SVG that may stand many times in one page."""

import io
import re
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from omni_vehicle_ros.analysis.signals import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes

INK = '#1f2933'
MUTED = '#7b8794'
GRID = '#e4e7eb'
PAPER = '#ffffff'
# Okabe and Ito's palette, safe for the colour-blind: blue on the left, orange on the right, dark in front.
WHEEL_COLOURS = ('#0072b2', '#d55e00', '#56b4e9', '#e69f00')
ACCENT = '#009e73'
SECOND = '#cc79a7'
REGION_COLOURS = ('#cfe3d8', '#f0c36d', '#b5403a')  # linear, nonlinear, sliding

_BUCKETS = 400
_STYLE: Any = {
    'axes.edgecolor': MUTED,
    'axes.facecolor': PAPER,
    'axes.grid': True,
    'axes.labelcolor': INK,
    'axes.labelsize': 9.0,
    'axes.linewidth': 0.7,
    'axes.spines.right': False,
    'axes.spines.top': False,
    'axes.titlecolor': INK,
    'axes.titlelocation': 'left',
    'axes.titlesize': 10.0,
    'figure.facecolor': 'none',
    'font.family': 'sans-serif',
    'font.sans-serif': ['DejaVu Sans'],
    'font.size': 9.0,
    'grid.color': GRID,
    'grid.linewidth': 0.7,
    'legend.fontsize': 8.5,
    'legend.frameon': False,
    'lines.linewidth': 1.4,
    'lines.solid_joinstyle': 'round',
    'savefig.facecolor': 'none',
    'svg.fonttype': 'none',
    'xtick.color': MUTED,
    'xtick.labelcolor': INK,
    'xtick.labelsize': 8.5,
    'ytick.color': MUTED,
    'ytick.labelcolor': INK,
    'ytick.labelsize': 8.5,
}


@contextmanager
def house_style() -> Iterator[None]:
    """Draw in the style of the reports inside a ``with`` block."""
    with matplotlib.rc_context(_STYLE):
        yield


def thinned(time: Array, signal: Array) -> tuple[Array, Array]:
    """Return a line with few points that looks the same: the smallest and largest sample of each short interval.

    Parameters
    ----------
    time, signal
        Shape (n,).

    Returns
    -------
    tuple of ndarray
        At most about a thousand samples of both, the first and the last among them.
    """
    count = len(time)
    if count <= 2 * _BUCKETS:
        return time, signal
    edges = np.linspace(0, count, _BUCKETS + 1).astype(int)
    keep = {0, count - 1}
    for begin, end in pairwise(edges):
        part = signal[begin:end]
        keep.update((begin + int(np.argmin(part)), begin + int(np.argmax(part))))
    index = np.array(sorted(keep))
    return time[index], signal[index]


def line(axes: 'Axes', time: Array, signal: Array, colour: str, label: str | None = None, **options: Any) -> None:
    """Draw a thinned line."""
    axes.plot(*thinned(time, signal), color=colour, label=label, **options)


def to_svg(figure: Figure, name: str) -> str:
    """Return a figure as an SVG element for an HTML page: no size of its own, ids unique by ``name``, no links."""
    buffer = io.StringIO()
    with matplotlib.rc_context({'svg.hashsalt': name}):
        figure.savefig(buffer, format='svg', metadata={'Date': None}, bbox_inches='tight', pad_inches=0.05)
    text = buffer.getvalue()
    text = text[text.index('<svg'):]
    text = re.sub(r'<metadata>.*?</metadata>', '', text, flags=re.DOTALL)
    text = re.sub(r'(<svg[^>]*?) width="[^"]*"', r'\1', text, count=1)
    text = re.sub(r'(<svg[^>]*?) height="[^"]*"', r'\1', text, count=1)
    text = re.sub(r' xmlns(:xlink)?="[^"]*"', '', text).replace('xlink:href', 'href')
    text = re.sub(r'\bid="', f'id="{name}-', text)
    text = text.replace('href="#', f'href="#{name}-').replace('url(#', f'url(#{name}-')
    text = re.sub(r'(\d+\.\d\d)\d+', r'\1', text)
    text = text.replace("'DejaVu Sans'", 'system-ui').replace("'Bitstream Vera Sans'", 'Helvetica')
    return re.sub(r'\n\s*', '\n', text).strip()
