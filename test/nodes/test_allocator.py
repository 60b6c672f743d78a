"""Blocks that are large go back to the system as soon as nobody needs them."""

import subprocess
import sys

USE = """
from pathlib import Path
from omni_vehicle_ros.nodes.allocator import give_back

def own():
    status = Path('/proc/self/status').read_text(encoding='utf-8')
    return int(status.partition('RssAnon:')[2].split()[0])

give_back()
bytearray(20 << 20)
before = own()
block = bytearray(16 << 20)
for place in range(0, len(block), 4096):
    block[place] = 1
full = own()
del block
print(full - before, own() - before)
"""
"""Says what is held more than before with a block and without it [KiB]; the first, larger one has glibc change its mind
by itself: from then on it would keep smaller ones."""


def test_the_memory_of_a_large_block_goes_back_to_the_system_when_it_is_free() -> None:
    done = subprocess.run([sys.executable, '-c', USE], capture_output=True, text=True, check=True)
    full, free = map(int, done.stdout.split())
    assert full >= 16 << 10
    assert free < 1 << 10
