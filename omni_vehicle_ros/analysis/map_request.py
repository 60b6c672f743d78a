"""What a turn map is to show, as the command line says it."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from omni_vehicle_ros.errors import ParameterError
from omni_vehicle_ros.model.dynamics import Environment
from omni_vehicle_ros.parameters import PlantParameters, VehicleParameters
from omni_vehicle_ros.scenarios.vehicle_file import load_vehicle

COUNT = 61  # of radii and of speeds


class MapRequest(NamedTuple):
    """A vehicle on its road, and the radii [m] and speeds [m/s] at which to look, both rising; ``title`` in words."""

    title: str
    vehicle: VehicleParameters
    environment: Environment
    radii: tuple[float, ...]
    speeds: tuple[float, ...]


def read_request(
    path: Path | None, overrides: Sequence[str], friction: float, radius: str, speed: str
) -> MapRequest:
    """Read what a map is to show.

    Parameters
    ----------
    path, overrides
        The vehicle; see `load_vehicle`.
    friction
        Friction coefficient under all wheels.
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
    road = Environment(friction=PlantParameters(friction=(friction,) * 4).friction)
    radii, speeds = even_grid('--radius', radius), even_grid('--speed', speed)
    # The compiled physics takes a second to import; what is refused before should not pay for it.
    from omni_vehicle_ros.model.turning import turning

    turning(vehicle, radii[0], road)
    words = [path.stem if path else 'default vehicle', *overrides, f'friction {friction:g}']
    return MapRequest(', '.join(words), vehicle, road, radii, speeds)


def even_grid(option: str, text: str) -> tuple[float, ...]:
    """Read a range, such as ``2:20``, as evenly spaced numbers.

    Parameters
    ----------
    option
        Where the text comes from, for the error.
    text
        Two numbers, above 0 and rising, with a colon between.

    Raises
    ------
    ParameterError
        The text says something else.
    """
    try:
        low, high = map(float, text.split(':'))
    except ValueError:
        raise ParameterError(f'{option}: {text!r} must be LOW:HIGH, such as 2:20') from None
    if not 0.0 < low < high < math.inf:
        raise ParameterError(f'{option}: {text!r} must be two numbers above 0, the larger one last')
    return tuple(np.linspace(low, high, COUNT).tolist())
