"""Who may drive: one source of commands at a time, by priority and freshness, as twist_mux does it.

An emergency stop goes before all of them; see `omni_vehicle_ros.control.emergency_stop`.
"""

from enum import Enum

from omni_vehicle_ros.control.freshness import CommandMonitor, Freshness


class Source(Enum):
    """Topic that carries the heartbeat of a source, and its priority: more goes first."""

    SPEED = 'driver/speed', 2
    TRACTION = 'driver/traction', 2
    TELEOP = 'teleop/cmd_vel', 2
    CMD_VEL = 'cmd_vel', 1

    def __init__(self, topic: str, priority: int) -> None:
        self.topic = topic
        self.priority = priority

    # That of Enum is written in Python, and takes five times as long.
    __hash__ = object.__hash__

    @property
    def kind(self) -> str:
        """What stands behind it."""
        return 'teleop' if self.priority > 1 else 'autonomy'


class Arbitration:
    """Chooses among the sources of commands.

    The fresh source of the highest priority drives; of several of the same priority, which are one hand, the one
    that spoke last. When it falls silent the next lower one takes over as soon as it is stale. When all are
    stale, the one that drove last is the one that is missed.

    Parameters
    ----------
    timeout
        Age at which a command is stale [s]; 0: never, so that only a source of no lower priority takes over.
    """

    def __init__(self, timeout: float) -> None:
        self._timeout = timeout
        self._monitors: dict[Source, CommandMonitor] = {}  # as they spoke, the last one last
        self._holder: Source | None = None

    def received(self, source: Source, stamp: int, now: int) -> None:
        """Note a valid command of a source, stamped ``stamp``, that came in at ``now`` [ns]."""
        monitor = self._monitors.pop(source, None) or CommandMonitor(self._timeout)
        monitor.received(stamp, now)
        self._monitors[source] = monitor

    def choose(self, now: int) -> Source | None:
        """Return which source drives at ``now`` [ns]; None before any has spoken."""
        fresh = self._fresh(now)
        if fresh:
            self._holder = max(reversed(fresh), key=lambda source: source.priority)
        elif self._holder is None and self._monitors:
            self._holder = next(reversed(self._monitors))
        return self._holder

    def ignored(self, now: int) -> list[Source]:
        """Return the sources that speak at ``now`` [ns], but have a lower priority than the one that drives."""
        holder = self._holder
        return [source for source in self._fresh(now) if holder is not None and source.priority < holder.priority]

    def state(self, now: int) -> Freshness:
        """Return whether the source that drives is fresh at ``now`` [ns]."""
        return Freshness.NEVER if self._holder is None else self._monitors[self._holder].state(now)

    @property
    def source(self) -> Source | None:
        """The source that drives, as of the last choice."""
        return self._holder

    @property
    def warning(self) -> str:
        """What is wrong with the stamps of the source that drives; empty if nothing is."""
        return self._monitors[self._holder].warning if self._holder else ''

    def _fresh(self, now: int) -> list[Source]:
        return [source for source, monitor in self._monitors.items() if monitor.fresh(now)]
