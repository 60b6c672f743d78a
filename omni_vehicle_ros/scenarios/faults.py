"""The faults of a scenario over time."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Any

from omni_vehicle_ros.errors import FaultError, ScenarioError
from omni_vehicle_ros.faults import CARRIERS, PROCESSES, Fault, make_fault, takes_value
from omni_vehicle_ros.parameters import did_you_mean
from omni_vehicle_ros.scenarios.reading import read_mapping, read_number

_ROUNDING = 1e-9
"""Of sums of times [s]."""

_KEYS = ('at', 'component', 'failure', 'value', 'for')


@dataclass(frozen=True)
class FaultEvent:
    """A fault from a time on, and for a while or to the end.

    Attributes
    ----------
    at
        When it begins [s].
    fault
        What happens.
    lasting
        After what time the component is ok again [s]; None: it stays.
    """

    at: float
    fault: Fault
    lasting: float | None = None

    @property
    def end(self) -> float:
        """When it is over [s]; infinite if it stays."""
        return float('inf') if self.lasting is None else self.at + self.lasting

    def to_mapping(self) -> dict[str, Any]:
        """Return the mapping that stands for it in a scenario file."""
        component, failure, value = self.fault
        tree: dict[str, Any] = {'at': self.at, 'component': component, 'failure': failure}
        if takes_value(self.fault):
            tree['value'] = value
        return tree if self.lasting is None else {**tree, 'for': self.lasting}


def read_fault(tree: Any) -> FaultEvent:
    """Make a fault from its mapping in a scenario file, or raise ScenarioError."""
    entries = read_mapping(tree)
    for key in entries:
        if key not in _KEYS:
            raise ScenarioError(f'unknown key {key!r}{did_you_mean(key, _KEYS)}')
    at = read_number('at', entries.get('at'), low=0.0)
    component, failure = (_read_word(key, entries) for key in ('component', 'failure'))
    value = read_number('value', entries['value']) if 'value' in entries else None
    lasting = read_number('for', entries['for'], low=0.0) if 'for' in entries else None
    try:
        fault = make_fault(component, failure, value)
    except FaultError as error:
        raise ScenarioError(str(error)) from None
    if lasting is not None and component in PROCESSES and failure in ('off', 'stuck'):
        raise ScenarioError(f'for: {lasting:g} s; a process that is killed or frozen does not come back: leave it out')
    return FaultEvent(at, fault, lasting)


def _read_word(key: str, entries: dict[str, Any]) -> str:
    word = entries.get(key)
    if not isinstance(word, str):
        raise ScenarioError(f'{key}: {word!r} must be a word')
    return word


def follow_fault(event: FaultEvent, before: Sequence[FaultEvent]) -> None:
    """Check that a fault is not earlier than the one before it and meets no other, or raise ScenarioError."""
    if before and event.at < before[-1].at:
        raise ScenarioError(f'at: {event.at:g} s must not be earlier than the entry before, {before[-1].at:g} s')
    for other in before:
        if other.fault.component == event.fault.component and event.at + _ROUNDING < other.end < float('inf'):
            raise ScenarioError(
                f'at: {event.at:g} s; {event.fault.component} is {other.fault.failure} until {other.end:g} s'
            )


def check_carriers(events: Sequence[FaultEvent], nodes: Collection[str]) -> None:
    """Check that some of ``nodes``, those of a run, have to do with each fault, or raise ScenarioError."""
    for number, event in enumerate(events):
        if not {*CARRIERS[event.fault.component]} & {*nodes}:
            raise ScenarioError(
                f'faults[{number}]: {event.fault.component} has no effect without side_slip_control; set it to true'
            )
