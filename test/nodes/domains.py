"""ROS domains of which each belongs to one test at a time, whatever other tests run on this machine."""

import contextlib
import fcntl
import itertools
import os
import tempfile
from collections.abc import Iterator
from pathlib import Path

DOMAINS = range(1, 102)
"""The ports of higher ones lie among those that Linux gives to anyone."""

_turns = itertools.count(os.getpid())


@contextlib.contextmanager
def held_domain(directory: Path | None = None) -> Iterator[int]:
    """Hold a domain that nobody else holds; each time another one, as dead processes may have left something in it.

    Its file in ``directory`` is locked until then; the system unlocks it if this process is killed.
    """
    folder = directory or Path(tempfile.gettempdir())
    first = next(_turns)
    for turn in range(len(DOMAINS)):
        domain = DOMAINS[(first + turn) % len(DOMAINS)]
        file = _opened(folder / f'ros_domain_{domain}.lock')
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            os.close(file)
            continue
        try:
            yield domain
        finally:
            os.close(file)
        return
    raise RuntimeError(f'other tests hold all domains: see who has opened {folder}/ros_domain_*.lock')


def _opened(path: Path) -> int:
    """Open a file, that of another user, too."""
    with contextlib.suppress(FileExistsError):
        os.close(os.open(path, os.O_CREAT | os.O_EXCL, 0o644))
    return os.open(path, os.O_RDONLY)
