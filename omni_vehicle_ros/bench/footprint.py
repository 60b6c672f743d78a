"""What a process holds of the machine: memory, open files, threads, segments of shared memory."""

import os
from pathlib import Path
from typing import NamedTuple

PAGE = os.sysconf('SC_PAGE_SIZE')
SEGMENTS = '/dev/shm/'


class Footprint(NamedTuple):
    """What a process holds.

    Attributes
    ----------
    memory
        Resident [byte].
    files
        Open files, sockets among them.
    threads
        Of the process.
    segments
        Files of shared memory that it has mapped.
    """

    memory: int
    files: int
    threads: int
    segments: int


def footprint(process: int) -> Footprint:
    """Return what a process holds now.

    Parameters
    ----------
    process
        Its number.

    Raises
    ------
    OSError
        It has ended.
    """
    folder = Path(f'/proc/{process}')
    pages = (folder / 'statm').read_text(encoding='ascii').split()[1]
    maps = (folder / 'maps').read_text(encoding='utf-8', errors='replace').splitlines()
    mapped = {line[line.index(SEGMENTS) :] for line in maps if SEGMENTS in line}
    files, threads = (len(os.listdir(folder / name)) for name in ('fd', 'task'))
    return Footprint(int(pages) * PAGE, files, threads, len(mapped))
