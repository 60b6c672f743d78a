"""What a turn map is to show, as the command line says it."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from omni_vehicle_ros.errors import ParameterError
from omni_vehicle_ros.model.dynamics import Environment
from omni_vehicle_ros.parameters import VehicleParameters
from omni_vehicle_ros.scenarios.vehicle_file import load_road, load_vehicle

COUNT = 61  # of radii and of speeds
FASTEST = 100.0  # m/s, as of any speed that is a parameter
WIDEST = 1e4  # m, with next to no side force even so


class MapRequest(NamedTuple):
    """A vehicle on its road, and the radii [m] and speeds [m/s] at which to look, both rising; ``title`` in words."""

    title: str
    vehicle: VehicleParameters
    environment: Environment
    radii: tuple[float, ...]
    speeds: tuple[float, ...]


def read_request(
    path: Path | None, overrides: Sequence[str], friction: float | None, radius: str, speed: str
) -> MapRequest:
    """Read what a map is to show.

    Parameters
    ----------
    path, overrides
        The vehicle on its road; see `load_vehicle` and `load_road`.
    friction
        Friction coefficient under all wheels; None: that of the road.
    radius, speed
        Ranges, such as ``2:20`` [m] and ``0.5:15`` [m/s].

    Raises
    ------
    CommandError
        The smallest radius lies within the track.
    ParameterError
        A number is outside its range, or a range is none.
    ScenarioError
        The file is not about a vehicle.
    """
    vehicle = load_vehicle(path, overrides)
    road = _road(path, friction)
    radii, speeds = even_grid('--radius', radius, WIDEST, 'm'), even_grid('--speed', speed, FASTEST, 'm/s')
    # The compiled physics takes a second to import; what is refused before should not pay for it.
    from omni_vehicle_ros.model.turning import turning

    turning(vehicle, radii[0], road)
    words = [path.stem if path else 'default vehicle', *overrides, *_in_words(road)]
    return MapRequest(', '.join(words), vehicle, road, radii, speeds)


def _road(path: Path | None, friction: float | None) -> Environment:
    road = load_road(path)
    if friction is not None:
        road = replace(road, friction=(friction,) * 4)
    return Environment(road.bank, road.wind, road.friction)


def _in_words(road: Environment) -> Iterator[str]:
    grips = road.friction[:1] if len(set(road.friction)) == 1 else road.friction
    yield f'friction {" ".join(f"{grip:g}" for grip in grips)}'
    if road.bank:
        yield f'bank {road.bank:g} rad'
    if road.wind:
        yield f'wind {road.wind:g} m/s'


def even_grid(option: str, text: str, highest: float, unit: str) -> tuple[float, ...]:
    """Read a range, such as ``2:20``, as evenly spaced numbers.

    Parameters
    ----------
    option
        Where the text comes from, for the error.
    text
        Two numbers, above 0 and rising, with a colon between.
    highest, unit
        What the larger one may be, and in which unit.

    Raises
    ------
    ParameterError
        The text says something else, or a number is above the highest.
    """
    try:
        low, high = map(float, text.split(':'))
    except ValueError:
        raise ParameterError(f'{option}: {text!r} must be LOW:HIGH, such as 2:20') from None
    if not 0.0 < low < high < math.inf:
        raise ParameterError(f'{option}: {text!r} must be two numbers above 0, the larger one last')
    if high > highest:
        raise ParameterError(
            f'{option}: {high:g} {unit} is above {highest:g} {unit}, the most that a map goes to; '
            'give LOW:HIGH within it'
        )
    return tuple(np.linspace(low, high, COUNT).tolist())
