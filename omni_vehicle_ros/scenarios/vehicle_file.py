"""The vehicle alone, or its road, from whatever kind of YAML file says something about it."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

from omni_vehicle_ros.errors import ParameterError, ScenarioError
from omni_vehicle_ros.parameters import PlantParameters, VehicleParameters
from omni_vehicle_ros.scenarios import yaml_text
from omni_vehicle_ros.scenarios.environment import QUANTITIES, EnvironmentProfile
from omni_vehicle_ros.scenarios.reading import read_mapping
from omni_vehicle_ros.scenarios.scenario import Scenario, make_scenario
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
        values = {} if path is None else _vehicle(path.stem, _tree(path))
        for override in overrides:
            name, value = read_override(override)
            values[name.removeprefix(f'{_SECTION}.')] = value
        _without_road(values)
        return VehicleParameters.from_mapping(values)
    except OSError as error:
        raise ScenarioError(f'{path}: {error.strerror}') from None
    except (ParameterError, ScenarioError) as error:
        settings = f' with {" ".join(overrides)}' if overrides else ''
        raise ScenarioError(f'{path or "default vehicle"}{settings}: {error}') from None


def load_road(path: Path | None) -> PlantParameters:
    """Read bank, wind and friction from a file that `load_vehicle` takes; the defaults where it says nothing.

    Of a scenario they are those at its start, whatever comes later.

    Raises
    ------
    ScenarioError
        One line: the file, and what is wrong.
    """
    try:
        return PlantParameters() if path is None else _road(path.stem, _tree(path))
    except OSError as error:
        raise ScenarioError(f'{path}: {error.strerror}') from None
    except (ParameterError, ScenarioError) as error:
        raise ScenarioError(f'{path}: {error}') from None


def _road(name: str, tree: Mapping[str, Any]) -> PlantParameters:
    blocks = list(_blocks(tree))
    if blocks:
        return PlantParameters.from_mapping(_merged(blocks, frozenset(QUANTITIES)))
    if 'duration' in tree:
        return _at_the_start(make_scenario(name, tree, ()))
    plant = read_mapping(tree.get('plant', {}))
    return PlantParameters.from_mapping({key: plant[key] for key in QUANTITIES if key in plant})


def _at_the_start(scenario: Scenario) -> PlantParameters:
    plant = scenario.plant
    for entry in scenario.environment:
        if entry.at <= 0.0:
            change = entry.change(0.0) if isinstance(entry, EnvironmentProfile) else entry
            plant = replace(plant, **{key: getattr(change, key) for key in change.quantities})
    return plant


def _tree(path: Path) -> dict[str, Any]:
    return read_mapping(yaml_text.parse(path.read_bytes()))


def _vehicle(name: str, tree: Mapping[str, Any]) -> dict[str, Any]:
    blocks = list(_blocks(tree))
    if blocks:
        merged = _merged(blocks, _NAMES)
        if not merged:
            words = 'no vehicle parameters; they stand under /**: ros__parameters:, as in config/vehicle.yaml'
            raise ScenarioError(words)
        return merged
    if 'duration' in tree:
        return make_scenario(name, tree, ()).vehicle.as_dict()
    if _SECTION in tree:
        _without_road(tree)
    return read_mapping(tree.get(_SECTION, tree))


def _without_road(names: Iterable[str]) -> None:
    for name in names:
        if name in QUANTITIES:
            option = 'give --friction, or ' if name == 'friction' else ''
            raise ScenarioError(
                f'{name} is no vehicle parameter but one of the road: {option}put it under plant:, beside vehicle:'
            )


def _blocks(tree: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    """Yield the parameters of every node in a ROS parameter file, in any namespace."""
    for key, value in tree.items():
        if key == _ROS:
            yield read_mapping(value)
        elif isinstance(value, Mapping):
            yield from _blocks(value)


def _merged(blocks: Sequence[Mapping[str, Any]], names: frozenset[str]) -> dict[str, Any]:
    merged: dict[str, Any] = {}
    for block in blocks:
        for name, value in block.items():
            if name in names and merged.setdefault(name, value) != value:
                raise ScenarioError(f'{name} is there twice, as {merged[name]!r} and as {value!r}')
    return merged
