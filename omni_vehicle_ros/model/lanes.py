"""The words in which the physics make a choice, for one vehicle or for several at once.

`batch` drives vehicles side by side: what is a number for one vehicle is a vector with a lane for each of them, and a
comparison is a mask. Lanes can't part at an ``if``. So the physics work both sides out and `select`; where one
side is rare and dear, as the tyre at standstill, `anywhere` asks whether a lane needs it at all. For one vehicle all
of that is what it looks like: numbers, truth values, and an ``if``.
"""

from omni_vehicle_ros.model.state import Vector


def select(condition: bool, one: float, other: float) -> float:
    """Return ``one`` where the condition holds, else ``other``; both have been worked out."""
    return one if condition else other


def anywhere(condition: bool) -> bool:
    """Return whether the condition holds in any lane."""
    return condition


def load(numbers: Vector, row: int, column: int) -> float:
    """Return the lanes that begin at a column of a row; a plain number here, where there is but one lane.

    Parameters
    ----------
    numbers
        Shape (rows, n).
    row, column
        Where; the lanes are columns next to each other.
    """
    return float(numbers[row, column])


def store(numbers: Vector, row: int, column: int, value: float) -> None:
    """Write lanes to where `load` would find them."""
    numbers[row, column] = value
