"""Faults of a process that it brings upon itself, so that they come in the very cycle that they are meant for."""

import ctypes
import os
import signal
import time
from collections.abc import Iterable

from rclpy.duration import Duration
from rclpy.publisher import Publisher

from omni_vehicle_ros.ending import PARENT

PR_SET_PDEATHSIG = 1
SAID_LIMIT = 0.5


def end_or_freeze(failure: str, publishers: Iterable[Publisher]) -> None:
    """Kill or freeze this process, as nobody can foresee or catch; what it has published before still arrives.

    Parameters
    ----------
    failure
        ``off``: SIGKILL; ``stuck``: SIGSTOP, until someone sends SIGCONT.
    publishers
        All of this process.
    """
    end = time.monotonic() + SAID_LIMIT
    for publisher in publishers:  # one that has died never says that it has heard all
        publisher.wait_for_all_acked(Duration(seconds=max(end - time.monotonic(), 0.0)))
    if failure == 'stuck' and PARENT in os.environ:
        # A frozen process can't see that the one that started it has gone.
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    os.kill(os.getpid(), signal.SIGKILL if failure == 'off' else signal.SIGSTOP)
