"""A run in words and rounded numbers, for people to read."""

import dataclasses
import math
from collections.abc import Mapping
from typing import Any

from omni_vehicle_ros.parameters import Parameters
from omni_vehicle_ros.scenarios import Command, EnvironmentChange, EnvironmentProfile, Scenario
from omni_vehicle_ros.scenarios.settings import SECTIONS
from omni_vehicle_ros.wheels import WHEELS

_NONE, _MINUS = '\u2013', '\u2212'


def _number(value: float | None, factor: float = 1.0, digits: int = 2) -> str:
    if value is None:
        return _NONE
    return f'{round(value * factor, digits) + 0.0:.{digits}f}'.replace('-', _MINUS)


def _degrees(value: float | None) -> str:
    return _number(value, math.degrees(1.0))


def facts(scenario: Scenario) -> list[str]:
    """Return what kind of run it was, in a few words each."""
    gains = ', '.join(f'{gain:g}' for gain in scenario.side_slip.proportional_gains)
    return [
        f'{scenario.duration:g} s, a control cycle each {scenario.plant.control_period * 1e3:g} ms',
        'forward speed held constant' if scenario.plant.constant_speed else 'forward speed free',
        'ideal actuators' if scenario.wheel_module.ideal_actuators else 'real actuators',
        f'side-slip control, gains {gains}' if scenario.side_slip_control else 'no side-slip control',
    ]


def figures(metrics: Mapping[str, Any]) -> list[tuple[str, str, str]]:
    """Return the main figures: name, value, unit."""
    speed, path = metrics['speed'], metrics['path']
    use = max((metrics['friction_use'][wheel]['peak'] or 0.0, wheel) for wheel in WHEELS)
    load = min((metrics['load'][wheel]['minimum'] or 0.0, wheel) for wheel in WHEELS)
    x, y, heading = path['final']
    return [
        ('Speed at start', _number(speed['initial']), 'm/s'),
        ('Speed at end', _number(speed['final']), 'm/s'),
        ('Steady yaw rate', _degrees(metrics['yaw_rate']['steady_state']), '°/s'),
        ('Steady path radius', _number(path['radius']), 'm'),
        ('Position at end', f'{_number(x, digits=1)}, {_number(y, digits=1)}', 'm'),
        ('Heading at end', _number(heading, math.degrees(1.0), 0), '°'),
        (f'Largest friction use, {use[1].replace("_", " ")}', _number(use[0]), ''),
        (f'Smallest load, {load[1].replace("_", " ")}', _number(load[0], 1e-3), 'kN'),
    ]


def punctual(real_time: Mapping[str, Any] | None) -> list[tuple[str, list[str]]]:
    """Return when the wheel modules answered in real time: what, and median, 99th percentile and largest [ms]."""
    spreads = [
        (words, real_time.get(name))
        for name, words in (('answer', 'Answer after the tick'), ('jitter', 'Jitter from answer to answer'))
    ] if real_time else []
    return [(words, [_number(time, 1e3, 3) for time in spread.values()]) for words, spread in spreads if spread]


def load(real_time: Mapping[str, Any] | None) -> list[tuple[str, list[str]]]:
    """Return what each process of a run in real time took: node, share of a core [%], memory [MB]."""
    memory = real_time.get('memory', {}) if real_time else {}
    cpu = real_time.get('cpu', {}) if real_time else {}
    return [(role, [_number(cpu.get(role), 100.0, 1), _number(size, 1e-6, 0)]) for role, size in memory.items()]


def rows(metrics: Mapping[str, Any]) -> list[tuple[str, str, list[str]]]:
    """Return the rows of the table: wheel, words for it, cells."""
    rows: list[tuple[str, str, list[str]]] = []
    for wheel in WHEELS:
        slip = metrics['side_slip'][wheel]
        cells = [
            _degrees(slip['steady_state']), _degrees(slip['peak']),
            _number(slip['overshoot'], 100.0, 0), _number(slip['settling_time']),
            _number(metrics['friction_use'][wheel]['peak']), _number(metrics['load'][wheel]['minimum'], 1e-3),
        ]
        rows.append((wheel, wheel.replace('_', ' '), cells))
    return rows


def timeline(scenario: Scenario) -> list[tuple[str, str]]:
    """Return when the driver or the environment does something, and what, in the order of time."""
    straight_radius = scenario.steering.straight_radius
    events = [(command.at, _said(command, straight_radius)) for command in scenario.commands]
    events += [(entry.at, _happened(entry)) for entry in scenario.environment]
    return [(f'{at:g} s', text) for at, text in sorted(events, key=lambda event: event[0])]


def _said(command: Command, straight_radius: float) -> str:
    stop = {None: '', True: 'emergency stop; ', False: 'no emergency stop; '}[command.emergency_stop]
    return stop + _aimed(command, straight_radius)


def _aimed(command: Command, straight_radius: float) -> str:
    if command.twist is not None:
        vx, vy, yaw_rate = command.twist
        return f'twist {vx:g} m/s ahead, {vy:g} m/s to the left, {yaw_rate:g} rad/s'
    if command.icr is None:
        return 'the driver says nothing'
    where = _where(command.icr, straight_radius)
    if command.speed is not None:
        return f'{where}, {command.speed:g} m/s'
    moment = f', yaw moment {command.yaw_moment:g} N m' if command.yaw_moment else ''
    return f'{where}, traction {command.traction:g} N{moment}'


def _where(icr: tuple[float, float] | str, straight_radius: float) -> str:
    if isinstance(icr, str):
        return 'straight on'
    x, y = icr
    if math.hypot(x, y) < straight_radius:
        return f'ICR at ({x:g}, {y:g}) m'
    bearing = math.degrees(math.atan2(-x, y) if y >= 0.0 else math.atan2(x, -y))
    if bearing == 0.0:
        return 'straight on'
    return f'crab {abs(bearing):.0f}° to the {"left" if bearing > 0.0 else "right"}'


def _happened(entry: EnvironmentChange | EnvironmentProfile) -> str:
    if isinstance(entry, EnvironmentChange):
        return _step(entry)
    steps = ((time, _step(entry.change(time)).removeprefix(f'{entry.quantity} ')) for time, _ in entry.points[1:])
    later = (f'{words} at {time:g} s' for time, words in steps)
    return f'{_step(entry.change(entry.at))}, in straight lines to {"; ".join(later)}'


def _step(change: EnvironmentChange) -> str:
    words = []
    if change.bank is not None:
        words.append(f'bank {math.degrees(change.bank):.3g}°')
    if change.wind is not None:
        words.append(f'wind {change.wind:g} m/s')
    if change.friction is not None:
        values = change.friction[:1] if len(set(change.friction)) == 1 else change.friction
        words.append(f'friction {_plain(values)}')
    return ', '.join(words)


def changed(scenario: Scenario) -> list[tuple[str, str, str]]:
    """Return the parameters that differ from their defaults: name, value, unit."""
    changed = []
    for section in SECTIONS:
        parameters: Parameters = getattr(scenario, section)
        for entry in dataclasses.fields(parameters):  # type: ignore[arg-type]
            value = getattr(parameters, entry.name)
            if value != entry.default:
                changed.append((f'{section}.{entry.name}', _plain(value), entry.metadata['unit']))
    return changed


def _plain(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, tuple):
        return ', '.join(map(_plain, value))
    return f'{value:g}' if isinstance(value, float) else str(value)
