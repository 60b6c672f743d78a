"""What all components have in common."""

from typing import NamedTuple, Protocol, runtime_checkable

from omni_vehicle_ros.control.health import Health, Hold
from omni_vehicle_ros.faults import Fault
from omni_vehicle_ros.messages import Diagnostics, Status, Value

NANOSECONDS = 1_000_000_000
DIAGNOSTICS_PERIOD = NANOSECONDS
DIAGNOSTICS_GAP = NANOSECONDS // 10

OK, WARN, ERROR, STALE = 0, 1, 2, 3


class Output(NamedTuple):
    """A message to publish: a topic of the wiring table and a value of its type."""

    topic: str
    value: Value


class Component(Protocol):
    """A block of the block diagram.

    Attributes
    ----------
    name
        As in :data:`omni_vehicle_ros.interface.NODES`.
    beat
        Topic whose stamp opens a control cycle.
    sources
        Topics that answer in every cycle, and that the component waits for in lock step.
    """

    name: str
    beat: str
    sources: tuple[str, ...]

    def receive(self, topic: str, value: Value, now: int) -> None:
        """Take a message that came in at simulated time ``now`` [ns]."""

    def step(self, stamp: int, missing: tuple[str, ...] = ()) -> list[Output]:
        """Act on the cycle that began at ``stamp`` [ns], of whose sources some may be ``missing``."""


@runtime_checkable
class Fallible(Protocol):
    """A component that stands for hardware, too, which can fail."""

    def fail(self, fault: Fault, now: int) -> None:
        """Let what the fault names fail from ``now`` [ns] on, or be ok again; what is not its own is no matter."""


class Reporter:
    """Decides when the health of a component is worth a diagnostic: at a change, and once a second.

    What is wrong is said for a second after it was last so (`omni_vehicle_ros.control.health.Hold`).
    """

    def __init__(self, name: str) -> None:
        self._name = name
        self._last: Health | None = None
        self._when = -DIAGNOSTICS_PERIOD
        self._hold = Hold()

    def report(self, stamp: int, state: Health) -> list[Output]:
        """Return the message to publish on /diagnostics, or nothing."""
        state = self._hold.update(stamp, state)
        last, age = self._last, stamp - self._when
        if last is not None and age < DIAGNOSTICS_PERIOD and (state is last or not _changed(last, state, age)):
            return []
        self._last, self._when = state, stamp
        status = Status(state.level, self._name, state.message, state.values)
        return [Output('/diagnostics', Diagnostics(stamp, (status,)))]


def _changed(last: Health, state: Health, age: int) -> bool:
    if state.notes == last.notes:
        return False
    return state.level != last.level or (age >= DIAGNOSTICS_GAP and state.message != last.message)
