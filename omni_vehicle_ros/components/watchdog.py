"""Sees by the wall clock that nothing is heard any more."""

import math

LISTENING = 0.05
"""Longest time between two looks that counts [s]: a process that was not served hears nobody who is there."""


class Watchdog:
    """Begins to watch with the first message, and again with the next one after it has struck.

    Parameters
    ----------
    limit
        Time without a message after which it strikes [s].
    """

    def __init__(self, limit: float) -> None:
        self.left = math.inf
        """Time until it strikes, if nothing comes [s]."""
        self._limit = limit
        self._seen = 0.0

    def heard(self, now: float) -> None:
        """Note a message at the wall time ``now`` [s]."""
        self.left, self._seen = self._limit, now

    def strikes(self, now: float) -> bool:
        """Look at the clock, which says ``now`` [s]; return whether the limit has passed since the last look."""
        self.left -= min(now - self._seen, LISTENING)
        self._seen = now
        if self.left > 0.0:
            return False
        self.left = math.inf
        return True
