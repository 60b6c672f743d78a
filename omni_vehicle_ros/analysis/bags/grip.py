"""g-g diagrams of bags."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.colors import to_rgba_array
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from omni_vehicle_ros.analysis.bags.marks import BAG_COLOURS
from omni_vehicle_ros.analysis.plots import WIDTH, Plot
from omni_vehicle_ros.analysis.stream.grip import GripMap
from omni_vehicle_ros.analysis.stream.survey import Survey
from omni_vehicle_ros.analysis.style import INK, MUTED, WHEEL_COLOURS
from omni_vehicle_ros.wheels import WHEELS

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def grip_plots(surveys: Sequence[Survey]) -> list[Plot]:
    """Draw the g-g diagrams of the tyres and of the body, as far as their forces are known."""
    plots = []
    if any(grip.counts.any() for survey in surveys for grip in survey.tyre_grip):
        figure = Figure(figsize=(WIDTH, WIDTH), layout='constrained')
        for i, axes in enumerate(figure.subplots(2, 2, sharex=True, sharey=True).flat):
            maps = [survey.tyre_grip[i] for survey in surveys]
            _circle(axes, maps, (1.0,), WHEEL_COLOURS[i] if len(surveys) == 1 else '')
            axes.set_title(WHEELS[i].replace('_', ' '), fontsize=8.5)
        figure.supxlabel('to the left', fontsize=9.0)
        figure.supylabel('along', fontsize=9.0)
        text = 'Force over friction times load, in the frame of each wheel. The circle is the limit.'
        plots.append(Plot('grip', 'g-g diagrams of the tyres', text, figure))
    if any(survey.body_grip.counts.any() for survey in surveys):
        figure = Figure(figsize=(WIDTH, WIDTH), layout='constrained')
        axes = figure.add_subplot()
        _circle(axes, [survey.body_grip for survey in surveys], (0.5, 1.0), INK if len(surveys) == 1 else '')
        axes.set_xlabel('to the left [g]')
        axes.set_ylabel('ahead [g]')
        plots.append(Plot('body-grip', 'g-g diagram of the body', 'Acceleration; circles at 0.5 g and 1 g.', figure))
    return plots


def _circle(axes: 'Axes', maps: Sequence[GripMap], radii: Sequence[float], colour: str) -> None:
    for radius in radii:
        axes.add_patch(Circle((0.0, 0.0), radius, fill=False, edgecolor=MUTED, linewidth=0.9))
    for number, grip in enumerate(maps):
        along, across, share = grip.cells()
        shade = to_rgba_array([colour or BAG_COLOURS[number]] * len(share))
        if len(share):
            shade[:, 3] = np.clip(1.0 + np.log10(share) / 4.0, 0.15, 1.0)
        axes.scatter(across, along, s=7.0, marker='s', c=shade, linewidths=0.0)
    axes.set(xlim=(-1.25, 1.25), ylim=(-1.25, 1.25), aspect='equal')
