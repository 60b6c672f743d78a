#!/usr/bin/env python3
"""Measure a part of docs/load.md and write its figures: ``measure_load.py processes|one-process|floods|huge|hour``."""

import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterable
from pathlib import Path

from omni_vehicle_ros.bench.fleet import Crowd
from omni_vehicle_ros.bench.fleet import drive as drive_fleet
from omni_vehicle_ros.bench.footprint import footprint
from omni_vehicle_ros.bench.frame import machine
from omni_vehicle_ros.bench.long_drive import LongDrive
from omni_vehicle_ros.bench.long_drive import drive as drive_long
from omni_vehicle_ros.errors import RunError
from omni_vehicle_ros.interface import DRIVER, ICR_STEERING, NODES, RECORDER
from omni_vehicle_ros.network import DISCOVERY_RANGE

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / 'docs' / 'load.md'
FLOODING = ROOT / 'test' / 'nodes' / 'flooding.py'

FLEETS = 1, 2, 5, 10
SPAN = 20.0
"""How long vehicles are watched [s]."""
HOUR, LOOK = 3600.0, 60.0
"""How long the long drive is, and from one look at it to the next; simulated [s]."""
SHOWN = 300.0
MB = 1e6
REST = 10.0
"""How long a vehicle is left alone [s]."""
NODES_OF_START = tuple(role for role in NODES if role != DRIVER)


def table(head: str, rows: Iterable[Iterable[object]]) -> str:
    """Return a table of Markdown."""
    lines = [head, '| --- ' * (head.count('|') - 1) + '|']
    return '\n'.join([*lines, *(f'| {" | ".join(map(str, row))} |' for row in rows)])


def fleets(one_process: bool) -> str:
    """Drive fleets one after the other; return their table."""
    if not one_process:  # by LOCALHOST no more than 32 processes of a machine find each other
        os.environ.setdefault(DISCOVERY_RANGE, 'SUBNET')
    rows = []
    for count in FLEETS:
        try:
            found = drive_fleet(count, SPAN, one_process=one_process)
        except RunError as error:
            rows.append((count, f'not measured: {error}', '', '', '', '', ''))
            continue
        cycles, missed, said = (sum(vehicle[i] for vehicle in found) for i in (3, 4, 5))
        rates = [vehicle.rate for vehicle in found]
        rows.append((
            count, f'{min(rates):.3f} .. {max(rates):.3f}', f'{cycles:,}', f'{missed:,} ({missed / cycles:.1%})',
            f'{said:,}', f'{sum(vehicle.cpu for vehicle in found):.2f}',
            f'{sum(vehicle.memory for vehicle in found) / count / MB:.0f}',
        ))
        print(rows[-1], flush=True)
    return table(
        '| vehicles | simulated over wall time | cycles | missed | said | cores | MB a vehicle |', rows
    )


def floods(parts: Iterable[tuple[str, list[str]]]) -> str:
    """Flood a vehicle in real time, in processes, with each part in turn; return their table."""
    with Crowd([''], NODES_OF_START, one_process=False) as crowd:
        rows = []
        for name, arguments in parts:
            rows.append((name, *flooded(crowd, arguments)))
            print(rows[-1], flush=True)
    return table(
        '| flood | messages | simulated over wall time | missed and said | MB, all | ICR steering | recorder |', rows
    )


def flooded(crowd: Crowd, arguments: list[str]) -> tuple[object, ...]:
    """Flood a vehicle, or leave it alone for a while without arguments; return the cells of a row."""
    (plant,), times, said = crowd.plants, dict(crowd.ear.times), crowd.ear.said.copy()
    sent = flood(crowd, arguments) if arguments else crowd.watch(REST) or ''
    crowd.watch(1.0)
    (rate,) = crowd.rates(times)
    sizes = {role: footprint(number).own / MB for role, number in crowd.graphs[0].processes.numbers().items()}
    held = sum(sizes.values()), sizes[ICR_STEERING], sizes[RECORDER]
    return sent, f'{rate:.3f}', crowd.ear.said[plant] - said[plant], *(f'{size:.1f}' for size in held)


def flood(crowd: Crowd, arguments: list[str]) -> str:
    """Let the flooder run to its end; return how many messages it sent."""
    with tempfile.TemporaryFile('w+') as out:
        process = subprocess.Popen(
            [sys.executable, '-W', 'ignore', str(FLOODING), *arguments], stdout=out, stderr=subprocess.DEVNULL
        )
        try:
            while process.poll() is None:
                crowd.watch(0.2)
        finally:
            process.kill()
            process.wait()
        out.seek(0)
        sent, rate = map(int, out.read().split()[-2:])
    return f'{sent:,} ({rate:,}/s)'


def hour() -> str:
    """Drive for an hour of simulated time; return its table."""
    return hour_table(drive_long(HOUR, LOOK, lambda done: print(f'{done:.1%}', end='\r', flush=True)))


def hour_table(found: LongDrive) -> str:
    """Return the table of a long drive, and in words how it ended."""
    rows, due = [], 0.0
    for simulated, wall, held, recorded in found.samples:
        if simulated >= due or simulated == found.samples[-1].simulated:
            due += SHOWN
            rows.append((
                f'{simulated:.0f}', f'{wall:.0f}', f'{held.own / MB:.1f}', f'{held.resident / MB:.1f}', held.files,
                held.threads, held.segments, f'{recorded / MB:.0f}',
            ))
    words = f'{found.messages:,} messages recorded, {found.lost} lost.'
    head = '| simulated [s] | wall [s] | own MB | resident MB | files | threads | shared memory | bag MB |'
    return f'{table(head, rows)}\n\n{words}'


PARTS: dict[str, Callable[[], str]] = {
    'processes': lambda: fleets(one_process=False),
    'one-process': lambda: fleets(one_process=True),
    'floods': lambda: floods([
        ('none', []), ('commands', ['commands', '10000', '10']), ('garbage', ['garbage', '10']),
        ('garbage', ['garbage', '10']), ('garbage', ['garbage', '10']), ('strangers', ['strangers']), ('none', []),
    ]),
    'huge': lambda: floods([('none', []), *([('huge', ['huge', '2'])] * 3), ('none', [])]),
    'hour': hour,
}


def main() -> None:
    """Measure a part and put its figures between its marks in the page."""
    name = sys.argv[1]
    found = PARTS[name]()
    print(found, flush=True)
    begin, end = f'<!-- {name}: begin -->', f'<!-- {name}: end -->'
    before, _, rest = PAGE.read_text(encoding='utf-8').partition(begin)
    _, _, after = rest.partition(end)
    facts = machine()
    words = f'{facts["processor"]}, {facts["cores"]} cores, Python {facts["python"]}.'
    PAGE.write_text(f'{before}{begin}\n{found}\n\n{words}\n{end}{after}', encoding='utf-8')


if __name__ == '__main__':
    main()
