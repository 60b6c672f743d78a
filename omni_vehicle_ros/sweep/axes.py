"""What a sweep varies: names with ranges, lists of values, or distributions."""

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import fields
from itertools import chain
from typing import Any, NamedTuple

import numpy as np
from scipy import stats

from omni_vehicle_ros.errors import ScenarioError
from omni_vehicle_ros.model.state import Vector
from omni_vehicle_ros.parameters import PlantParameters, VehicleParameters, did_you_mean
from omni_vehicle_ros.scenarios import yaml_text
from omni_vehicle_ros.scenarios.scenario import Scenario
from omni_vehicle_ros.scenarios.settings import PLAIN, SECTIONS

MOST_VALUES = 100_000
_RANGE = re.compile(r'([^:]*):([^:]*):([^:]*)')
_DRAWN = re.compile(r'(\w+)\s*\((.*)\)')
_BARE: Mapping[str, tuple[str, ...]] = {
    section: tuple(entry.name for entry in fields(kind))
    for section, kind in (('vehicle', VehicleParameters), ('plant', PlantParameters))
}
_UNITS = {
    'duration': 's', 'command_period': 's', 'at': 's', 'icr': 'm', 'speed': 'm/s', 'traction': 'N',
    'wheel_traction': 'N', 'yaw_moment': 'N m', 'bank': 'rad', 'wind': 'm/s', 'friction': '1',
}  # fmt: skip


class Distribution(NamedTuple):
    """A distribution by its name in `DISTRIBUTIONS`, and its numbers."""

    name: str
    numbers: tuple[float, ...]

    def quantiles(self, shares: Vector) -> Vector:
        """Return the values below which these shares, 0 to 1, of all draws lie."""
        return np.asarray(DISTRIBUTIONS[self.name].make(*self.numbers).ppf(shares))


class _Kind(NamedTuple):
    words: str
    make: Callable[..., Any]


def _truncated(mean: float, deviation: float, low: float, high: float) -> Any:
    return stats.truncnorm((low - mean) / deviation, (high - mean) / deviation, mean, deviation)


DISTRIBUTIONS = {
    'uniform': _Kind('low, high', lambda low, high: stats.uniform(low, high - low)),
    'normal': _Kind('mean, deviation', stats.norm),
    'truncnormal': _Kind('mean, deviation, low, high', _truncated),
    'lognormal': _Kind('median, sigma', lambda median, sigma: stats.lognorm(sigma, scale=median)),
    'triangular': _Kind(
        'low, mode, high', lambda low, mode, high: stats.triang((mode - low) / (high - low), low, high - low)
    ),
}


class Axis(NamedTuple):
    """One thing that is varied.

    Attributes
    ----------
    name
        As the user says it; the name of its column.
    setting
        As ``--set`` takes it.
    unit
        SI; '1' for ratios, '' for words and what is not known.
    values
        Of a grid; empty with a distribution.
    distribution
        What samples are drawn from.
    wheels
        Whether one number stands for all four wheels.
    """

    name: str
    setting: str
    unit: str
    values: tuple[Any, ...]
    distribution: Distribution | None = None
    wheels: bool = False

    def setting_of(self, value: Any) -> tuple[str, Any]:
        """Return the setting for a value."""
        return self.setting, [value] * 4 if self.wheels and not isinstance(value, list) else value

    @property
    def text(self) -> str:
        """What is varied, in words."""
        if self.distribution is not None:
            return f'{self.distribution.name}({", ".join(f"{number:g}" for number in self.distribution.numbers)})'
        if len(self.values) > 6:
            return f'{self.values[0]} .. {self.values[-1]}, {len(self.values)} values'
        return ', '.join(map(str, self.values))


def read_axis(text: str, scenario: Scenario, tree: Mapping[str, Any]) -> Axis:
    """Read one ``name=start:stop:count``, ``name=a,b,c`` or ``name=distribution(...)``.

    Parameters
    ----------
    text
        What the user says.
    scenario, tree
        The scenario, for the names of its values, and the mapping of its file, for their units.

    Raises
    ------
    ScenarioError
        One line: the text, what is wrong, what is allowed.
    """
    name, equals, values = (part.strip() for part in text.partition('='))
    try:
        if not equals or not values:
            raise ScenarioError('must be name=start:stop:count, name=a,b,c or name=distribution(...)')
        setting = _setting(name, scenario)
        unit, wheels = _unit(setting, tree), _per_wheel(setting)
        return Axis(name, setting, unit, *_read_values(values), wheels)
    except ScenarioError as error:
        raise ScenarioError(f'--vary {text}: {error}') from None


