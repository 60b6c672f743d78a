"""Whether messages of a cyclic topic come once, in order and in time."""

LATE = 4
"""Cycles by which a message may be late."""

# A stamp that is older by more cycles than this is of another clock, or of one that went back.
_OTHER_CLOCK = 100


class OrderCheck:
    """Looks at the stamps of one topic.

    Parameters
    ----------
    topic
        Its name.
    period
        Time from one cycle to the next [ns].
    """

    def __init__(self, topic: str, period: int) -> None:
        self._topic = topic
        self._late, self._longest = LATE * period, _OTHER_CLOCK * period
        self._last: int | None = None
        self._now = 0
        self._wrong = ''

    def take(self, stamp: int, now: int) -> bool:
        """Return whether a message counts: not if it comes after a later one.

        Parameters
        ----------
        stamp
            Of the message [ns]; 0 is none.
        now
            Cycle in which it came in [ns]. These follow on each other, however messages overtake: one that is before
            the last one is of a clock that went back.
        """
        if now < self._now or (self._last is not None and self._last - now > self._late):
            self._last = None
        self._now = now
        last = self._last
        if stamp and last is not None and 0 <= last - stamp <= self._longest:
            self._wrong = 'comes twice' if stamp == last else 'comes out of order: the older message is dropped'
            return stamp == last
        if stamp and self._late < now - stamp <= self._longest:
            self._wrong = f'comes more than {LATE} cycles late'
        self._last = stamp or None
        return True

    def wrong(self) -> str:
        """Return what has been wrong since the last call; empty if nothing."""
        if not self._wrong:
            return ''
        wrong, self._wrong = self._wrong, ''
        return f'{self._topic} {wrong}'
