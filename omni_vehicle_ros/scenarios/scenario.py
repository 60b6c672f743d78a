"""A scenario: commands, environment and vehicle of one run, read from a YAML file.

A file is a mapping with the keys of `Scenario`; only ``duration`` must be there. ``values`` names what
``--set name=value`` overrides: wherever the word ``$name`` stands alone, that value is meant, and where
``-$name`` does, its opposite. ``vary`` says which values of which names a study of the scenario goes through; a
plain run knows nothing of it.
"""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache, partial
from typing import Any, TypeVar, cast

from omni_vehicle_ros.errors import ParameterError, ScenarioError
from omni_vehicle_ros.interface import NODES, SIDE_SLIP_CONTROLLER
from omni_vehicle_ros.parameters import (
    Parameters,
    PlantParameters,
    SideSlipParameters,
    SteeringParameters,
    VehicleParameters,
    WheelModuleParameters,
    did_you_mean,
)
from omni_vehicle_ros.scenarios import yaml_text
from omni_vehicle_ros.scenarios.commands import Command, follow_command, read_command
from omni_vehicle_ros.scenarios.environment import (
    EnvironmentChange,
    EnvironmentProfile,
    follow_environment,
    read_environment,
)
from omni_vehicle_ros.scenarios.faults import FaultEvent, check_carriers, follow_fault, read_fault
from omni_vehicle_ros.scenarios.reading import read_mapping, read_number, read_timeline
from omni_vehicle_ros.scenarios.settings import PLAIN, SECTIONS, Setting, apply_setting, fill_in

_KEYS = ('name', 'description', 'values', 'vary', *PLAIN, *SECTIONS, 'commands', 'environment', 'faults')
_LONGEST = 1e5

P = TypeVar('P', bound=Parameters)


@dataclass(frozen=True)
class Scenario:
    """What one run is.

    Attributes
    ----------
    name
        Its name: that of its file, with the folder below ``config/scenarios``, such as ``thesis/bank``.
    description
        What it shows: its first line says it in short.
    duration
        Length [s], a whole number of control cycles.
    side_slip_control
        Whether the side-slip controller is in the loop.
    command_period
        How often the driver repeats its command [s].
    vehicle, steering, wheel_module, side_slip, plant
        The parameters of the run.
    commands, environment, faults
        What happens, in the order of time.
    values
        What ``--set`` can override by a plain name, as it was in this run.
    vary
        Names that ``--set`` takes, with the values of each that `variants` goes through.
    """

    name: str
    duration: float
    description: str = ''
    side_slip_control: bool = False
    command_period: float = 0.02
    vehicle: VehicleParameters = field(default_factory=VehicleParameters)
    steering: SteeringParameters = field(default_factory=SteeringParameters)
    wheel_module: WheelModuleParameters = field(default_factory=WheelModuleParameters)
    side_slip: SideSlipParameters = field(default_factory=SideSlipParameters)
    plant: PlantParameters = field(default_factory=PlantParameters)
    commands: tuple[Command, ...] = ()
    environment: tuple[EnvironmentChange | EnvironmentProfile, ...] = ()
    faults: tuple[FaultEvent, ...] = ()
    values: Mapping[str, Any] = field(default_factory=dict)
    vary: Mapping[str, tuple[Any, ...]] = field(default_factory=dict)

    @property
    def summary(self) -> str:
        """First line of the description."""
        return self.description.partition('\n')[0]

    @property
    def cycles(self) -> int:
        """Number of control cycles from the start to the end."""
        return whole_cycles(self.duration, self.plant.control_period)

    def to_mapping(self) -> dict[str, Any]:
        """Return the mapping of a file that stands for exactly this run: every parameter, no ``$name``, no vary."""
        tree: dict[str, Any] = {
            'name': self.name,
            'description': self.description,
            'values': dict(self.values),
            'duration': self.duration,
            'side_slip_control': self.side_slip_control,
            'command_period': self.command_period,
        }
        for section in SECTIONS:
            entries = getattr(self, section).as_dict().items()
            tree[section] = {name: list(value) if isinstance(value, tuple) else value for name, value in entries}
        tree['commands'] = [command.to_mapping() for command in self.commands]
        tree['environment'] = [change.to_mapping() for change in self.environment]
        tree['faults'] = [event.to_mapping() for event in self.faults]
        return tree

    def as_yaml(self) -> str:
        """Return `to_mapping` as the text of a scenario file; `load_scenario` reads it back equal but for vary."""
        return yaml_text.dump(self.to_mapping())


