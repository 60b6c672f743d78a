"""The table of a chunk of turns: what was varied, and what came of it, each column with its unit."""

import io
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from omni_vehicle_ros.analysis.metrics import REST, SPEED_FLOOR, YAW_RATE_FLOOR
from omni_vehicle_ros.analysis.signals import BAND
from omni_vehicle_ros.checks import check_commands
from omni_vehicle_ros.errors import ScenarioError
from omni_vehicle_ros.model.constants import DUGOFF
from omni_vehicle_ros.model.packing import STATE
from omni_vehicle_ros.model.state import Vector
from omni_vehicle_ros.model.tyres.friction_circle import lateral_capacity
from omni_vehicle_ros.model.tyres.region import DEPARTURE, Region, region
from omni_vehicle_ros.sweep.axes import Axis
from omni_vehicle_ros.sweep.drive import Driven, drive, kind, signal
from omni_vehicle_ros.sweep.open_loop import OpenLoop, open_loop, why_closed
from omni_vehicle_ros.sweep.study import Study
from omni_vehicle_ros.sweep.watch import (
    LARGEST_AY,
    LARGEST_DEPARTURE,
    LARGEST_SLIDE,
    LEAST_LOAD,
    SIGNALS,
)
from omni_vehicle_ros.wheels import WHEELS

Flags = npt.NDArray[np.bool_]

SPUN = 0.25 * np.pi
"""Mean side slip of the wheels [rad] from which on a vehicle moves across them rather than along."""
ROUNDING = 1e-12
"""What Dugoff's force lacks of C tan(alpha) by rounding alone, as a share; see `model.tyres.region`."""
_ANGLE, _SLIP, _LONG, _LOAD = STATE, STATE + 4, STATE + 8, STATE + 16
_SLIP_PEAK, _USE_PEAK = STATE + 27, STATE + 31


class Column(NamedTuple):
    """A column of results: its name, its SI unit ('1' for ratios, '' for flags) and what it is."""

    name: str
    unit: str
    text: str


COLUMNS = (
    Column('settled', '', 'whether yaw rate and lateral speed were steady over the last second and no axle slid'),
    Column('spun', '', 'whether the wheels ever moved across rather than along: mean side slip above 45 deg'),
    Column('left_linear', '', 'whether a tyre ever left its linear region'),
    Column('lifted', '', 'whether a wheel ever had no load'),
    Column('path_radius', 'm', 'radius of the path in the last second, positive to the left; none unless settled'),
    Column('final_speed', 'm/s', 'speed of the centre of gravity, mean of the last second'),
    Column('yaw_rate', 'rad/s', 'mean of the last second'),
    Column('body_slip', 'rad', 'direction of motion from the heading, by the mean velocity of the last second'),
    Column('lateral_acceleration', 'm/s2', 'mean of the last second'),
    Column('lateral_acceleration_peak', 'm/s2', 'largest size'),
    *(Column(f'side_slip_{wheel}', 'rad', 'mean of the last second') for wheel in WHEELS),
    *(Column(f'side_slip_peak_{wheel}', 'rad', 'largest size') for wheel in WHEELS),
    *(Column(f'friction_use_peak_{wheel}', '1', 'largest force over friction times load') for wheel in WHEELS),
    *(Column(f'load_minimum_{wheel}', 'N', 'smallest vertical load') for wheel in WHEELS),
)


def chunk_table(study: Study, number: int) -> bytes:
    """Drive the turns of a chunk and return their table as a parquet file.

    Raises
    ------
    ScenarioError
        A turn can't be, or needs what the batch physics can't do.
    """
    numbers = study.numbers(number)
    points = study.points(numbers)
    columns = results([turn(study, point) for point in points])
    return _parquet(study.axes, numbers, points, columns)


def turn(study: Study, point: Sequence[Any]) -> OpenLoop:
    """Return what acts in one turn of a study.

    Raises
    ------
    ScenarioError
        Says what is wrong with it, or what of it needs feedback.
    """
    scenario = study.scenario(point)
    check_commands(scenario)
    reason = why_closed(scenario)
    if reason is not None:
        raise ScenarioError(f'{scenario.name}: a sweep drives what needs no feedback: {reason}, or run it')
    return open_loop(scenario)


def results(turns: Sequence[OpenLoop]) -> dict[str, Vector]:
    """Drive turns, those of a kind together, and return the `COLUMNS` by name, shape (n,) each."""
    groups: dict[tuple[object, ...], list[int]] = {}
    for number, one in enumerate(turns):
        groups.setdefault(kind(one), []).append(number)
    found = {column.name: np.empty(len(turns)) for column in COLUMNS}
    for members in groups.values():
        together = [turns[number] for number in members]
        for name, values in _columns(together, drive(together)).items():
            found[name][members] = values
    return found


