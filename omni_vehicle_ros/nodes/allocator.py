"""How the C library keeps memory that was given back to it."""

import ctypes

M_TRIM_THRESHOLD, M_MMAP_THRESHOLD = -1, -3
"""Of ``mallopt`` in ``<malloc.h>`` of glibc."""

LARGE = 1 << 20
"""Blocks from this size on get pages of their own; no message of a vehicle has a tenth of it [byte]."""


def give_back() -> None:
    """Have large blocks go back to the system as soon as they are free; does nothing where malloc has no such choice.

    By itself glibc takes the largest block that was ever freed, up to 32 MiB, for the usual size: after a message of
    10 MB the next one is cut out of memory that many share, with holes that stay.
    """
    mallopt = getattr(ctypes.CDLL(None), 'mallopt', None)
    if mallopt is not None:
        mallopt(M_MMAP_THRESHOLD, LARGE)
        mallopt(M_TRIM_THRESHOLD, LARGE)
