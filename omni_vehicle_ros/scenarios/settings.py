"""What ``--set`` and ``vary`` change in the mapping of a scenario file, and where its ``values`` stand."""

import re
from collections.abc import Mapping
from typing import Any

from omni_vehicle_ros.errors import ScenarioError
from omni_vehicle_ros.parameters import did_you_mean
from omni_vehicle_ros.scenarios import yaml_text
from omni_vehicle_ros.scenarios.reading import read_mapping, read_number

SECTIONS = ('vehicle', 'steering', 'wheel_module', 'side_slip', 'plant')
PLAIN = ('duration', 'side_slip_control', 'command_period')
_GRID = frozenset({'from', 'to', 'count'})
_MOST_VALUES = 1000
_REFERENCE = re.compile(r'(-?)\$(.*)', re.DOTALL)

Setting = tuple[str, Any]
"""A name that ``--set`` takes, and its value."""


def read_override(text: str) -> Setting:
    """Read one ``name=value``, or raise ScenarioError."""
    name, equals, value = text.partition('=')
    if not equals:
        raise ScenarioError(f'{text!r} must be name=value')
    return name.strip(), yaml_text.parse(value)


def apply_setting(setting: Setting, entries: dict[str, Any], values: dict[str, Any]) -> None:
    """Put a setting where it belongs: among the values, or into the entries of the file.

    Raises
    ------
    ScenarioError
        Nothing has that name, or it would have no effect.
    """
    name, value = setting
    section, dot, parameter = name.partition('.')
    if dot and section in SECTIONS:
        entries[section][parameter] = value
    elif name in values and _uses(name, entries):
        values[name] = value
    elif name in PLAIN:
        entries[name] = value
    elif name in values:
        raise ScenarioError(f'{name} has no effect: this file does not say ${name} anywhere')
    else:
        sections = (f'{section}.PARAMETER' for section in SECTIONS)
        raise ScenarioError(f'unknown name {name!r}{did_you_mean(name, dict.fromkeys((*values, *PLAIN, *sections)))}')


def _uses(name: str, tree: Any) -> bool:
    if isinstance(tree, dict):
        return any(_uses(name, item) for item in tree.values())
    if isinstance(tree, list):
        return any(_uses(name, item) for item in tree)
    return tree in (f'${name}', f'-${name}')


def fill_in(tree: Any, values: Mapping[str, Any]) -> Any:
    """Put the values in the place of their ``$name``, and the opposite number in that of ``-$name``.

    Raises
    ------
    ScenarioError
        There is no such value, or no opposite of it.
    """
    if isinstance(tree, dict):
        return {key: fill_in(item, values) for key, item in tree.items()}
    if isinstance(tree, list):
        return [fill_in(item, values) for item in tree]
    reference = _REFERENCE.fullmatch(tree) if isinstance(tree, str) else None
    if reference is None:
        return tree
    minus, name = reference.groups()
    if name not in values:
        raise ScenarioError(f'{tree} is not among the values{did_you_mean(name, values)}')
    return -read_number(name, values[name]) if minus else values[name]


def read_vary(tree: Any) -> dict[str, tuple[Any, ...]]:
    """Read ``vary``: names, each with a list of values or with ``{from, to, count}`` for an even grid.

    Raises
    ------
    ScenarioError
        Names the entry.
    """
    axes = {}
    for name, values in read_mapping(tree).items():
        try:
            axes[name] = _even_grid(values) if isinstance(values, Mapping) else _listed(values)
        except ScenarioError as error:
            raise ScenarioError(f'{name}: {error}') from None
    return axes


def _listed(values: Any) -> tuple[Any, ...]:
    if not isinstance(values, list) or not values:
        raise ScenarioError(f'{values!r} must be a list of values, or {{from, to, count}}')
    return tuple(values)


def _even_grid(tree: Mapping[str, Any]) -> tuple[float, ...]:
    if set(tree) != _GRID:
        raise ScenarioError(f'{", ".join(tree) or "nothing"} given; an even grid has from, to and count')
    first, last = (read_number(key, tree[key]) for key in ('from', 'to'))
    count = tree['count']
    if isinstance(count, bool) or not isinstance(count, int) or not 2 <= count <= _MOST_VALUES:
        raise ScenarioError(f'count: {count!r} must be a whole number, 2 .. {_MOST_VALUES}')
    steps = count - 1
    return (*(first + step * (last - first) / steps for step in range(steps)), last)
