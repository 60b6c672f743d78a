"""The vocabulary of faults: what can happen to which component, in the words of PX4's failure injection.

A fault happens to a component and has a failure and, with most of them, a value. `KINDS` says once which failures a
component knows; scenarios, the topic ``faults``, the parameters ``fault.*`` and ``docs/faults.md`` are made from it.
"""

import math
from collections.abc import Iterable, Mapping
from typing import NamedTuple

from omni_vehicle_ros.errors import FaultError
from omni_vehicle_ros.interface import (
    DRIVER,
    ICR_STEERING,
    PLANT,
    RECORDER,
    SIDE_SLIP_CONTROLLER,
    TOPICS,
    WHEEL_MODULES,
)
from omni_vehicle_ros.messages import Diagnostics, Status
from omni_vehicle_ros.parameters import did_you_mean
from omni_vehicle_ros.wheels import WHEELS

OK = 'ok'
"""The failure of a component that has none."""


class Failure(NamedTuple):
    """One way to fail.

    Attributes
    ----------
    text
        What happens then.
    default
        Value where none is given; None if this failure takes no value.
    unit
        Of the value.
    low, high
        Limits of the value, both allowed.
    """

    text: str
    default: float | None = None
    unit: str = ''
    low: float = 0.0
    high: float = 0.0


class Fault(NamedTuple):
    """What happens to a component; made by `make_fault`, which checks it.

    Attributes
    ----------
    component
        One of `COMPONENTS`.
    failure
        `OK`, or one that the component knows.
    value
        What it means is up to the failure; 0 where it means nothing.
    """

    component: str
    failure: str = OK
    value: float = 0.0

    @property
    def words(self) -> str:
        """Failure and value as `parse_fault` reads them."""
        return f'{self.failure} {self.value:g}' if takes_value(self) else self.failure


_PERIOD = 0.5, 's', 0.02, 60.0
_LATER = 's', 0.0, 5.0

_SENSOR = {
    'off': Failure(
        'its messages come with a stamp and without numbers: arrays are empty; odom and imu have zeros and no frame'
    ),
    'stuck': Failure('repeats its last numbers with new stamps'),
    'garbage': Failure('each number is random within +-value, in the unit of the number', 10.0, '', 0.0, 1e6),
    'wrong': Failure('each number is multiplied by value', 1.2, '', -10.0, 10.0),
    'delayed': Failure('says with a new stamp what it saw so long ago', 0.1, *_LATER),
    'intermittent': Failure('off and ok in turns, with this period', *_PERIOD),
}

KINDS: Mapping[str, Mapping[str, Failure]] = {
    'steering': {
        'off': Failure(
            'free-castering: the motor gives no torque; the wheel swings towards the direction of its own motion, '
            'over a trail of this length',
            0.1, 'm', 0.01, 1.0,
        ),
        'stuck': Failure('the angle is held'),
        'garbage': Failure('random set-points within +-value, a new one every 0.1 s', 0.5, 'rad', 0.0, 3.1415),
        'wrong': Failure(
            'goes to an angle that is more by value than its set-point; joint_states has the true one',
            0.1, 'rad', -1.0, 1.0,
        ),
        'slow': Failure('the rate limit is multiplied by value', 0.1, '', 0.001, 1.0),
        'delayed': Failure('so much more dead time', 0.2, *_LATER),
        'intermittent': Failure('stuck and ok in turns, with this period', *_PERIOD),
    },
    'drive': {
        'off': Failure('no torque'),
        'stuck': Failure('the torque is held'),
        'garbage': Failure('random set-points within +-value, a new one every 0.1 s', 300.0, 'N m', 0.0, 1e5),
        'wrong': Failure('the torque is multiplied by value, within its limit', 0.5, '', -2.0, 2.0),
        'slow': Failure('the time constant is divided by value', 0.1, '', 0.001, 1.0),
        'intermittent': Failure('off and ok in turns, with this period', *_PERIOD),
    },
    'brake': {
        'stuck': Failure('the wheel is locked: it does not turn, and slides as far as friction and load hold it'),
    },
    'process': {
        'off': Failure('killed (SIGKILL) in the cycle in which it hears of it'),
        'stuck': Failure('frozen (SIGSTOP) in the cycle in which it hears of it'),
        'delayed': Failure('answers so much later in wall time', 0.02, 's', 0.0, 1.0),
    },
    'sensor': _SENSOR,
    'messages': {
        'off': Failure('all are lost'),
        'garbage': Failure('each number is NaN'),
        'delayed': Failure('each comes so much later', 0.05, *_LATER),
        'intermittent': Failure('this share of them is lost, at random', 0.2, '', 0.0, 1.0),
        'duplicated': Failure('each comes twice'),
        'reordered': Failure('each second one overtakes the one before it'),
    },
    'clock': {
        'wrong': Failure('the stamps jump once by value, in whole control cycles', 0.5, 's', -0.9, 0.9),
    },
}
"""What each kind of component can do wrong, besides being ok."""

