"""What the driver of a scenario says over time."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from omni_vehicle_ros.control.motion import MINIMUM_ICR_DISTANCE
from omni_vehicle_ros.errors import ScenarioError
from omni_vehicle_ros.scenarios.reading import read_mapping, read_number, read_numbers

STRAIGHT = 'straight'
_FORMS = (
    frozenset({'icr', 'speed'}),
    frozenset({'icr', 'traction'}),
    frozenset({'icr', 'traction', 'yaw_moment'}),
    frozenset({'icr', 'wheel_traction'}),
    frozenset({'icr', 'wheel_traction', 'yaw_moment'}),
    frozenset({'cmd_vel'}),
    frozenset({'teleop'}),
    frozenset({'silent'}),
)
_FORMS_TEXT = 'icr and speed; icr and traction or wheel_traction (and yaw_moment); cmd_vel; teleop; or silent: true'


@dataclass(frozen=True)
class Command:
    """What the driver says from a time on, until the next command.

    Either ``icr`` with ``speed``, or ``icr`` with ``traction``, or ``cmd_vel``, or ``teleop``, or nothing at all
    (silent); each of them with or without ``emergency_stop``.

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
        Body twist (vx, vy, yaw rate) [m/s, m/s, rad/s], as autonomy says it.
    teleop
        The same, as a hand says it.
    emergency_stop
        Whether an emergency stop is asked for; None: not a word about it.
    """

    at: float
    icr: tuple[float, float] | str | None = None
    speed: float | None = None
    traction: float | None = None
    yaw_moment: float = 0.0
    cmd_vel: tuple[float, float, float] | None = None
    teleop: tuple[float, float, float] | None = None
    emergency_stop: bool | None = None

    @property
    def silent(self) -> bool:
        """Whether nothing is said of where to go."""
        return self.icr is None and self.twist is None

    @property
    def twist(self) -> tuple[float, float, float] | None:
        """The body twist, whoever says it."""
        return self.teleop if self.cmd_vel is None else self.cmd_vel

    def to_mapping(self) -> dict[str, Any]:
        """Return the mapping that stands for it in a scenario file."""
        stop = {} if self.emergency_stop is None else {'emergency_stop': self.emergency_stop}
        return {'at': self.at, **self._form(), **stop}

    def _form(self) -> dict[str, Any]:
        if self.twist is not None:
            return {'teleop' if self.cmd_vel is None else 'cmd_vel': list(self.twist)}
        if self.icr is None:
            return {'silent': True}
        icr = self.icr if isinstance(self.icr, str) else list(self.icr)
        if self.speed is not None:
            return {'icr': icr, 'speed': self.speed}
        return {'icr': icr, 'traction': self.traction, 'yaw_moment': self.yaw_moment}


def read_command(tree: Any, driven_wheels: int = 4) -> Command:
    """Make a command from its mapping in a scenario file, or raise ScenarioError.

    Parameters
    ----------
    tree
        As in the file; ``wheel_traction``, the force of each driven wheel [N], may stand for their sum, traction.
    driven_wheels
        How many wheels drive.
    """
    entries = read_mapping(tree)
    at = read_number('at', entries.pop('at', None), low=0.0)
    stop = entries.pop('emergency_stop', None)
    if stop is not None and not isinstance(stop, bool):
        raise ScenarioError(f'emergency_stop: {stop!r} must be true or false')
    return replace(_read_form(entries, at, driven_wheels), emergency_stop=stop)


def _read_form(entries: dict[str, Any], at: float, driven_wheels: int) -> Command:
    form = frozenset(entries)
    if form not in _FORMS:
        raise ScenarioError(f'{", ".join(entries) or "nothing"} beside at; allowed: {_FORMS_TEXT}')
    if 'silent' in entries:
        if entries['silent'] is not True:
            raise ScenarioError(f'silent: {entries["silent"]!r} must be true')
        return Command(at)
    if 'cmd_vel' in entries:
        return Command(at, cmd_vel=_read_twist('cmd_vel', entries))
    if 'teleop' in entries:
        return Command(at, teleop=_read_twist('teleop', entries))
    if 'wheel_traction' in entries:
        entries['traction'] = driven_wheels * read_number('wheel_traction', entries['wheel_traction'])
    return Command(
        at,
        icr=_read_icr(entries['icr']),
        speed=_read_optional('speed', entries),
        traction=_read_optional('traction', entries),
        yaw_moment=_read_optional('yaw_moment', entries) or 0.0,
    )


def _read_twist(name: str, entries: Mapping[str, Any]) -> tuple[float, float, float]:
    vx, vy, yaw_rate = read_numbers(name, entries[name], 3)
    return vx, vy, yaw_rate


def _read_optional(name: str, entries: Mapping[str, Any]) -> float | None:
    return read_number(name, entries[name]) if name in entries else None


def _read_icr(value: Any) -> tuple[float, float] | str:
    if isinstance(value, str):
        if value != STRAIGHT:
            raise ScenarioError(f'icr: {value!r} must be [x, y] or straight')
        return STRAIGHT
    x, y = read_numbers('icr', value, 2)
    if math.hypot(x, y) < MINIMUM_ICR_DISTANCE:
        raise ScenarioError(
            f'icr: [{x:g}, {y:g}] is nearer than {MINIMUM_ICR_DISTANCE:g} m to the centre of gravity, where a speed '
            'says nothing about the turn; move it out, or command a spin in place with cmd_vel'
        )
    return x, y


def follow_command(command: Command, before: Sequence[Command]) -> None:
    """Check that a command is later than the one before it, or raise ScenarioError."""
    if before and command.at <= before[-1].at:
        raise ScenarioError(f'at: {command.at:g} s must be later than the entry before, {before[-1].at:g} s')
