"""What happens around the vehicle of a scenario over time: steps and profiles of bank, wind and friction."""

import math
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any

from omni_vehicle_ros.errors import ParameterError, ScenarioError
from omni_vehicle_ros.model.disturbances import BEAUFORT_NUMBERS, beaufort
from omni_vehicle_ros.parameters import PlantParameters, check_value, did_you_mean
from omni_vehicle_ros.scenarios.reading import read_mapping, read_number
from omni_vehicle_ros.wheels import PerWheel, per_wheel

QUANTITIES = ('bank', 'wind', 'friction')
_STEP = ('at', 'bank', 'wind', 'beaufort', 'friction')
_PROFILE = ('profile', 'points')
_PLANT = {entry.name: entry for entry in fields(PlantParameters)}
_HIGHEST_WIND: float = _PLANT['wind'].metadata['high']
_STRONGEST = max(number for number in BEAUFORT_NUMBERS if beaufort(number).mean <= _HIGHEST_WIND)


@dataclass(frozen=True)
class EnvironmentChange:
    """What changes around the vehicle at a time; None stays as it was.

    Attributes
    ----------
    at
        When [s].
    bank
        Bank angle of the road [rad]; positive pushes the vehicle to its left.
    wind
        Lateral wind [m/s]; positive blows to the left of the vehicle.
    friction
        Friction coefficient under each wheel.
    """

    at: float
    bank: float | None = None
    wind: float | None = None
    friction: PerWheel | None = None

    @property
    def end(self) -> float:
        """When it is over [s]: at once."""
        return self.at

    @property
    def quantities(self) -> tuple[str, ...]:
        """What it changes."""
        return tuple(name for name in QUANTITIES if getattr(self, name) is not None)

    def to_mapping(self) -> dict[str, Any]:
        """Return the mapping that stands for it in a scenario file."""
        tree: dict[str, Any] = {'at': self.at}
        for name in ('bank', 'wind'):
            if getattr(self, name) is not None:
                tree[name] = getattr(self, name)
        if self.friction is not None:
            tree['friction'] = list(self.friction)
        return tree


@dataclass(frozen=True)
class EnvironmentProfile:
    """How one quantity changes over time, in straight lines from point to point; it keeps its last value.

    What of it lies after the end of the scenario never happens.

    Attributes
    ----------
    quantity
        bank, wind or friction.
    points
        Times [s], rising, and values as in `EnvironmentChange`: one number, for friction that of each wheel.
    """

    quantity: str
    points: tuple[tuple[float, tuple[float, ...]], ...]

    @property
    def at(self) -> float:
        """When it begins [s]."""
        return self.points[0][0]

    @property
    def end(self) -> float:
        """When it is over [s]."""
        return self.points[-1][0]

    @property
    def quantities(self) -> tuple[str, ...]:
        """What it changes."""
        return (self.quantity,)

    def values(self, time: float) -> tuple[float, ...]:
        """Return the numbers that hold at a time [s]; before the first point those of the first."""
        after = bisect_right(self.points, time, key=lambda point: point[0])
        start, low = self.points[max(after - 1, 0)]
        if time <= start or after == len(self.points):
            return low
        end, high = self.points[after]
        share = (time - start) / (end - start)
        return tuple(a + share * (b - a) for a, b in zip(low, high, strict=True))

    def change(self, time: float) -> EnvironmentChange:
        """Return the step that sets the quantity to what holds at a time [s]."""
        values = self.values(time)
        value: Any = per_wheel(values.__getitem__) if self.quantity == 'friction' else values[0]
        return EnvironmentChange(time, **{self.quantity: value})

    def to_mapping(self) -> dict[str, Any]:
        """Return the mapping that stands for it in a scenario file."""
        points = [[time, list(values) if self.quantity == 'friction' else values[0]] for time, values in self.points]
        return {'profile': self.quantity, 'points': points}


