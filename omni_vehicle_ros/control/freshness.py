"""How old a command is: never received, fresh, or stale."""

import math
from enum import IntEnum

NANOSECONDS = 1_000_000_000

# Further apart than this, two stamps can't be of the same clock: one is simulated and one wall time.
_OTHER_CLOCK = 60 * NANOSECONDS
_AHEAD = NANOSECONDS // 2


class Freshness(IntEnum):
    """State of a source of commands."""

    NEVER = 0
    FRESH = 1
    STALE = 2


class CommandMonitor:
    """Watches the age of the commands of one source.

    Parameters
    ----------
    timeout
        Age at which a command is stale [s]; 0: never.

    Attributes
    ----------
    warning
        What is wrong with the stamps of the last command; empty if nothing is.

    Notes
    -----
    The age counts from the stamp, so that a command that was long under way is as old as it is. A zero
    stamp means now. A stamp of the future, or of another clock, tells no age: the time of arrival counts
    in its place.
    """

    def __init__(self, timeout: float) -> None:
        self._timeout = round(timeout * NANOSECONDS) or math.inf
        self._since: int | None = None
        self.warning = ''

    def received(self, stamp: int, now: int) -> None:
        """Note a valid command.

        Parameters
        ----------
        stamp
            What the command says [ns]; 0 means now.
        now
            When it came in [ns].
        """
        lag = now - stamp if stamp else 0
        self._since = stamp if 0 < lag <= _OTHER_CLOCK else now
        self.warning = '' if -_AHEAD <= lag <= _OTHER_CLOCK else (
            'stamps are of the future or of another clock: the time of arrival counts; '
            'set use_sim_time of the sender, or leave the stamp 0'
        )

    def state(self, now: int) -> Freshness:
        """Return whether the last command still holds at ``now`` [ns]."""
        if self._since is None:
            return Freshness.NEVER
        return Freshness.FRESH if now - self._since <= self._timeout else Freshness.STALE

    def fresh(self, now: int) -> bool:
        """Return whether there is a command and it still holds at ``now`` [ns]."""
        return self._since is not None and now - self._since <= self._timeout

    def age(self, now: int) -> int:
        """Return how old the last command is at ``now`` [ns]; there must be one."""
        return now - (self._since or 0)

    def forget(self) -> None:
        """Begin anew, as if no command had ever come: for a clock that jumped back."""
        self._since, self.warning = None, ''
