#!/usr/bin/env python3
"""Drive a vehicle on seven hosts over networks that lose, delay and break, and write the figures of docs/hosts.md.

Needs root, and a quarter of an hour. What is to be measured can be named: ``sound``, or control periods [ms] (20, 50).
"""

import math
import os
import sys
from pathlib import Path

from omni_vehicle_ros.bench.frame import machine
from omni_vehicle_ros.bench.hosts.cases import CASES, SPEED, Outcome, drive
from omni_vehicle_ros.bench.hosts.network import refusal
from omni_vehicle_ros.errors import RunError

PAGE = Path(__file__).resolve().parents[1] / 'docs' / 'hosts.md'
PERIODS = 5.0, 10.0, 20.0, 50.0
"""Of the sound network [ms]."""
PARTS = 'sound', '20', '50'
"""Each has its marks in the page."""
COLUMNS = 'missed', 'answer [ms]', 'off the path [m]', 'at the end', 'what was said'
STANDS = 0.05
"""A vehicle that is slower is said to stand [m/s]."""


def main() -> None:
    """Measure each part, and put its table between its marks in the page."""
    why = refusal()
    if why:
        print(f'error: {why}', file=sys.stderr)
        sys.exit(2)
    for part in sys.argv[1:] or PARTS:
        begin, end = f'<!-- {part}: begin -->', f'<!-- {part}: end -->'
        text = sound() if part == 'sound' else disturbed(float(part))
        before, _, rest = PAGE.read_text(encoding='utf-8').partition(begin)
        PAGE.write_text(f'{before}{begin}\n{text}\n{end}{rest.partition(end)[2]}', encoding='utf-8')


def sound() -> str:
    """Return which machine this is, and a table of drives without disturbance: a line for each period."""
    found, before = machine(), os.getloadavg()[0]
    lines = [head('control period', 'frames/s', 'switch')]
    for period in PERIODS:
        outcome = drive(CASES[0], 1e-3 * period)
        lines.append(line(f'{period:g} ms', f'{outcome.frames:.0f}', f'{outcome.load:.0%}', *cells(outcome)))
    words = (
        f'{found["processor"]}, {found["cores"]} cores, {found["system"]}; '
        f'load average before the first drive {before:.1f}.'
    )
    return '\n'.join([words, '', *lines])


def disturbed(period: float) -> str:
    """Return a table of all cases at a control period [ms]."""
    lines = [head('what the network does')]
    for case in CASES:
        try:
            lines.append(line(case.name, *cells(drive(case, 1e-3 * period))))
        except RunError as error:
            lines.append(line(case.name, *['']*3, 'no drive', str(error)))
    return '\n'.join([f'### {period:g} ms', '', *lines])


def head(*columns: str) -> str:
    """Return the first two lines of a table with some columns before those of `cells`."""
    columns = *columns, *COLUMNS
    return f'| {" | ".join(columns)} |\n|{" --- |" * len(columns)}'


def line(*values: str) -> str:
    """Return a line of a table, and print it."""
    text = f'| {" | ".join(values)} |'
    print(text, flush=True)
    return text


def cells(outcome: Outcome) -> tuple[str, ...]:
    """Return what came of a drive, for `COLUMNS`."""
    return (
        f'{outcome.missed / outcome.cycles:.1%}' if outcome.cycles else 'no cycles',
        'none' if math.isnan(outcome.answer) else f'{1e3 * outcome.answer:.1f}',
        f'{outcome.deviation:.3f}',
        'stands' if outcome.speed < STANDS else f'{outcome.speed:.2f} of {SPEED:g} m/s',
        '; '.join(f'`{text}`' for text in outcome.said) or 'nothing',
    )


if __name__ == '__main__':
    main()
