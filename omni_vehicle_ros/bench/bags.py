"""How fast bags are read as columns: beside mcap-ros2-support's decoder, and beside reading and decompressing alone."""

import os
import struct
import tempfile
import time
from collections.abc import Callable, Iterator
from itertools import islice
from pathlib import Path
from statistics import median
from typing import Any, NamedTuple

import numpy as np
import zstandard

from omni_vehicle_ros.bags import BagWriter, read_blocks
from omni_vehicle_ros.bags.mcap.records import CHUNK, FOOTER, MAGIC, RECORD
from omni_vehicle_ros.errors import RunError
from omni_vehicle_ros.interface import TOPICS, Topic
from omni_vehicle_ros.messages import (
    SECOND,
    VALUE_TYPES,
    Clock,
    Forces,
    Imu,
    Joints,
    Odometry,
    Step,
    Twist,
    encode,
)
from omni_vehicle_ros.wheels import WHEELS

CYCLES = 40_000
"""Of 5 ms: 200 s of driving."""
DIFFERENT = 1000
"""Cycles until the numbers are the same again: far more than a chunk holds."""
ROUNDS = 5
DECODED = 10_000
"""Messages that mcap-ros2-support decodes in a round, after a first one: opening the file, 0.1 s, is not counted."""
PERIOD = SECOND // 200
CALIBRATION = 100
"""Sorts of 20,000 numbers."""


class Way(NamedTuple):
    """How a way to read did.

    Attributes
    ----------
    rate
        Messages per second of CPU time, median of the rounds.
    wall_rate
        Messages per second.
    """

    rate: float
    wall_rate: float


class Result(NamedTuple):
    """What was measured.

    Attributes
    ----------
    messages, size
        Of the bag; size in byte.
    columns, decoder, decompress
        By this package; by mcap-ros2-support; reading and decompressing alone.
    calibration
        Wall and CPU time of a fixed piece of work [s], medians: more than it was elsewhere means a slower machine, and
        wall above CPU one that is shared.
    """

    messages: int
    size: int
    columns: Way
    decoder: Way
    decompress: Way
    calibration: tuple[float, float]

    @property
    def lines(self) -> tuple[str, ...]:
        """What to print."""
        wall, cpu = self.calibration
        rows = (
            ('columns', self.columns), ('mcap-ros2-support', self.decoder), ('read and decompress', self.decompress)
        )
        return (
            f'{self.messages} messages, {self.size / 2**20:.1f} MiB; messages/s of CPU time (of wall time), medians:',
            *(f'{name:20} {way.rate:12,.0f} ({way.wall_rate:,.0f})' for name, way in rows),
            f'columns are {self.columns.rate / self.decoder.rate:.0f} x as fast as mcap-ros2-support and take '
            f'{self.decompress.rate / self.columns.rate:.2f} x the time of reading and decompressing',
            f'calibration: {wall * 1e3:.1f} ms wall, {cpu * 1e3:.1f} ms CPU',
        )

    def as_json(self) -> dict[str, Any]:
        """Return it as JSON has it."""
        ways = {name: getattr(self, name)._asdict() for name in ('columns', 'decoder', 'decompress')}
        return {
            'messages': self.messages, 'size': self.size, **ways,
            'columns_per_decoder': self.columns.rate / self.decoder.rate,
            'time_per_decompress': self.decompress.rate / self.columns.rate,
            'calibration': {'wall': self.calibration[0], 'cpu': self.calibration[1]},
        }


def bench(
    progress: Callable[[float], None] = lambda done: None, *, cycles: int = CYCLES, rounds: int = ROUNDS
) -> Result:
    """Make a bag, read it in all ways in turn, and return medians.

    Parameters
    ----------
    progress
        Told how many rounds are done; the bag counts as one.
    cycles
        Control cycles in the bag.
    rounds
        After one whose times don't count, in which what is compiled is loaded.

    Raises
    ------
    RunError
        mcap-ros2-support is not installed.
    """
    try:
        import mcap_ros2  # noqa: F401
    except ImportError:
        raise RunError('mcap-ros2-support is not installed: pip install mcap-ros2-support') from None
    with tempfile.TemporaryDirectory() as folder:
        messages = write_bag(Path(folder) / 'bag', cycles)
        (path,) = (Path(folder) / 'bag').glob('*.mcap')
        works = (read_columns, decode_messages, decompress, calibrate, open_only)
        times: list[list[tuple[float, float]]] = []
        for done in range(rounds + 1):
            progress(done)
            times.append([_time(work, path) for work in works])
        size = path.stat().st_size
    columns, decoder, alone, calibration, opening = (
        tuple(median(one[place] for one in way) for place in range(2)) for way in zip(*times[1:], strict=True)
    )
    decoded = min(messages - 1, DECODED)
    decoder_way = _way(decoded, tuple(whole - first for whole, first in zip(decoder, opening, strict=True)))
    return Result(
        messages, size, _way(messages, columns), decoder_way, _way(messages, alone),
        (calibration[0], calibration[1]),
    )


def _time(work: Callable[[Path], object], path: Path) -> tuple[float, float]:
    wall, cpu = time.perf_counter(), time.process_time()
    work(path)
    return time.perf_counter() - wall, time.process_time() - cpu


def _way(messages: int, times: tuple[float, ...]) -> Way:
    return Way(rate=messages / times[1], wall_rate=messages / times[0])


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


def calibrate(path: Path) -> None:
    """Do a fixed piece of work."""
    numbers = np.random.default_rng(0).random(20_000)
    for _ in range(CALIBRATION):
        np.sort(numbers)


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
    return [encode(row.type, _value(row, cycle * PERIOD, iter(random.normal(size=24).tolist()))) for row in rows]


def _value(row: Topic, stamp: int, numbers: Iterator[float]) -> Any:
    def take(count: int) -> tuple[float, ...]:
        return tuple(islice(numbers, count))

    kind = VALUE_TYPES[row.type]
    if kind is Clock:
        return Clock(stamp)
    if kind is Step:
        return Step(stamp, CYCLES * PERIOD, ('driver/icr', 'driver/speed'))
    if kind is Joints:
        names = _joints(row.name)
        size = len(names)
        return Joints(stamp, names, take(size), take(size), take(size), row.frame)
    if kind is Forces:
        return Forces(stamp, WHEELS, tuple((next(numbers), next(numbers), next(numbers)) for _ in WHEELS))
    return {Odometry: Odometry, Imu: Imu, Twist: Twist}[kind](stamp, *take(3 if kind is Twist else 6))


def _joints(topic: str) -> tuple[str, ...]:
    wheel = topic.partition('/')[0]
    if wheel in WHEELS:
        return f'{wheel}_steer', f'{wheel}_drive'
    if topic.startswith('tyres'):
        return WHEELS
    return tuple(f'{one}_{kind}' for kind in ('steer', 'drive') for one in WHEELS)
