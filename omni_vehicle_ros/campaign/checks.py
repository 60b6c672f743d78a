"""What no fault may do to the recording of a drive, and whether the vehicle has found the fault."""

import math
from collections.abc import Iterable, Iterator

import numpy as np

from omni_vehicle_ros.analysis.troubles import Trouble
from omni_vehicle_ros.bags import Bag, RecordedMessage
from omni_vehicle_ros.bags.columns.columns import Array
from omni_vehicle_ros.faults import CLOCK, MESSAGES
from omni_vehicle_ros.interface import DRIVER
from omni_vehicle_ros.messages import decode
from omni_vehicle_ros.scenarios import FaultEvent, Scenario
from omni_vehicle_ros.wheels import WHEELS

ROUNDING = 1e-6
"""Share of a limit that sums of steps may be beyond it."""

SILENCE = 'command timeout'
"""What ICR steering says of a driver that it hears no more."""

PUBLISHERS = ': inputs'
"""End of the name under which a node says who else publishes what belongs to another."""


def numbers(value: object) -> Iterator[float]:
    """Yield every number in the value of a message."""
    if isinstance(value, float):
        yield value
    elif isinstance(value, tuple):
        for entry in value:
            yield from numbers(entry)


def not_finite(messages: Iterable[RecordedMessage]) -> list[str]:
    """Return a line for each topic on which there is a number that is not finite."""
    found = {
        message.topic: None
        for message in messages
        if not all(map(math.isfinite, numbers(decode(message.type_name, message.data))))
    }
    return [f'{topic} has a number that is not finite' for topic in found]


def true_columns(bag: Bag, sensor: str, *names: str) -> tuple[Array, list[Array]]:
    """Return stamps [ns] and columns of what a sensor should have said, whether it was ok or not.

    Parameters
    ----------
    bag
        Of a drive.
    sensor
        One with a topic ``<sensor>/truth``.
    names
        Of the columns.
    """
    said = bag[sensor]
    stamps, columns = said.stamp_ns, [np.array(getattr(said, name)) for name in names]
    topic = f'{sensor}/truth'
    if topic in bag and len(bag[topic]):
        truth = bag[topic]
        rows = np.isin(stamps, truth.stamp_ns)
        meant = np.searchsorted(truth.stamp_ns, stamps[rows])
        for column, name in zip(columns, names, strict=True):
            column[rows] = getattr(truth, name)[meant]
    return stamps, columns


def steering_excess(bag: Bag, scenario: Scenario) -> list[str]:
    """Return a line for each limit that a steer angle has passed.

    Where the clock has jumped two cycles have no rate: the time between them is not that of the stamps.
    """
    limits, period = scenario.wheel_module, scenario.plant.control_period
    stamps, (angles,) = true_columns(bag, 'joint_states', 'position')
    angles, found = angles[:, :4], []
    if not np.abs(angles).max() <= limits.steer_limit * (1 + ROUNDING):
        found.append(f'steer angle {np.abs(angles).max():.4f} rad is beyond steer_limit, {limits.steer_limit:g} rad')
    if any(event.fault.component == CLOCK and event.fault.value < 0.0 for event in scenario.faults):
        return found  # the same stamps came twice
    neighbours = np.diff(stamps) == round(period * 1e9)
    rate = np.abs(np.diff(angles, axis=0)[neighbours]).max(initial=0.0) / period
    if not rate <= limits.steer_rate_limit * (1 + ROUNDING):
        found.append(f'steer rate {rate:.4f} rad/s is beyond steer_rate_limit, {limits.steer_rate_limit:g} rad/s')
    return found


def incomplete(bag: Bag, scenario: Scenario) -> list[str]:
    """Return a line for each thing that a bag lacks at its end."""
    found = list(bag.damage)
    for topic in ('joint_states', 'odom'):  # the plant's, which no fault ends
        last = float(bag[topic].stamp[-1])
        if last < scenario.duration - ROUNDING:
            found.append(f'{topic} ends at {last:g} s of {scenario.duration:g} s')
    return found


def marks(component: str) -> tuple[str, ...]:
    """Return words of which a diagnostic that names a component has one, with spaces in place of underscores.

    The wheel, for what belongs to a wheel; else the topic or the node. A driver that is not heard is a command
    that is old.
    """
    topic = component.removeprefix(MESSAGES)
    words: list[str] = [wheel for wheel in WHEELS if topic.startswith(f'{wheel}/')]
    words = words or [topic, topic.rpartition('/')[2]]
    if component == CLOCK:
        words.append('stamp')
    if component == DRIVER or topic.startswith(f'{DRIVER}/'):
        words.append(SILENCE)
    return tuple(dict.fromkeys(word.replace('_', ' ') for word in words))


def begin_of(event: FaultEvent, events: Iterable[FaultEvent]) -> float:
    """Return the least stamp of what comes after a fault [s]: earlier than its own if the clock then goes back.

    Parameters
    ----------
    event
        The fault.
    events
        All faults of the drive.
    """
    jumps = [e.at + e.fault.value for e in events if e.fault.component == CLOCK and e.at >= event.at]
    return min(event.at, *jumps) if jumps else event.at


def named_after(event: FaultEvent, events: Iterable[FaultEvent], troubles: Iterable[Trouble]) -> float | None:
    """Return after what time a diagnostic names a faulty component [s]; None if none does.

    Parameters
    ----------
    event
        The fault.
    events
        All faults of the drive.
    troubles
        The diagnostics above OK, each when it was said first: what was said before the fault doesn't count, nor
        who else publishes a topic. A node that belongs to a wheel names the wheel when it complains.
    """
    words, begin = marks(event.fault.component), begin_of(event, events)
    for trouble in troubles:
        if trouble.node.endswith(PUBLISHERS):
            continue
        owner = trouble.node if any(f'/{wheel}/' in trouble.node for wheel in WHEELS) else ''
        text = f'{owner} {trouble.message}'.replace('_', ' ')
        if trouble.time >= begin - ROUNDING and any(word in text for word in words):
            return trouble.time - begin
    return None