def read_environment(tree: Any) -> EnvironmentChange | EnvironmentProfile:
    """Make an entry of the environment from its mapping in a scenario file, or raise ScenarioError.

    A step has ``at`` and what changes then: bank, wind (or its Beaufort number, negative if it blows to the right:
    the middle of its range in Table 4.1 of the thesis, where 0 and 1 are one range) and friction, of all wheels or
    of each. A profile has ``profile``, the quantity, and ``points``, a list of [time, value].
    """
    entries = read_mapping(tree)
    return _read_profile(entries) if 'profile' in entries else _read_change(entries)


def follow_environment(
    entry: EnvironmentChange | EnvironmentProfile, before: Sequence[EnvironmentChange | EnvironmentProfile]
) -> None:
    """Check that an entry keeps the order of time and the others' profiles alone, or raise ScenarioError."""
    if before and entry.at < before[-1].at:
        raise ScenarioError(f'at: {entry.at:g} s must not be earlier than the entry before, {before[-1].at:g} s')
    for quantity in entry.quantities:
        end = next((earlier.end for earlier in reversed(before) if quantity in earlier.quantities), -math.inf)
        if entry.at <= end:
            raise ScenarioError(f'{quantity}: {entry.at:g} s must be later than its last change before, {end:g} s')


def _read_change(entries: dict[str, Any]) -> EnvironmentChange:
    _check_keys(entries, _STEP)
    at = read_number('at', entries.pop('at', None), low=0.0)
    if not entries:
        raise ScenarioError('nothing beside at; allowed: bank, wind or beaufort, friction')
    if 'beaufort' in entries:
        if 'wind' in entries:
            raise ScenarioError('wind and beaufort say the same; leave one of them out')
        entries['wind'] = _wind(entries.pop('beaufort'))
    return EnvironmentChange(at, **{name: _checked(name, value) for name, value in entries.items()})


def _wind(number: Any) -> float:
    if isinstance(number, bool) or not isinstance(number, int):
        raise ScenarioError(f'beaufort: {number!r} must be a whole number; negative: the wind blows to the right')
    if abs(number) > _STRONGEST:
        raise ScenarioError(
            f'beaufort: {number} is outside {-_STRONGEST} .. {_STRONGEST}, as wind is held to {_HIGHEST_WIND:g} m/s'
        )
    return math.copysign(beaufort(abs(number)).mean, number)


def _read_profile(entries: dict[str, Any]) -> EnvironmentProfile:
    _check_keys(entries, _PROFILE)
    quantity, points = entries['profile'], entries.get('points')
    if quantity not in QUANTITIES:
        raise ScenarioError(f'profile: {quantity!r} is not one of {", ".join(QUANTITIES)}')
    if not isinstance(points, list) or len(points) < 2:
        raise ScenarioError(f'points: {points!r} must be a list of 2 or more [time, value]')
    read: list[tuple[float, tuple[float, ...]]] = []
    for number, point in enumerate(points):
        try:
            if not isinstance(point, list) or len(point) != 2:
                raise ScenarioError(f'{point!r} must be [time, value]')
            time = read_number('time', point[0], low=0.0)
            if read and time <= read[-1][0]:
                raise ScenarioError(f'time: {time:g} s must be later than the point before, {read[-1][0]:g} s')
            value = _checked(quantity, point[1])
        except ScenarioError as error:
            raise ScenarioError(f'points[{number}]: {error}') from None
        read.append((time, value if isinstance(value, tuple) else (value,)))
    return EnvironmentProfile(quantity, tuple(read))


def _check_keys(entries: dict[str, Any], allowed: tuple[str, ...]) -> None:
    for name in entries:
        if name not in allowed:
            raise ScenarioError(f'unknown key {name!r}{did_you_mean(name, allowed)}')


def _checked(quantity: str, value: Any) -> Any:
    """Return a value of a quantity that the plant takes; one number as friction stands for all wheels."""
    if quantity == 'friction' and not isinstance(value, list):
        value = [value] * 4
    try:
        return check_value(_PLANT[quantity], value)
    except ParameterError as error:
        raise ScenarioError(str(error)) from None
