"""Tells the beats of a vehicle, the messages that begin its cycles, from those of a stranger with another clock."""

FOREIGN = 1_000_000_000
"""A stamp farther than this from the beat before is of another clock [ns]."""


class Beats:
    """Follows the stamps of beats.

    Parameters
    ----------
    enough
        Beats of another clock in a row, near each other, from which on that is the clock: the plant was started anew.
    """

    def __init__(self, enough: int) -> None:
        self._enough = enough
        self._last: int | None = None
        self._strange, self._strangers = 0, 0

    def accept(self, stamp: int) -> bool:
        """Take a beat of ``stamp`` [ns]; return whether it is one of the vehicle."""
        if stamp < 0:
            return False
        if self._last is not None and abs(stamp - self._last) > FOREIGN:
            agrees = self._strangers and abs(stamp - self._strange) <= FOREIGN
            self._strange, self._strangers = stamp, self._strangers + 1 if agrees else 1
            if self._strangers < self._enough:
                return False
        self._last, self._strangers = stamp, 0
        return True