def _columns(turns: Sequence[OpenLoop], driven: Driven) -> dict[str, Any]:
    rows, means = driven.rows, {name: signal(driven, name)[2] for name in SIGNALS}
    settled = _settled(turns, driven)
    limit = np.where([one.constants.tyre_model == DUGOFF for one in turns], ROUNDING, DEPARTURE)
    loads = rows[LEAST_LOAD : LEAST_LOAD + 4]
    found: dict[str, Any] = {
        'settled': settled,
        'spun': rows[LARGEST_SLIDE] > SPUN,
        'left_linear': rows[LARGEST_DEPARTURE] > limit,
        'lifted': np.any(loads <= 0.0, axis=0),
        'path_radius': _radius(driven, settled),
        'final_speed': means['speed'],
        'yaw_rate': means['yaw_rate'],
        'body_slip': np.arctan2(means['vy'], means['vx']),
        'lateral_acceleration': means['ay'],
        'lateral_acceleration_peak': rows[LARGEST_AY],
    }
    for i, wheel in enumerate(WHEELS):
        found[f'side_slip_{wheel}'] = means[SIGNALS[5 + i]]
        found[f'side_slip_peak_{wheel}'] = rows[_SLIP_PEAK + i]
        found[f'friction_use_peak_{wheel}'] = rows[_USE_PEAK + i]
        found[f'load_minimum_{wheel}'] = loads[i]
    return found


def _settled(turns: Sequence[OpenLoop], driven: Driven) -> Flags:
    """Return whether turns end in a steady state, as `analysis.metrics` says it, but for its look at limit speeds."""
    if driven.samples == 0:
        return np.zeros(len(turns), dtype=bool)
    moving = np.max([np.max(np.abs(signal(driven, name)[:2]), axis=0) for name in ('vx', 'vy', 'yaw_rate')], axis=0)
    steady: Flags = (moving >= REST) & _steady(driven, 'yaw_rate', YAW_RATE_FLOOR) & _steady(driven, 'vy', SPEED_FLOOR)
    for number in np.flatnonzero(steady & (driven.rows[LARGEST_DEPARTURE] > ROUNDING)).tolist():
        steady[number] = not _axle_slides(turns[number], driven.rows[:, number])
    return steady


def _steady(driven: Driven, name: str, floor: float) -> Flags:
    low, high, mean = signal(driven, name)
    return high - low <= np.maximum(BAND * np.abs(mean), floor)


def _axle_slides(one: OpenLoop, row: Vector) -> bool:
    """Return whether both tyres of an axle slide at the end."""
    model, friction = one.constants, one.acting[-1].environment.friction
    sliding = []
    for i in range(4):
        along, across = row[0] - model.wheel_y[i] * row[2], row[1] + model.wheel_x[i] * row[2]
        capacity = friction[i] * float(row[_LOAD + i])
        if model.friction_circle:
            capacity = lateral_capacity(capacity, float(row[_LONG + i]))
        pace = np.cos(row[_ANGLE + i]) * along + np.sin(row[_ANGLE + i]) * across
        sliding.append(region(float(row[_SLIP + i]), float(pace), capacity, model) == Region.SLIDING)
    return all(sliding[:2]) or all(sliding[2:])


def _radius(driven: Driven, settled: Flags) -> Vector:
    """Return the radius of settled paths [m], NaN of others and of straight ones; see `metrics.path_radius`."""
    speed, rate = signal(driven, 'speed')[2], signal(driven, 'yaw_rate')[2]
    turning = settled & _steady(driven, 'speed', SPEED_FLOOR) & (np.abs(rate) > YAW_RATE_FLOOR)
    signed = np.copysign(speed, signal(driven, 'vx')[2])
    radius: Vector = np.divide(signed, rate, out=np.full(len(rate), np.nan), where=turning)
    return radius


def _parquet(
    axes: Sequence[Axis], numbers: range, points: list[tuple[Any, ...]], columns: dict[str, Vector]
) -> bytes:
    import pyarrow as pa
    from pyarrow import parquet

    fields = [pa.field('turn', pa.int64(), metadata={'unit': '', 'text': 'number of the turn'})]
    arrays = [pa.array(numbers, pa.int64())]
    for axis, values in zip(axes, zip(*points, strict=True), strict=True):
        array = pa.array([float(v) if type(v) is int else v for v in values])
        arrays.append(array)
        fields.append(pa.field(axis.name, array.type, metadata={'unit': axis.unit, 'text': 'varied'}))
    for column in COLUMNS:
        found = columns[column.name]
        array = pa.array(found if column.unit else found.astype(bool), from_pandas=True)
        arrays.append(array)
        fields.append(pa.field(column.name, array.type, metadata={'unit': column.unit, 'text': column.text}))
    file = io.BytesIO()
    parquet.write_table(pa.Table.from_arrays(arrays, schema=pa.schema(fields)), file, compression='zstd')
    return file.getvalue()
