"""The signals that end a command or a node, where they may come through, and the words about nodes that ended."""

import signal
import threading
from collections.abc import Callable
from types import TracebackType
from typing import Any

ENDING = (signal.SIGINT, signal.SIGTERM)
EXIT_SIGNAL = 128
"""Plus the number of the signal: exit code of a command that a signal ended, as shells have it."""

PARENT = 'OMNI_VEHICLE_PARENT'
"""Environment variable: a node whose parent is no longer the process of this number ends."""

DIED, WITHOUT, READY = 'died', 'without', 'ready'
"""Words before the name of a node: the first two are said to the nodes by who has started them, the last one to him.

A node has died; it is no longer waited for, as it is gone for good or there again; it is connected to all the others.
"""


def hold_signals() -> None:
    """Keep SIGINT and SIGTERM pending until there is someone to handle them; child processes inherit this."""
    signal.pthread_sigmask(signal.SIG_BLOCK, ENDING)


def release_signals() -> None:
    """Let SIGINT and SIGTERM through, those that came meanwhile included."""
    signal.pthread_sigmask(signal.SIG_UNBLOCK, ENDING)


class Uninterrupted:
    """A context in which SIGINT and SIGTERM are noted, and reach their handlers at `deliver` or at its end.

    A handler that raises would else leave half done what is under way, such as a chunk of a bag. Only the main thread
    gets signals; in any other this does nothing.
    """

    def __init__(self) -> None:
        self._came: list[int] = []
        self._handlers: dict[int, Callable[[int, Any], Any] | int | None] = {}

    def deliver(self) -> None:
        """Hand the first signal that came to its handler, which may raise."""
        if self._came:
            self._restore()
            signal.raise_signal(self._came.pop(0))

    def __enter__(self) -> 'Uninterrupted':
        """Begin."""
        if threading.current_thread() is threading.main_thread():
            self._handlers = {number: signal.signal(number, self._note) for number in ENDING}
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """End; a signal that came and was not delivered is now."""
        self._restore()
        self.deliver()

    def _note(self, number: int, frame: object) -> None:
        self._came.append(number)

    def _restore(self) -> None:
        """Give the handlers back, once: they may set others."""
        for number, handler in self._handlers.items():
            signal.signal(number, handler)
        self._handlers = {}
