"""How a part of the control is doing, as /diagnostics will say it."""

from typing import NamedTuple

OK, WARN, ERROR = 0, 1, 2


class Health(NamedTuple):
    """The state of a part.

    A message names the value and the limit that matter, but no number that changes from cycle to cycle:
    so a new message means a new state, and a log of the changes is no flood.

    Attributes
    ----------
    level
        0 OK, 1 warning, 2 error.
    message
        All that is wrong, in one line; what it is doing if nothing is.
    values
        Names and values worth showing beside it.
    """

    level: int
    message: str
    values: tuple[tuple[str, str], ...] = ()


def health(notes: list[tuple[int, str]], doing: str, values: tuple[tuple[str, str], ...] = ()) -> Health:
    """Join notes into one state: the highest level, and the messages from the worst to the mildest.

    Parameters
    ----------
    notes
        Level and message of each thing to say.
    doing
        The message if there is no note.
    values
        Names and values worth showing beside it.
    """
    if not notes:
        return Health(OK, doing, values)
    notes = sorted(notes, key=lambda note: -note[0])
    return Health(notes[0][0], '; '.join(text for _, text in notes), values)
