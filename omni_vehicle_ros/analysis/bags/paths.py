"""Paths of bags from above."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from omni_vehicle_ros.analysis.bags.marks import BAG_COLOURS
from omni_vehicle_ros.analysis.path import plot_path
from omni_vehicle_ros.analysis.plots import LABELS, Plot
from omni_vehicle_ros.analysis.stream.survey import Survey
from omni_vehicle_ros.parameters import VehicleParameters


def path_plots(surveys: Sequence[Survey], names: Sequence[str], vehicles: Sequence[VehicleParameters]) -> list[Plot]:
    """Draw the path of each bag with its vehicle, and all paths in one if there are several."""
    known = [(survey, name, car) for survey, name, car in zip(surveys, names, vehicles, strict=True) if _moved(survey)]
    plots = []
    for number, (survey, name, vehicle) in enumerate(known):
        motion = survey.path.columns(survey.span[0])
        odom = motion['odom']
        margin = 2 * vehicle.wheelbase
        height = 7.6 * (np.ptp(odom.y) + margin) / (np.ptp(odom.x) + margin) + LABELS
        figure = Figure(figsize=(7.6, float(np.clip(height, 2.4, 8.0))))
        plot_path(motion, figure.add_subplot(), vehicle)
        wheels = 'with its steered wheels' if 'joint_states' in motion else 'steer angles are not known'
        title = 'Path from above' + (f': {name}' if len(known) > 1 else '')
        plots.append(Plot(f'path-{number}', title, f'The vehicle now and then, {wheels}.', figure))
    if len(known) > 1:
        plots.append(_all_paths([survey for survey, _, _ in known], surveys))
    return plots


def _moved(survey: Survey) -> bool:
    return survey.path.final is not None and len(survey.path.columns(0)['odom']) > 1


def _all_paths(known: Sequence[Survey], surveys: Sequence[Survey]) -> Plot:
    figure = Figure(figsize=(7.6, 4.6), layout='constrained')
    axes = figure.add_subplot()
    for survey in known:
        odom = survey.path.columns(0)['odom']
        axes.plot(odom.x, odom.y, color=BAG_COLOURS[surveys.index(survey)])
    axes.set_aspect('equal', adjustable='datalim')
    axes.set_xlabel('x [m]')
    axes.set_ylabel('y [m]')
    return Plot('paths', 'All paths', 'Of the centre of gravity.', figure)