def whole_cycles(time: float, period: float) -> int:
    """Return the number of control cycles that hold ``time``; 1e-6 of a cycle more is not one more."""
    return math.ceil(time / period - 1e-6)


def make_scenario(name: str, tree: Any, settings: Sequence[Setting] = ()) -> Scenario:
    """Make a scenario from the mapping of its file, with other settings than those that it has; ``vary`` stays empty.

    Raises
    ------
    ScenarioError
        One line: the place in the mapping, what is wrong, and what is allowed.
    """
    entries = read_mapping(tree)
    for key in entries:
        if key not in _KEYS:
            raise ScenarioError(f'unknown key {key!r}{did_you_mean(key, _KEYS)}')
    name = _read_text('name', entries.pop('name', name))
    description = _read_text('description', entries.pop('description', ''))
    entries, values = _settled(entries, settings)
    plant = _make(PlantParameters, 'plant', entries)
    period = plant.control_period
    duration = read_number('duration', entries.get('duration'), low=period, high=_LONGEST)
    duration = whole_cycles(duration, period) * period
    steering = _make(SteeringParameters, 'steering', entries)
    command = partial(read_command, driven_wheels=sum(share > 0.0 for share in steering.drive_shares))
    side_slip_control = _read_flag('side_slip_control', entries.get('side_slip_control', False))
    faults = read_timeline('faults', entries.get('faults', []), read_fault, follow_fault)
    check_carriers(faults, [node for node in NODES if node != SIDE_SLIP_CONTROLLER or side_slip_control])
    return Scenario(
        name=name,
        duration=duration,
        description=description,
        side_slip_control=side_slip_control,
        command_period=read_number('command_period', entries.get('command_period', 0.02), low=period, high=_LONGEST),
        vehicle=_make(VehicleParameters, 'vehicle', entries),
        steering=steering,
        wheel_module=_make(WheelModuleParameters, 'wheel_module', entries),
        side_slip=_make(SideSlipParameters, 'side_slip', entries),
        plant=plant,
        commands=read_timeline('commands', entries.get('commands', []), command, follow_command),
        environment=read_timeline('environment', entries.get('environment', []), read_environment, follow_environment),
        faults=faults,
        values=values,
    )


def _settled(entries: dict[str, Any], settings: Sequence[Setting]) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return what a file says with the settings and values in their places, and these values."""
    values = _read_section(entries.get('values', {}), 'values')
    entries = {key: entry for key, entry in entries.items() if key not in ('values', 'vary')}
    for section in SECTIONS:
        entries[section] = _read_section(entries.get(section, {}), section)
    for setting in settings:
        apply_setting(setting, entries, values)
    return fill_in(entries, values), values


def _read_section(tree: Any, section: str) -> dict[str, Any]:
    try:
        return read_mapping(tree)
    except ScenarioError as error:
        raise ScenarioError(f'{section}: {error}') from None


def _make(kind: type[P], section: str, entries: Mapping[str, Any]) -> P:
    try:
        return cast(P, _made(kind, json.dumps(entries[section])))  # type: ignore[arg-type]  # a class has a hash
    except ParameterError as error:
        raise ScenarioError(f'{section}: {error}') from None


@lru_cache(maxsize=64)
def _made(kind: type[Parameters], values: str) -> Parameters:
    """Make parameters of JSON: in a study most of them are those of the scenario before."""
    return kind.from_mapping(json.loads(values))


def _read_text(key: str, value: Any) -> str:
    if not isinstance(value, str):
        raise ScenarioError(f'{key}: {value!r} must be a text')
    return value


def _read_flag(key: str, value: Any) -> bool:
    if not isinstance(value, bool):
        raise ScenarioError(f'{key}: {value!r} must be true or false')
    return value
