"""The lateral force coefficient and the aerodynamic centre: Fig. 4.25-4.27 (thesis sec. 4.4.2)."""

import math
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch, FancyBboxPatch, Rectangle

from omni_vehicle_ros.analysis.style import ACCENT, INK, MUTED, SECOND, WHEEL_COLOURS, line
from omni_vehicle_ros.model.constants import constants
from omni_vehicle_ros.model.disturbances import side_force_coefficient, wind_force
from omni_vehicle_ros.parameters import VehicleParameters
from omni_vehicle_ros.thesis.chart import SIZE, TIME, Span, shade
from omni_vehicle_ros.thesis.disturbances import BEGIN, END, SHOWN, SLOW, WIND, wind
from omni_vehicle_ros.thesis.figure import Picture, ThesisFigure
from omni_vehicle_ros.thesis.tasks import Recording, Results, km_per_h
from omni_vehicle_ros.thesis.words import degrees, number

if TYPE_CHECKING:
    from matplotlib.axes import Axes

BEHIND, AHEAD = -0.1, 0.1
"""Aerodynamic centres [m]."""

_OVERHANG = 0.5
_DRAWN_ARM = 0.75  # m, far enough from the centre of gravity to be seen; the picture is not to scale there


def _coefficient(results: Results) -> Picture:
    vehicle = wind(WIND, SLOW).load().vehicle
    model = constants(vehicle)
    angles = np.linspace(0.0, 0.5 * math.pi, 181)
    values = np.array([side_force_coefficient(angle, model) for angle in angles.tolist()])
    figure = Figure(figsize=SIZE, layout='constrained')
    axes = figure.subplots()
    axes.plot(np.degrees(angles), values, color=INK)
    points = np.degrees(vehicle.airflow_angles), vehicle.side_force_coefficients
    axes.plot(*points, 'o', color=ACCENT, label='given: airflow_angles, side_force_coefficients')
    axes.set(xlabel='airflow angle [°]', ylabel='lateral force coefficient Cy', xlim=(0.0, 90.0))
    axes.set_ylim(0.0, 1.15 * float(np.max(values)))
    axes.legend(loc='lower right')
    return Picture(
        figure, _coefficient_sentence(vehicle), {'airflow angle [deg]': np.degrees(angles), 'Cy [1]': values}
    )


def _coefficient_sentence(vehicle: VehicleParameters) -> str:
    model = constants(vehicle)
    words = []
    for speed in (SLOW, 80):
        angle = math.atan2(WIND, km_per_h(speed))
        words.append(
            f'at {speed} km/h a wind of {number(WIND)} m/s comes from {degrees(angle)} off the axis, where Cy is '
            f'{number(side_force_coefficient(angle, model))} and the force '
            f'{number(wind_force(WIND, km_per_h(speed), model))} N'
        )
    count = len(vehicle.airflow_angles)
    given = f'Given at {count} angle{"s" if count > 1 else ""}, linear between and from 0, constant beyond'
    return f'{given}: {"; ".join(words)}.'


def _centre(name: str, centre: float, caption: str) -> ThesisFigure:
    task = wind(WIND, SLOW, centre)

    def draw(results: Results) -> Picture:
        recording = results[task]
        figure = Figure(figsize=SIZE, layout='constrained')
        diagram, response = figure.subplots(1, 2, width_ratios=(1.0, 1.25))
        _draw_vehicle(diagram, recording, centre)
        rows = recording.rows(*SHOWN)
        rates = np.degrees(recording.yaw_rate[rows])
        line(response, recording.time[rows], rates, INK)
        response.margins(y=0.12)
        response.set(xlabel=TIME, ylabel='yaw rate [°/s]', xlim=SHOWN)
        shade(response, (Span(BEGIN, END, 'wind'),))
        table = {TIME: recording.time[rows], 'yaw rate [deg/s]': rates}
        return Picture(figure, _centre_sentence(recording, centre), table)

    return ThesisFigure(name, caption, draw, (task,))