SENSORS = ('joint_states', 'odom', 'imu', 'tyres/side_slip')

CLOCK = 'clock'

PROCESSES: Mapping[str, str] = {
    **{f'{wheel}/module': module for wheel, module in zip(WHEELS, WHEEL_MODULES, strict=True)},
    ICR_STEERING: ICR_STEERING,
    SIDE_SLIP_CONTROLLER: SIDE_SLIP_CONTROLLER,
    DRIVER: DRIVER,
}
"""The node of each component that is a process."""

FAULTS = 'faults'
"""The topic that faults are injected on."""

MESSAGES = 'messages/'
"""Before the name of a topic: its messages, as they come to those who act on them."""

_LOCKSTEP = ('driver/step', 'recorder/step', 'ready', FAULTS)


def _receivers() -> dict[str, tuple[str, ...]]:
    """Return the nodes that act on the messages of each topic."""
    rows = (row for row in TOPICS if row.name not in _LOCKSTEP)
    found = {row.name: tuple(node for node in row.subscribers if node != RECORDER) for row in rows}
    return {name: nodes for name, nodes in found.items() if nodes}


def _carriers() -> dict[str, tuple[str, ...]]:
    found: dict[str, tuple[str, ...]] = {}
    for wheel, module in zip(WHEELS, WHEEL_MODULES, strict=True):
        found.update((f'{wheel}/{part}', (module,)) for part in ('steering', 'drive', 'brake'))
    found.update((component, (node,)) for component, node in PROCESSES.items())
    found.update((sensor, (PLANT,)) for sensor in (*SENSORS, CLOCK))
    found.update((f'{MESSAGES}{name}', nodes) for name, nodes in _receivers().items())
    return found


CARRIERS: Mapping[str, tuple[str, ...]] = _carriers()
"""The nodes with a parameter ``fault.*`` for each component: those to which it belongs."""

COMPONENTS = tuple(CARRIERS)


def kind_of(component: str) -> str:
    """Return which of `KINDS` a component is of.

    Raises
    ------
    FaultError
        There is no such component.
    """
    if component not in CARRIERS:
        raise FaultError(f'unknown component {component!r}{did_you_mean(component, COMPONENTS)}')
    if component in PROCESSES:
        return 'process'
    if component in SENSORS:
        return 'sensor'
    if component.startswith(MESSAGES):
        return 'messages'
    return component.rpartition('/')[2]


def takes_value(fault: Fault) -> bool:
    """Whether the value of a fault means something."""
    return fault.failure != OK and KINDS[kind_of(fault.component)][fault.failure].default is not None


def make_fault(component: str, failure: str, value: float | None = None) -> Fault:
    """Return a fault; without ``value`` with the default of its failure.

    Raises
    ------
    FaultError
        One line: what is unknown or outside its limits, and what is allowed.
    """
    known = KINDS[kind_of(component)]
    if failure == OK:
        return Fault(component)
    if failure not in known:
        raise FaultError(f'{component}: unknown failure {failure!r}{did_you_mean(failure, (OK, *known))}')
    _, default, unit, low, high = known[failure]
    if default is None:
        if value is not None:
            raise FaultError(f'{component}: {failure} takes no value, but {value:g} is given; leave it out')
        return Fault(component, failure)
    value = default if value is None else float(value)
    if not low <= value <= high:
        raise FaultError(f'{component}: {failure}: {value:g} is outside {low:g} .. {high:g} {unit}'.rstrip())
    return Fault(component, failure, value)


def parse_fault(component: str, text: str) -> Fault:
    """Read a failure and its value in words, such as ``slow 0.3``; nothing at all means `OK`.

    Raises
    ------
    FaultError
        As in `make_fault`; also what is no failure and number.
    """
    failure, *rest = text.split() or [OK]
    if len(rest) > 1:
        raise FaultError(f'{component}: {text!r} must be a failure and at most one value, such as stuck or slow 0.3')
    return make_fault(component, failure, _number(component, rest[0]) if rest else None)


def _number(component: str, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise FaultError(f'{component}: value {text!r} must be a finite number')
    return value


def faults_message(stamp: int, faults: Iterable[Fault]) -> Diagnostics:
    """Return the message for the topic ``faults``."""
    statuses = []
    for component, failure, value in faults:
        values = (('value', repr(value)),) if takes_value(Fault(component, failure)) else ()
        statuses.append(Status(0 if failure == OK else 2, component, failure, values))
    return Diagnostics(stamp, tuple(statuses))


def read_faults(message: Diagnostics) -> tuple[list[Fault], list[str]]:
    """Return the faults of a message of the topic ``faults``, and in words what in it is none."""
    faults, refused = [], []
    for status in message.statuses:
        value = dict(status.values).get('value')
        try:
            number = None if value is None else _number(status.name, value)
            faults.append(make_fault(status.name, status.message, number))
        except FaultError as error:
            refused.append(str(error))
    return faults, refused
