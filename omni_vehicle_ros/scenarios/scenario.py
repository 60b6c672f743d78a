"""A scenario: commands, environment and vehicle of one run, read from a YAML file.

A file is a mapping with the keys of `Scenario`; only ``duration`` must be there. ``values`` names what
``--set name=value`` overrides: wherever the word ``$name`` stands alone, that value is meant.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeVar

from omni_vehicle_ros.errors import ParameterError, ScenarioError
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
from omni_vehicle_ros.scenarios.commands import (
    Command,
    EnvironmentChange,
    read_change,
    read_command,
    read_mapping,
    read_number,
    read_timeline,
)
from omni_vehicle_ros.scenarios.library import find_scenario

SECTIONS = ('vehicle', 'steering', 'wheel_module', 'side_slip', 'plant')
_PLAIN = ('duration', 'side_slip_control', 'command_period')
_KEYS = ('name', 'description', 'values', *_PLAIN, *SECTIONS, 'commands', 'environment')
_LONGEST = 1e5

P = TypeVar('P', bound=Parameters)


@dataclass(frozen=True)
class Scenario:
    """What one run is.

    Attributes
    ----------
    name
        Its name: that of its file.
    description
        What it shows.
    duration
        Length [s], a whole number of control cycles.
    side_slip_control
        Whether the side-slip controller is in the loop.
    command_period
        How often the driver repeats its command [s].
    vehicle, steering, wheel_module, side_slip, plant
        The parameters of the run.
    commands, environment
        What happens, in the order of time.
    values
        What ``--set`` can override by a plain name, as it was in this run.
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
    environment: tuple[EnvironmentChange, ...] = ()
    values: Mapping[str, Any] = field(default_factory=dict)

    @property
    def cycles(self) -> int:
        """Number of control cycles from the start to the end."""
        return whole_cycles(self.duration, self.plant.control_period)

    def to_mapping(self) -> dict[str, Any]:
        """Return the mapping of a scenario file that stands for exactly this run: every parameter, no ``$name``."""
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
        return tree

    def as_yaml(self) -> str:
        """Return `to_mapping` as the text of a scenario file; `load_scenario` reads it back equal."""
        return yaml_text.dump(self.to_mapping())


def whole_cycles(time: float, period: float) -> int:
    """Return the number of control cycles that hold ``time``; 1e-6 of a cycle more is not one more."""
    return math.ceil(time / period - 1e-6)


def load_scenario(name_or_path: str, overrides: Sequence[str] = ()) -> Scenario:
    """Read a scenario.

    Parameters
    ----------
    name_or_path
        The name of a scenario in ``config/scenarios``, or the path of a YAML file.
    overrides
        ``name=value`` for the names in ``values``, and for duration, side_slip_control and command_period;
        ``section.name=value`` for parameters, such as ``vehicle.mass=1400``. A value is a YAML scalar or list.
        Of two for the same name the later holds.

    Returns
    -------
    Scenario
        Checked, with a duration of whole control cycles (rounded up).

    Raises
    ------
    ScenarioError
        One line: the file, the place in it, what is wrong, and what is allowed.
    """
    path = find_scenario(name_or_path)
    try:
        text = path.read_bytes()
    except OSError as error:
        raise ScenarioError(f'{path}: {error.strerror}') from None
    try:
        return build_scenario(path.stem, yaml_text.parse(text), overrides)
    except ScenarioError as error:
        settings = f' with {" ".join(overrides)}' if overrides else ''
        raise ScenarioError(f'{path}{settings}: {error}') from None


def build_scenario(name: str, tree: Any, overrides: Sequence[str] = ()) -> Scenario:
    """Make a scenario from the mapping that its file holds; see `load_scenario`."""
    entries = read_mapping(tree)
    for key in entries:
        if key not in _KEYS:
            raise ScenarioError(f'unknown key {key!r}{did_you_mean(key, _KEYS)}')
    name = _read_text('name', entries.pop('name', name))
    description = _read_text('description', entries.pop('description', ''))
    values = _read_section(entries.pop('values', {}), 'values')
    for section in SECTIONS:
        entries[section] = _read_section(entries.get(section, {}), section)
    for override in overrides:
        _apply(override, entries, values)
    entries = _fill_in(entries, values)
    plant = _make(PlantParameters, 'plant', entries)
    period = plant.control_period
    duration = read_number('duration', entries.get('duration'), low=period, high=_LONGEST)
    duration = whole_cycles(duration, period) * period
    return Scenario(
        name=name,
        duration=duration,
        description=description,
        side_slip_control=_read_flag('side_slip_control', entries.get('side_slip_control', False)),
        command_period=read_number('command_period', entries.get('command_period', 0.02), low=period, high=_LONGEST),
        vehicle=_make(VehicleParameters, 'vehicle', entries),
        steering=_make(SteeringParameters, 'steering', entries),
        wheel_module=_make(WheelModuleParameters, 'wheel_module', entries),
        side_slip=_make(SideSlipParameters, 'side_slip', entries),
        plant=plant,
        commands=read_timeline('commands', entries.get('commands', []), read_command),
        environment=read_timeline('environment', entries.get('environment', []), read_change),
        values=values,
    )


def _read_section(tree: Any, section: str) -> dict[str, Any]:
    try:
        return read_mapping(tree)
    except ScenarioError as error:
        raise ScenarioError(f'{section}: {error}') from None


def _make(kind: type[P], section: str, entries: Mapping[str, Any]) -> P:
    try:
        return kind.from_mapping(entries[section])
    except ParameterError as error:
        raise ScenarioError(f'{section}: {error}') from None


def _read_text(key: str, value: Any) -> str:
    if not isinstance(value, str):
        raise ScenarioError(f'{key}: {value!r} must be a text')
    return value


def _read_flag(key: str, value: Any) -> bool:
    if not isinstance(value, bool):
        raise ScenarioError(f'{key}: {value!r} must be true or false')
    return value


def _apply(override: str, entries: dict[str, Any], values: dict[str, Any]) -> None:
    """Put one ``--set`` where it belongs."""
    key, equals, text = override.partition('=')
    key = key.strip()
    if not equals:
        raise ScenarioError(f'{override!r} must be name=value')
    value = yaml_text.parse(text)
    section, dot, parameter = key.partition('.')
    if dot and section in SECTIONS:
        entries[section][parameter] = value
    elif key in values and _uses(key, entries):
        values[key] = value
    elif key in _PLAIN:
        entries[key] = value
    elif key in values:
        raise ScenarioError(f'{key} has no effect: this file does not say ${key} anywhere')
    else:
        sections = (f'{section}.PARAMETER' for section in SECTIONS)
        raise ScenarioError(f'unknown name {key!r}{did_you_mean(key, dict.fromkeys((*values, *_PLAIN, *sections)))}')


def _uses(name: str, tree: Any) -> bool:
    if isinstance(tree, dict):
        return any(_uses(name, item) for item in tree.values())
    if isinstance(tree, list):
        return any(_uses(name, item) for item in tree)
    return bool(tree == f'${name}')


def _fill_in(tree: Any, values: Mapping[str, Any]) -> Any:
    """Put the values in the place of their ``$name``."""
    if isinstance(tree, dict):
        return {key: _fill_in(item, values) for key, item in tree.items()}
    if isinstance(tree, list):
        return [_fill_in(item, values) for item in tree]
    if not isinstance(tree, str) or not tree.startswith('$'):
        return tree
    if tree[1:] not in values:
        raise ScenarioError(f'{tree} is not among the values{did_you_mean(tree[1:], values)}')
    return values[tree[1:]]
