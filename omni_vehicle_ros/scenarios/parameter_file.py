"""ROS parameter files from the parameter classes.

``python -m omni_vehicle_ros.scenarios.parameter_file > config/vehicle.yaml`` writes the defaults.
"""

import dataclasses
import textwrap
from collections.abc import Iterator
from itertools import chain
from typing import Any

from omni_vehicle_ros.parameters import (
    PacingParameters,
    Parameters,
    PlantParameters,
    RecorderParameters,
    SideSlipParameters,
    SteeringParameters,
    VehicleParameters,
    WheelModuleParameters,
)

_WIDTH = 110
_SHARED = (
    'control_period', 'ideal_actuators', 'steer_delay', 'steer_time_constant', 'steer_rate_limit', 'steer_limit',
    'drive_time_constant', 'drive_torque_limit', 'module_timeout', 'trim_limit',
)


def parameter_file(
    *,
    vehicle: VehicleParameters,
    steering: SteeringParameters,
    wheel_module: WheelModuleParameters,
    side_slip: SideSlipParameters,
    plant: PlantParameters,
    pacing: PacingParameters,
    recorder: RecorderParameters | None = None,
) -> str:
    """Return the text of a ROS parameter file for all nodes of a vehicle, in any namespace.

    What several nodes declare stands under ``/**``, the rest under the node that declares it. Every
    parameter has a comment with its meaning, its unit and what is allowed. Without ``recorder`` it has no
    section.
    """
    sections: tuple[tuple[str, str, Iterator[str]], ...] = (
        (
            '/**', 'All nodes: the vehicle, and how the nodes keep step.',
            chain(
                _entries(vehicle), _entries(pacing), _entries(plant, only=_SHARED),
                _entries(wheel_module, only=_SHARED), _entries(side_slip, only=_SHARED),
            ),
        ),
        ('/**/plant', 'The simulated vehicle on its road.', _entries(plant, without=_SHARED)),
        ('/**/icr_steering', 'What a driver may ask for, and how it becomes set-points.', _entries(steering)),
        ('/**/wheel_module', 'Each of the four wheel modules.', _entries(wheel_module, without=_SHARED)),
        (
            '/**/side_slip_controller', 'Gains: front left, front right, rear left, rear right.',
            _entries(side_slip, without=_SHARED),
        ),
        *([('/**/recorder', 'What is recorded, and into what files.', _entries(recorder))] if recorder else ()),
    )
    blocks = ([f'# {text}', f'{node}:', '  ros__parameters:', *entries, ''] for node, text, entries in sections)
    return '\n'.join(chain.from_iterable(blocks))


def _entries(source: Parameters, *, only: tuple[str, ...] = (), without: tuple[str, ...] = ()) -> Iterator[str]:
    for entry in dataclasses.fields(source):  # type: ignore[arg-type]
        if entry.name in without or (only and entry.name not in only):
            continue
        yield from _wrap(_comment(entry), '    # ', '    # ')
        yield from _wrap(f'{entry.name}: {_plain(getattr(source, entry.name))}', '    ', '      ')


def _wrap(text: str, first: str, rest: str) -> list[str]:
    return textwrap.wrap(text, _WIDTH, initial_indent=first, subsequent_indent=rest, break_on_hyphens=False)


def _comment(entry: 'dataclasses.Field[Any]') -> str:
    facts = entry.metadata
    if facts['choices']:
        return f'{facts["text"]} {" or ".join(facts["choices"])}.'
    unit = f' [{facts["unit"]}]' if facts['unit'] else ''
    if facts['low'] is None or facts['high'] is None:
        return f'{facts["text"]}{unit}'
    return f'{facts["text"]} {facts["low"]:g} .. {facts["high"]:g}{unit}'


def _plain(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, tuple):
        return f'[{", ".join(map(_plain, value))}]'
    return (value or "''") if isinstance(value, str) else repr(value)


def default_parameter_file() -> str:
    """Return `parameter_file` with the default of every parameter: the text of ``config/vehicle.yaml``."""
    return parameter_file(
        vehicle=VehicleParameters(),
        steering=SteeringParameters(),
        wheel_module=WheelModuleParameters(),
        side_slip=SideSlipParameters(),
        plant=PlantParameters(),
        pacing=PacingParameters(),
        recorder=RecorderParameters(),
    )


if __name__ == '__main__':
    print(default_parameter_file(), end='')
