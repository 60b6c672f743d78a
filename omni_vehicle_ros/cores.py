"""Processor cores for those who take turns: lock step goes faster where nobody has to be woken on another core."""

import os
import socket
from contextlib import suppress

CORE = 'OMNI_VEHICLE_CORE'
"""Environment variable: number of the core that a node stays on in lock step."""


class Core:
    """One core that no other vehicle on this machine has claimed, if there is one, until it is let go.

    Attributes
    ----------
    number
        Of the core; None if all are claimed, or if the system can't tell.
    neighbour
        Number of the next core, for what can be done at the same time: there is always work for two of the four
        wheel modules. It may be the core of another vehicle, whose modules are here in turn.
    """

    def __init__(self) -> None:
        self.number: int | None = None
        self.neighbour: int | None = None
        self._claim: socket.socket | None = None

    def claim(self) -> None:
        """Take the first one that is free."""
        allowed = sorted(os.sched_getaffinity(0)) if hasattr(os, 'sched_getaffinity') else []
        # With one core there is nothing to choose.
        for i, number in enumerate(allowed if len(allowed) > 1 else []):
            claim = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
            try:
                # An abstract name: it is there as long as this process is, and leaves no file.
                claim.bind(f'\0omni_vehicle_ros/core/{number}')
            except OSError:
                claim.close()
                continue
            self.number, self.neighbour, self._claim = number, allowed[(i + 1) % len(allowed)], claim
            break

    def let_go(self) -> None:
        """Leave the core to others."""
        if self._claim is not None:
            self._claim.close()
        self.number = self.neighbour = self._claim = None


def stay_on_core() -> None:
    """Keep the threads of this process on the core that `CORE` names, if it names one."""
    core = os.environ.get(CORE, '')
    if not core.isdigit():
        return
    for thread in os.listdir('/proc/self/task'):
        with suppress(OSError):  # a thread that has ended, or a core that is not ours
            os.sched_setaffinity(int(thread), {int(core)})
