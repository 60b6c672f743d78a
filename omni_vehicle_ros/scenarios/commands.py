"""What a scenario says over time: commands of the driver, and changes of the environment."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

from omni_vehicle_ros.errors import ParameterError, ScenarioError
from omni_vehicle_ros.parameters import PlantParameters, check_value, did_you_mean
from omni_vehicle_ros.wheels import PerWheel

STRAIGHT = 'straight'
_FORMS = (
    frozenset({'icr', 'speed'}),
    frozenset({'icr', 'traction'}),
    frozenset({'icr', 'traction', 'yaw_moment'}),
    frozenset({'cmd_vel'}),
    frozenset({'silent'}),
)
_FORMS_TEXT = 'icr and speed; icr and traction (and yaw_moment); cmd_vel; or silent: true'
_ENVIRONMENT = ('at', 'bank', 'wind', 'friction')
_PLANT = {entry.name: entry for entry in fields(PlantParameters)}


@dataclass(frozen=True)
class Command:
    """What the driver says from a time on, until the next command.

    Either ``icr`` with ``speed``, or ``icr`` with ``traction``, or ``cmd_vel``, or nothing at all (silent).

    Attributes
    ----------
    at
        When it begins [s].
    icr
        Instantaneous centre of rotation (x, y) in ``base_link`` [m]; ``'straight'`` means straight on.
    speed
        Signed speed of the centre of gravity [m/s].
    traction
        Total traction (+) or brake force (-) [N], open loop.
    yaw_moment
        Moment by more traction on one side than on the other [N m].
    cmd_vel
        Body twist (vx, vy, yaw rate) [m/s, m/s, rad/s].
    """

    at: float
    icr: tuple[float, float] | str | None = None
    speed: float | None = None
    traction: float | None = None
    yaw_moment: float = 0.0
    cmd_vel: tuple[float, float, float] | None = None

    def to_mapping(self) -> dict[str, Any]:
        """Return the mapping that stands for it in a scenario file."""
        if self.cmd_vel is not None:
            return {'at': self.at, 'cmd_vel': list(self.cmd_vel)}
        if self.icr is None:
            return {'at': self.at, 'silent': True}
        icr = self.icr if isinstance(self.icr, str) else list(self.icr)
        if self.speed is not None:
            return {'at': self.at, 'icr': icr, 'speed': self.speed}
        return {'at': self.at, 'icr': icr, 'traction': self.traction, 'yaw_moment': self.yaw_moment}


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

    def to_mapping(self) -> dict[str, Any]:
        """Return the mapping that stands for it in a scenario file."""
        tree: dict[str, Any] = {'at': self.at}
        for name in ('bank', 'wind'):
            if getattr(self, name) is not None:
                tree[name] = getattr(self, name)
        if self.friction is not None:
            tree['friction'] = list(self.friction)
        return tree


def read_command(tree: Any) -> Command:
    """Make a command from its mapping in a scenario file, or raise ScenarioError."""
    entries = read_mapping(tree)
    at = read_number('at', entries.pop('at', None), low=0.0)
    form = frozenset(entries)
    if form not in _FORMS:
        raise ScenarioError(f'{", ".join(entries) or "nothing"} beside at; allowed: {_FORMS_TEXT}')
    if 'silent' in entries:
        if entries['silent'] is not True:
            raise ScenarioError(f'silent: {entries["silent"]!r} must be true')
        return Command(at)
    if 'cmd_vel' in entries:
        vx, vy, yaw_rate = read_numbers('cmd_vel', entries['cmd_vel'], 3)
        return Command(at, cmd_vel=(vx, vy, yaw_rate))
    return Command(
        at,
        icr=_read_icr(entries['icr']),
        speed=_read_optional('speed', entries),
        traction=_read_optional('traction', entries),
        yaw_moment=_read_optional('yaw_moment', entries) or 0.0,
    )


def _read_optional(name: str, entries: Mapping[str, Any]) -> float | None:
    return read_number(name, entries[name]) if name in entries else None


def _read_icr(value: Any) -> tuple[float, float] | str:
    if isinstance(value, str):
        if value != STRAIGHT:
            raise ScenarioError(f'icr: {value!r} must be [x, y] or straight')
        return STRAIGHT
    x, y = read_numbers('icr', value, 2)
    return x, y


def read_change(tree: Any) -> EnvironmentChange:
    """Make a change of the environment from its mapping in a scenario file, or raise ScenarioError."""
    entries = read_mapping(tree)
    for name in entries:
        if name not in _ENVIRONMENT:
            raise ScenarioError(f'unknown key {name!r}{did_you_mean(name, _ENVIRONMENT)}')
    at = read_number('at', entries.pop('at', None), low=0.0)
    if not entries:
        raise ScenarioError('nothing beside at; allowed: bank, wind, friction')
    if 'friction' in entries and not isinstance(entries['friction'], list):
        entries['friction'] = [entries['friction']] * 4
    try:
        return EnvironmentChange(at, **{name: check_value(_PLANT[name], value) for name, value in entries.items()})
    except ParameterError as error:
        raise ScenarioError(str(error)) from None


def read_timeline(name: str, tree: Any, read: Callable[[Any], Any]) -> tuple[Any, ...]:
    """Make the entries of ``commands`` or ``environment``, which must rise in time.

    What begins after the end of the scenario is kept and never happens: a run may be cut short.

    Raises
    ------
    ScenarioError
        Names the entry as ``name[i]``.
    """
    if not isinstance(tree, list):
        raise ScenarioError(f'{name}: {tree!r} must be a list')
    entries: list[Any] = []
    for number, item in enumerate(tree):
        try:
            entry = read(item)
            if entries and entry.at <= entries[-1].at:
                raise ScenarioError(f'at: {entry.at:g} s must be later than the entry before, {entries[-1].at:g} s')
        except ScenarioError as error:
            raise ScenarioError(f'{name}[{number}]: {error}') from None
        entries.append(entry)
    return tuple(entries)


def read_mapping(value: Any) -> dict[str, Any]:
    """Return a copy of a mapping, or raise ScenarioError."""
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
