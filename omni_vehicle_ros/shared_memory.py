"""Segments of shared memory that Fast DDS makes for a process, half a megabyte each: one that is killed leaves its own.

What several processes share, such as the ports of a domain, Fast DDS takes up again by itself.
"""

import os
import re
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

FOLDER = Path('/dev/shm')
LOCK = '_el'
"""End of the name of the file that the owner of a segment holds open."""

_LOCK_FILE = re.compile(rf'{FOLDER}/(fastrtps_[0-9a-f]{{16}}){LOCK}')


def segments_of(process: int) -> set[str]:
    """Return the names of the segments that a process owns; none if it has ended."""
    found: set[str] = set()
    with suppress(OSError):
        for entry in Path(f'/proc/{process}/fd').iterdir():
            with suppress(OSError):
                match = _LOCK_FILE.fullmatch(os.readlink(entry))
                found.update(match.groups() if match else ())
    return found


def existing(names: Iterable[str]) -> list[str]:
    """Return those of some segments that exist."""
    return [name for name in names if (FOLDER / name).exists()]


def remove(names: Iterable[str]) -> None:
    """Remove segments whose owners have ended, if they are there."""
    for name in names:
        for file in (name, f'{name}{LOCK}'):
            (FOLDER / file).unlink(missing_ok=True)
