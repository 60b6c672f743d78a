"""What a process holds of the machine: memory, open files, threads, segments of shared memory."""

import os
from pathlib import Path
from typing import NamedTuple

SEGMENTS = '/dev/shm/'
KIBIBYTE = 1024


class Footprint(NamedTuple):
    """What a process holds.

    Attributes
    ----------
    resident
        Memory [byte], shared libraries and shared memory included.
    own
        Of that what is neither a file nor shared: what a leak would add to [byte].
    files
        Open files, sockets among them.
    threads
        Of the process.
    segments
        Files of shared memory that it has mapped.
    """

    resident: int
    own: int
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
    lines = (folder / 'status').read_text(encoding='utf-8', errors='replace').splitlines()
    status = {key: value for key, _, value in (line.partition(':') for line in lines)}
    resident, own = (int(status[key].split()[0]) * KIBIBYTE for key in ('VmRSS', 'RssAnon'))
    maps = (folder / 'maps').read_text(encoding='utf-8', errors='replace').splitlines()
    mapped = {line[line.index(SEGMENTS) :] for line in maps if SEGMENTS in line}
    return Footprint(resident, own, len(os.listdir(folder / 'fd')), int(status['Threads']), len(mapped))
