"""How fast bags are read as columns: beside mcap-ros2-support's decoder, and beside reading and decompressing alone."""

import os
import struct
import tempfile
from collections.abc import Mapping
from functools import partial
from importlib.util import find_spec
from itertools import islice
from pathlib import Path

import numpy as np
import zstandard

from omni_vehicle_ros.bags import BagWriter, read_blocks
from omni_vehicle_ros.bags.mcap.records import CHUNK, FOOTER, MAGIC, RECORD
from omni_vehicle_ros.bench.examples import example
from omni_vehicle_ros.bench.frame import (
    CALIBRATION,
    ROUNDS,
    Line,
    Progress,
    Result,
    Time,
    at_least,
    at_most,
    interleaved,
)
from omni_vehicle_ros.interface import TOPICS, Topic
from omni_vehicle_ros.messages import SECOND, encode

CYCLES = 40_000
"""Of 5 ms: 200 s of driving."""
DIFFERENT = 1000
"""Cycles until the numbers are the same again: far more than a chunk holds."""
DECODED = 10_000
"""Messages that mcap-ros2-support decodes in a round, after a first one: opening the file, 0.1 s, is not counted."""
PERIOD = SECOND // 200


def bench(progress: Progress = lambda done: None, *, cycles: int = CYCLES, rounds: int = ROUNDS) -> Result:
    """Make a bag, read it in all ways in turn, and return messages per second of CPU time.

    Parameters
    ----------
    progress
        Told the share that is done.
    cycles
        Control cycles in the bag.
    rounds
        As in `interleaved`.
    """
    with tempfile.TemporaryDirectory() as folder:
        messages = write_bag(Path(folder) / 'bag', cycles)
        (path,) = (Path(folder) / 'bag').glob('*.mcap')
        works = (read_columns, decompress, *((decode_messages, open_only) if find_spec('mcap_ros2') else ()))
        times = interleaved({work.__name__: partial(work, path) for work in works}, progress, rounds)
        size = path.stat().st_size
    columns, plain = (times[work.__name__].cpu / messages for work in (read_columns, decompress))
    return Result(
        (
            decoder_line(times, 1.0 / columns, min(messages - 1, DECODED)),
            Line('columns', 'us/message', 1e6 * columns, 1e6 * plain, 'reading and decompressing', at_most(2.5)),
        ),
        times[CALIBRATION],
        (f'{messages} messages, {size / 2**20:.1f} MiB',),
    )


def decoder_line(times: Mapping[str, Time], ours: float, decoded: int) -> Line:
    """Return the line beside mcap-ros2-support, where it is installed; ours in messages per second."""
    what, unit, against = 'columns', 'messages/s', 'mcap-ros2-support'
    if open_only.__name__ not in times:
        note = 'not installed: pip install omni_vehicle_ros[bench]'
        return Line(what, unit, ours, None, against, at_least(100.0), note)
    cpu = times[decode_messages.__name__].cpu - times[open_only.__name__].cpu
    return Line(what, unit, ours, decoded / cpu, against, at_least(100.0))


def read_columns(path: Path) -> int:
    """Read all columns of a bag; return the number of messages."""
    return sum(len(columns) for _, columns in read_blocks(path))


def open_only(path: Path) -> int:
    """Open a bag and decode its first message by mcap-ros2-support."""
    return decode_messages(path, 1)


def decode_messages(path: Path, count: int = DECODED + 1) -> int:
    """Decode the first messages of a bag by mcap-ros2-support; return their number."""
    from mcap.reader import make_reader
    from mcap_ros2.decoder import DecoderFactory

    with path.open('rb') as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        return sum(1 for _ in islice(reader.iter_decoded_messages(), count))


def decompress(path: Path) -> int:
    """Read a file and decompress its chunks, checking nothing; return their size [byte]."""
    decompressor, size = zstandard.ZstdDecompressor(), 0
    with path.open('rb') as file:
        file.seek(len(MAGIC))
        opcode = 0
        while opcode != FOOTER:
            opcode, length = RECORD.unpack(file.read(RECORD.size))
            if opcode == CHUNK:
                content = file.read(length)
                begin = 40 + struct.unpack_from('<I', content, 28)[0]
                size += len(decompressor.decompress(memoryview(content)[begin:]))
            else:
                file.seek(length, os.SEEK_CUR)
    return size


def write_bag(directory: Path, cycles: int) -> int:
    """Write a bag with the cyclic topics of a vehicle, with numbers that don't compress; return its messages."""
    random = np.random.default_rng(0)
    rows = [row for row in TOPICS if row.recorded and row.cyclic]
    several = [_messages(rows, cycle, random) for cycle in range(min(cycles, DIFFERENT))]
    with BagWriter(directory) as writer:
        for row in rows:
            writer.add_topic(f'/{row.name.lstrip("/")}', row.type, row.qos)
        for cycle in range(cycles):
            for row, data in zip(rows, several[cycle % len(several)], strict=True):
                writer.write(f'/{row.name.lstrip("/")}', data, cycle * PERIOD)
    return cycles * len(rows)


def _messages(rows: list[Topic], cycle: int, random: np.random.Generator) -> list[bytes]:
    return [encode(row.type, example(row, cycle * PERIOD, iter(random.normal(size=24).tolist()))) for row in rows]