def _centre_sentence(recording: Recording, centre: float) -> str:
    force = wind_force(WIND, float(recording.vx[0]), constants(recording.scenario.vehicle))
    moment = centre * force
    rates = recording.yaw_rate[recording.rows(BEGIN, END)]
    first, last = float(rates[1]), float(rates[-1])
    return (
        f'The wind pushes to the left with {number(force)} N and turns with {number(moment)} N m, {_sense(moment)}: '
        f'the vehicle begins to turn {_sense(first)} and ends at {degrees(last)}/s, {_sense(last)}.'
        + ('' if first * last > 0.0 else f' {_turned(recording)}')
    )


def _sense(value: float) -> str:
    return 'anticlockwise' if value > 0.0 else 'clockwise'


def _turned(recording: Recording) -> str:
    vehicle = recording.scenario.vehicle
    behind = 0.5 * (vehicle.cg_to_rear_axle - vehicle.cg_to_front_axle)
    return (
        f'For the tyres hold it {number(behind)} m behind the centre of gravity (neutral steer point), farther back '
        'than where the wind acts.'
    )


def _draw_vehicle(axes: 'Axes', recording: Recording, centre: float) -> None:
    """Draw the vehicle from above, its nose up, the wind from its right."""
    vehicle = recording.scenario.vehicle
    front, rear, half = vehicle.cg_to_front_axle, -vehicle.cg_to_rear_axle, 0.5 * vehicle.front_track
    corner, length = (-half, rear - _OVERHANG), front - rear + 2.0 * _OVERHANG
    axes.add_patch(
        FancyBboxPatch(
            corner,
            2.0 * half,
            length,
            boxstyle='round,pad=0.0,rounding_size=0.35',
            facecolor='#eef2f6',
            edgecolor=MUTED,
        )
    )
    for x, y, colour in zip(vehicle.wheel_x, vehicle.wheel_y, WHEEL_COLOURS, strict=True):
        axes.add_patch(Rectangle((-y - 0.13, x - 0.35), 0.26, 0.7, facecolor=colour))
    arm = math.copysign(_DRAWN_ARM, centre)
    axes.plot(0.0, 0.0, 'o', color=INK)
    axes.annotate('CG', (0.0, 0.0), (6.0, math.copysign(3.0, centre)), textcoords='offset points', va='center')
    axes.plot(0.0, arm, 's', color=ACCENT)
    axes.annotate('AC', (0.0, arm), (-6.0, 0.0), textcoords='offset points', ha='right', va='center', color=ACCENT)
    _arrow(axes, (half + 1.3, arm), (0.08, arm), ACCENT)
    axes.annotate('wind force', (half + 1.35, arm), (0.0, 5.0), textcoords='offset points', ha='right', color=ACCENT)
    _moment(axes, centre)
    axes.set(xlim=(-half - 0.9, half + 1.5), ylim=(rear - _OVERHANG - 0.2, front + _OVERHANG + 0.2), aspect='equal')
    axes.axis('off')


def _moment(axes: 'Axes', centre: float) -> None:
    """Draw the sense in which the wind turns the vehicle about its centre of gravity."""
    side = -math.copysign(0.22, centre)
    _arrow(axes, (-0.45, side), (0.45, side), SECOND, f'arc3,rad={math.copysign(0.6, centre):g}')


def _arrow(axes: 'Axes', begin: tuple[float, float], end: tuple[float, float], colour: str, bend: str = 'arc3') -> None:
    axes.add_patch(
        FancyArrowPatch(
            begin,
            end,
            connectionstyle=bend,
            arrowstyle='-|>',
            mutation_scale=11.0,
            color=colour,
            linewidth=1.4,
            zorder=5,
        )
    )


FIGURES = (
    ThesisFigure('4.25', 'Lateral force coefficient over the angle of the airflow', _coefficient),
    _centre('4.26', BEHIND, 'Aerodynamic centre (AC) behind the centre of gravity (CG), and how the vehicle yaws'),
    _centre('4.27', AHEAD, 'Aerodynamic centre (AC) ahead of the centre of gravity (CG), and how the vehicle yaws'),
)
