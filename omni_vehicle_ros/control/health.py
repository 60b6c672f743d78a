"""How a part of the control is doing, as /diagnostics will say it."""

from functools import lru_cache
from typing import NamedTuple

from omni_vehicle_ros.control.freshness import NANOSECONDS

OK, WARN, ERROR = 0, 1, 2

Note = tuple[int, str]
"""A level and what there is to say."""

HOLD = NANOSECONDS
"""How long what was wrong is said after it was last so, in simulated time [ns]."""

_MOST = 6  # notes that are held: a sender of ever new nonsense fills no list


class Health(NamedTuple):
    """The state of a part.

    A note names the value and the limit that matter, but no number that changes from cycle to cycle: so a
    new note means a new state, and a log of the changes is no flood.

    Attributes
    ----------
    notes
        All that is wrong, from the worst to the mildest; what it is doing if nothing is.
    values
        Names and values worth showing beside it.
    """

    notes: tuple[Note, ...]
    values: tuple[tuple[str, str], ...] = ()

    @property
    def level(self) -> int:
        """0 OK, 1 warning, 2 error."""
        return self.notes[0][0]

    @property
    def message(self) -> str:
        """All notes in one line."""
        return '; '.join(text for _, text in self.notes)

    def with_notes(self, *notes: Note) -> 'Health':
        """Return the state with more that is wrong."""
        if not notes:
            return self
        wrong = [note for note in self.notes if note[0] > OK]
        return health([*wrong, *notes], self.notes[0][1], self.values)


def health(notes: list[Note], doing: str, values: tuple[tuple[str, str], ...] = ()) -> Health:
    """Put notes in order: from the worst to the mildest, and among equals as they come.

    Parameters
    ----------
    notes
        Level and text of each thing to say.
    doing
        The text if there is none.
    values
        Names and values worth showing beside it.
    """
    if not notes:
        return _fine(doing, values)
    return Health(tuple(sorted(notes, key=lambda note: -note[0])), values)


@lru_cache(maxsize=64)
def _fine(doing: str, values: tuple[tuple[str, str], ...]) -> Health:
    """Return the state of a part in nearly every cycle: one object, which is quick to compare with itself."""
    return Health(((OK, doing),), values)


class Hold:
    """Says what was wrong for a while after it has ended, so that what comes and goes does not flap.

    A trim that touches its limit in every period of an oscillation is one state, and not fifty. Time is that
    of the stamps, so the same run says the same.
    """

    def __init__(self) -> None:
        self._held: dict[Note, int] = {}
        self._now = 0

    def update(self, stamp: int, now: Health) -> Health:
        """Return the state with what was wrong up to `HOLD` ago, of which the six latest are kept.

        Parameters
        ----------
        stamp
            The present [ns]; a clock that jumped back forgets what was before.
        now
            The present state.
        """
        if stamp < self._now:
            self._held.clear()
        self._now = stamp
        if not self._held and now.notes[0][0] == OK:
            return now
        self._held.update((note, stamp) for note in now.notes if note[0] > OK)
        latest = sorted(self._held.items(), key=lambda entry: (-entry[1], -entry[0][0]))[:_MOST]
        kept = {note for note, when in latest if stamp - when < HOLD}
        self._held = {note: when for note, when in self._held.items() if note in kept}
        return health(list(self._held), now.notes[0][1], now.values)