def listed_axis(name: str, values: tuple[Any, ...], tree: Mapping[str, Any]) -> Axis:
    """Return the axis of an entry of ``vary`` in a scenario file."""
    return Axis(name, name, _unit(name, tree), values, None, _per_wheel(name))


def _setting(name: str, scenario: Scenario) -> str:
    """Return what ``--set`` calls it: a value of the scenario first, else a parameter of vehicle or plant."""
    if name in scenario.values or name in PLAIN or name.partition('.')[0] in SECTIONS:
        return name
    for section, parameters in _BARE.items():
        if name in parameters:
            return f'{section}.{name}'
    known = [*scenario.values, *PLAIN, *chain(*_BARE.values())]
    close = did_you_mean(name, known)
    if close.startswith('; did'):
        raise ScenarioError(f'unknown name {name!r}{close}')
    allowed = ', '.join((*scenario.values, *PLAIN))
    raise ScenarioError(f'unknown name {name!r}; allowed: {allowed}, and parameters of vehicle and plant')


def _read_values(text: str) -> tuple[tuple[Any, ...], Distribution | None]:
    if drawn := _DRAWN.fullmatch(text):
        return (), _read_distribution(*drawn.groups())
    if evenly := _RANGE.fullmatch(text):
        return _read_range(*evenly.groups()), None
    values = yaml_text.parse(f'[{text}]')
    if len(set(map(str, values))) < len(values):
        raise ScenarioError('a value is there twice')
    return tuple(values), None


def _read_range(start: str, stop: str, number: str) -> tuple[float, ...]:
    first, last = _number(start), _number(stop)
    if not number.strip().isdigit() or not 2 <= int(number) <= MOST_VALUES:
        raise ScenarioError(f'count: {number!r} must be a whole number, 2 .. {MOST_VALUES}')
    if first == last:
        raise ScenarioError(f'start and stop are both {first:g}; set it by --set')
    return tuple(np.linspace(first, last, int(number)).tolist())


def _read_distribution(name: str, text: str) -> Distribution:
    if name not in DISTRIBUTIONS:
        raise ScenarioError(f'unknown distribution {name!r}{did_you_mean(name, DISTRIBUTIONS)}')
    words = DISTRIBUTIONS[name].words
    numbers = tuple(_number(part) for part in text.split(','))
    if len(numbers) != words.count(',') + 1:
        raise ScenarioError(f'{len(numbers)} numbers given; it must be {name}({words})')
    found = Distribution(name, numbers)
    with np.errstate(all='ignore'):
        low, high = found.quantiles(np.array([0.25, 0.75])).tolist()
    if not low < high:
        raise ScenarioError(f'there is no such distribution; it must be {name}({words}), not of one value only')
    return found


def _number(text: str) -> float:
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise ScenarioError(f'{text.strip()!r} must be a number')
    return number


def _unit(setting: str, tree: Mapping[str, Any]) -> str:
    """Return the unit of a parameter, or of the place where the file says ``$name``."""
    if setting in _UNITS and setting in PLAIN:
        return _UNITS[setting]
    section, dot, name = setting.partition('.')
    if dot:
        return _parameter_unit(section, name)
    for key in (key for key in tree if key not in ('values', 'vary')):
        place = _place(tree[key], setting, key)
        if place is not None:
            return _parameter_unit(key, place) if key in SECTIONS else _UNITS.get(place, '')
    return ''


def _place(tree: Any, name: str, key: str) -> str | None:
    """Return under which key a tree says ``$name``."""
    if isinstance(tree, Mapping):
        key = str(tree.get('profile', key))
        found = (_place(item, name, key if own == 'points' else own) for own, item in tree.items())
        return next(filter(None, found), None)
    if isinstance(tree, list):
        return next(filter(None, (_place(item, name, key) for item in tree)), None)
    return key if tree in (f'${name}', f'-${name}') else None


def _parameter(section: str, name: str) -> Any:
    """Return the field of a parameter, or None: who makes the scenario says what is wrong."""
    if section not in SECTIONS:
        return None
    kind = type(getattr(Scenario('', 1.0), section))
    return next((entry for entry in fields(kind) if entry.name == name), None)


def _parameter_unit(section: str, name: str) -> str:
    entry = _parameter(section, name)
    if entry is None or isinstance(entry.default, str | bool):
        return ''
    return entry.metadata['unit'] or '1'


def _per_wheel(setting: str) -> bool:
    entry = _parameter(*setting.partition('.')[::2])
    return entry is not None and isinstance(entry.default, tuple) and len(entry.default) == 4
