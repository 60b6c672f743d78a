"""What the process that has started a node says on its standard input: which other nodes have died."""

import os
from collections.abc import Callable

from omni_vehicle_ros.ending import DIED, PARENT, READY, WITHOUT

STDIN = 0
MOST = 4096


class Supervisor:
    """Hears of other nodes what only who has started them can know at once; the graph keeps a dead one for seconds.

    Parameters
    ----------
    died
        Called with a node that has died: its publishers in the graph are nobody's any more.
    without
        Called after that with the same node, when it is gone for good, or there again without an answer to what
        others wait for.
    """

    def __init__(self, died: Callable[[str], None], without: Callable[[str], None]) -> None:
        self._calls = {DIED: died, WITHOUT: without}
        self._begun = b''
        self._speaks = PARENT in os.environ
        if self._speaks:
            os.set_blocking(STDIN, False)

    def listen(self) -> None:
        """Take what was said since the last time."""
        if not self._speaks:
            return
        try:
            data = os.read(STDIN, MOST)
        except BlockingIOError:
            return
        self._speaks = bool(data)
        *lines, self._begun = (self._begun + data).split(b'\n')
        for line in lines:
            word, role = line.decode().split()
            self._calls[word](role)

    def say_ready(self, role: str) -> None:
        """Say that a node is connected to all the others."""
        if self._speaks:
            print(READY, role, flush=True)
