"""What the nodes complained about during a run."""

from typing import NamedTuple

from omni_vehicle_ros.bags import Bag


class Trouble(NamedTuple):
    """A diagnostic above OK: when it came first [s], how bad (1 warning, 2 error), from whom, and what."""

    time: float
    level: int
    node: str
    message: str


def troubles(bag: Bag) -> list[Trouble]:
    """Return every different diagnostic above OK, in the order of time."""
    if '/diagnostics' not in bag or not len(bag['/diagnostics']):
        return []
    column = bag['/diagnostics']
    found: dict[tuple[str, str], Trouble] = {}
    for time, statuses in zip(column.stamp, column.statuses, strict=True):
        for status in statuses:
            if status.level > 0:
                trouble = Trouble(float(time), status.level, status.name, status.message)
                found.setdefault((status.name, status.message), trouble)
    return list(found.values())
