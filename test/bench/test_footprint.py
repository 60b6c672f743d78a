"""What a process holds, as the system says it."""

import mmap
import os
import threading
from pathlib import Path

import pytest

from omni_vehicle_ros.bench.footprint import SEGMENTS, footprint

SIZE = 50_000_000


def test_what_is_taken_is_seen_and_what_is_given_back_too():
    before = footprint(os.getpid())
    assert before.own <= before.resident
    held = bytearray(SIZE)
    held[::4096] = b'x' * len(held[::4096])
    over = threading.Event()
    thread = threading.Thread(target=over.wait)
    thread.start()
    try:
        with open(__file__, 'rb'):
            now = footprint(os.getpid())
        assert now.own - before.own == pytest.approx(SIZE, rel=0.1)
        assert (now.files, now.threads) == (before.files + 1, before.threads + 1)
    finally:
        over.set()
        thread.join()
    del held
    assert footprint(os.getpid()).own < before.own + 0.5 * SIZE


def test_shared_memory_is_counted():
    path = Path(SEGMENTS) / f'test_footprint_{os.getpid()}'
    before = footprint(os.getpid()).segments
    try:
        with path.open('w+b') as file:
            file.truncate(4096)
            with mmap.mmap(file.fileno(), 4096):
                assert footprint(os.getpid()).segments == before + 1
    finally:
        path.unlink(missing_ok=True)


def test_who_has_ended_holds_nothing():
    with pytest.raises(OSError):
        footprint(2**22 + 1)
