"""The vehicle alone, from whatever kind of YAML file says something about it."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any

from omni_vehicle_ros.errors import ParameterError, ScenarioError
from omni_vehicle_ros.parameters import VehicleParameters
from omni_vehicle_ros.scenarios import yaml_text
from omni_vehicle_ros.scenarios.reading import read_mapping
from omni_vehicle_ros.scenarios.scenario import make_scenario
from omni_vehicle_ros.scenarios.settings import read_override

_ROS = 'ros__parameters'
_SECTION = 'vehicle'
_NAMES = frozenset(entry.name for entry in fields(VehicleParameters))


def load_vehicle(path: Path | None, overrides: Sequence[str] = ()) -> VehicleParameters:
    """Read the parameters of a vehicle.

    Parameters
    ----------
    path
        A ROS parameter file, such as ``config/vehicle.yaml``, of which other parameters don't matter; a scenario; or
        a mapping of vehicle parameters, by itself or under the key ``vehicle``. None: the default vehicle.
    overrides
        ``name=value`` for vehicle parameters, in SI units; of two for the same name the later holds.

    Raises
    ------
    ScenarioError
        One line: the file and the overrides, and what is wrong.
    """
    try:
        values = {} if path is None else _vehicle(path.stem, read_mapping(yaml_text.parse(path.read_bytes())))
        for override in overrides:
            name, value = read_override(override)
            values[name.removeprefix(f'{_SECTION}.')] = value
        return VehicleParameters.from_mapping(values)
    except OSError as error:
        raise ScenarioError(f'{path}: {error.strerror}') from None
    except (ParameterError, ScenarioError) as error:
        settings = f' with {" ".join(overrides)}' if overrides else ''
        raise ScenarioError(f'{path or "default vehicle"}{settings}: {error}') from None


def _vehicle(name: str, tree: Mapping[str, Any]) -> dict[str, Any]:
    blocks = list(_blocks(tree))
    if blocks:
        return _merged(blocks)
    if 'duration' in tree:
        return make_scenario(name, tree, ()).vehicle.as_dict()
    return read_mapping(tree.get(_SECTION, tree))


def _blocks(tree: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    """Yield the parameters of every node in a ROS parameter file, in any namespace."""
    for key, value in tree.items():
        if key == _ROS:
            yield read_mapping(value)
        elif isinstance(value, Mapping):
            yield from _blocks(value)


def _merged(blocks: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    merged: dict[str, Any] = {}
    for block in blocks:
        for name, value in block.items():
            if name in _NAMES and merged.setdefault(name, value) != value:
                raise ScenarioError(f'{name} is there twice, as {merged[name]!r} and as {value!r}')
    if not merged:
        raise ScenarioError('no vehicle parameters; they stand under /**: ros__parameters:, as in config/vehicle.yaml')
    return merged
