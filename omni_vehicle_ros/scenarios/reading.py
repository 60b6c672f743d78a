"""Pieces of a scenario file: mappings, numbers and lists in the order of time, each refused with the reason."""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeVar

from omni_vehicle_ros.errors import ScenarioError

T = TypeVar('T')


def read_timeline(
    name: str, tree: Any, read: Callable[[Any], T], follow: Callable[[T, Sequence[T]], None]
) -> tuple[T, ...]:
    """Make the entries of ``commands`` or ``environment``.

    What lies after the end of the scenario, be it a whole entry or the rest of one, is kept and never happens:
    a run may be cut short.

    Parameters
    ----------
    name
        Key of the list.
    tree
        The list.
    read
        Makes an entry from its mapping.
    follow
        Raises ScenarioError if an entry may not follow those before it.

    Raises
    ------
    ScenarioError
        Names the entry as ``name[i]``.
    """
    if not isinstance(tree, list):
        raise ScenarioError(f'{name}: {tree!r} must be a list')
    entries: list[T] = []
    for number, item in enumerate(tree):
        try:
            entry = read(item)
            follow(entry, entries)
        except ScenarioError as error:
            raise ScenarioError(f'{name}[{number}]: {error}') from None
        entries.append(entry)
    return tuple(entries)


def read_mapping(value: Any) -> dict[str, Any]:
    """Return a copy of a mapping, or raise ScenarioError."""
    if value is None:
        raise ScenarioError('is empty; it must be a mapping (key: value)')
    if not isinstance(value, Mapping):
        raise ScenarioError(f'{value!r} must be a mapping (key: value)')
    return dict(value)


def read_number(name: str, value: Any, low: float = -math.inf, high: float = math.inf) -> float:
    """Return a finite number within limits as float, or raise ScenarioError."""
    if value is None:
        raise ScenarioError(f'{name} is missing')
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ScenarioError(f'{name}: {value!r} must be a number')
    if not math.isfinite(value) or not low <= value <= high:
        raise ScenarioError(f'{name}: {value!r} is outside {low:g} .. {high:g}')
    return float(value)


def read_numbers(name: str, value: Any, count: int) -> Sequence[float]:
    """Return a list of ``count`` finite numbers, or raise ScenarioError."""
    if not isinstance(value, list) or len(value) != count:
        raise ScenarioError(f'{name}: {value!r} must be a list of {count} numbers')
    return [read_number(f'{name}[{number}]', item) for number, item in enumerate(value)]
