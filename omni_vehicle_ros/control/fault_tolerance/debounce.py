"""When what looks wrong counts as wrong, and when it counts as right again."""


class Debounce:
    """Counts cycles: so many in a row to be wrong, so many in a row to be right again.

    Parameters
    ----------
    wrong, right
        Cycles in a row.
    """

    def __init__(self, wrong: int, right: int) -> None:
        self._wrong, self._right = wrong, right
        self._count = 0
        self.on = False

    def update(self, seen: bool) -> bool:
        """Take one cycle; return whether it counts as wrong."""
        if seen is self.on:
            self._count = 0
        else:
            self._count += 1
            if self._count >= (self._right if self.on else self._wrong):
                self.on, self._count = seen, 0
        return self.on
