"""Bytes that must wait, however many: few in memory, the others in a file without a name."""

import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import IO

from omni_vehicle_ros.bags.mcap.whole_writes import write_whole

PORTION = 2**16
"""What waits in memory at most, about, and is read back at a time [byte]."""


class Spill:
    """A queue of bytes that takes the same memory whatever its length.

    The file is made when it is needed first. It has no name, so that nothing is left of it when the process is killed.

    Parameters
    ----------
    directory
        On whose file system it lies: what is full then is what the user knows to be in use.

    Raises
    ------
    OSError
        In every method, if the system refuses.
    """

    def __init__(self, directory: Path) -> None:
        self._directory = directory
        self._waiting = bytearray()
        self._file: IO[bytes] | None = None

    def add(self, data: bytes) -> None:
        """Take bytes."""
        self._waiting += data
        if len(self._waiting) < PORTION:
            return
        if self._file is None:
            self._file = tempfile.TemporaryFile(dir=self._directory, buffering=0)  # noqa: SIM115  (closed by close)
        write_whole(self._file, self._waiting)
        self._waiting.clear()

    def pieces(self) -> Iterator[bytes]:
        """Give all that was taken, in order; nothing may be added any more."""
        if self._file is not None:
            self._file.seek(0)
            while piece := self._file.read(PORTION):
                yield piece
        yield bytes(self._waiting)

    def close(self) -> None:
        """Forget everything."""
        if self._file is not None:
            self._file.close()
