"""Scenarios by name or path, with overrides: one run, or every variant of it."""

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, TypeVar

from omni_vehicle_ros.errors import ScenarioError
from omni_vehicle_ros.scenarios import yaml_text
from omni_vehicle_ros.scenarios.library import find_scenario
from omni_vehicle_ros.scenarios.scenario import Scenario, make_scenario
from omni_vehicle_ros.scenarios.settings import Setting, read_override, read_vary

T = TypeVar('T')


def load_scenario(name_or_path: str, overrides: Sequence[str] = ()) -> Scenario:
    """Read a scenario.

    Parameters
    ----------
    name_or_path
        The name of a scenario in ``config/scenarios``, or the path of a YAML file.
    overrides
        ``name=value`` for the names in ``values``, and for duration, side_slip_control and command_period;
        ``section.name=value`` for parameters, such as ``vehicle.mass=1400``. A value is a YAML scalar or list.
        Of two for the same name the later holds. What is overridden is no longer varied.

    Returns
    -------
    Scenario
        Checked, with a duration of whole control cycles (rounded up).

    Raises
    ------
    ScenarioError
        One line: the file, the place in it, what is wrong, and what is allowed.
    """
    return _load(name_or_path, overrides, build_scenario)


def variants(name_or_path: str, overrides: Sequence[str] = ()) -> tuple[tuple[dict[str, Any], Scenario], ...]:
    """Read a scenario once for every combination of the values that it varies.

    Parameters
    ----------
    name_or_path, overrides
        As in `load_scenario`.

    Returns
    -------
    tuple of (dict, Scenario)
        What was varied and how, with the scenario that results; the last name of ``vary`` changes fastest. One
        scenario, with nothing varied, if there is no ``vary``.

    Raises
    ------
    ScenarioError
        As in `load_scenario`; also a combination that doesn't go together.
    """
    return _load(name_or_path, overrides, _variants)


def _load(name_or_path: str, overrides: Sequence[str], build: Callable[[str, Any, Sequence[str]], T]) -> T:
    name, path = find_scenario(name_or_path)
    try:
        text = path.read_bytes()
    except OSError as error:
        raise ScenarioError(f'{path}: {error.strerror}') from None
    try:
        return build(name, yaml_text.parse(text), overrides)
    except ScenarioError as error:
        settings = f' with {" ".join(overrides)}' if overrides else ''
        raise ScenarioError(f'{path}{settings}: {error}') from None


def build_scenario(name: str, tree: Any, overrides: Sequence[str] = ()) -> Scenario:
    """Make a scenario from the mapping that its file holds; see `load_scenario`."""
    settings = [read_override(override) for override in overrides]
    scenario = make_scenario(name, tree, settings)
    axes = _read_axes(tree, settings)
    for axis, values in axes.items():
        for value in values:
            _variant(name, tree, settings, {axis: value})
    return replace(scenario, vary=axes)


def _variants(name: str, tree: Any, overrides: Sequence[str]) -> tuple[tuple[dict[str, Any], Scenario], ...]:
    axes = build_scenario(name, tree, overrides).vary
    settings = [read_override(override) for override in overrides]
    points = (dict(zip(axes, values, strict=True)) for values in itertools.product(*axes.values()))
    return tuple((point, _variant(name, tree, settings, point)) for point in points)


def _read_axes(tree: Mapping[str, Any], settings: Sequence[Setting]) -> dict[str, tuple[Any, ...]]:
    fixed = {name for name, _ in settings}
    try:
        return {name: values for name, values in read_vary(tree.get('vary', {})).items() if name not in fixed}
    except ScenarioError as error:
        raise ScenarioError(f'vary: {error}') from None


def _variant(name: str, tree: Any, settings: Sequence[Setting], point: Mapping[str, Any]) -> Scenario:
    try:
        return make_scenario(name, tree, [*settings, *point.items()])
    except ScenarioError as error:
        varied = ', '.join(f'{key} = {value}' for key, value in point.items())
        raise ScenarioError(f'vary: {varied}: {error}') from None
