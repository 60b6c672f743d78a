"""Which policy the kernel schedules the threads of this process by."""

import os
from contextlib import suppress


def work_through() -> None:
    """Have no thread that wakes take the processor from one that works: in lock step that only adds switches."""
    _schedule('SCHED_BATCH', 0)


def be_punctual(priority: int) -> str:
    """Have the threads of this process go before those of others (first in, first out).

    Parameters
    ----------
    priority
        From 1 up; 0 leaves it to the system.

    Returns
    -------
    str
        Why the system refuses; empty if it does not.
    """
    if not priority:
        return ''
    try:
        _schedule('SCHED_FIFO', priority)
    except (OSError, AttributeError) as error:
        return getattr(error, 'strerror', None) or 'not on this system'
    return ''


def _schedule(policy: str, priority: int) -> None:
    """Set the policy of every thread that is there; those to come take after the one that starts them."""
    parameter = os.sched_param(priority)
    for thread in os.listdir('/proc/self/task'):
        with suppress(ProcessLookupError):
            os.sched_setscheduler(int(thread), getattr(os, policy), parameter)
