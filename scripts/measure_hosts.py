#!/usr/bin/env python3
"""Drive a vehicle on seven hosts over networks that lose, delay and break, and write the figures of docs/hosts.md.

Needs root, and a quarter of an hour; control periods [ms] can be given: ``measure_hosts.py 20``.
"""

import os
import sys
from pathlib import Path

from omni_vehicle_ros.bench.frame import machine
from omni_vehicle_ros.bench.hosts.cases import CASES, SPEED, Case, Outcome, drive
from omni_vehicle_ros.bench.hosts.network import refusal
from omni_vehicle_ros.errors import RunError

PAGE = Path(__file__).resolve().parents[1] / 'docs' / 'hosts.md'
PERIODS = 50.0, 20.0
"""Each has its marks in the page [ms]."""
HEAD = (
    '| what the network does | cycles | missed | answer p50, p99 [ms] | off the path [m] | passive wheels | at the end '
    '| ICR steering says |\n| --- | --- | --- | --- | --- | --- | --- | --- |'
)
STANDS = 0.05


def main() -> None:
    """Measure at each control period, and put its table between its marks in the page."""
    why = refusal()
    if why:
        print(f'error: {why}', file=sys.stderr)
        sys.exit(2)
    for period in map(float, sys.argv[1:] or PERIODS):
        _replace(f'{period:g} ms', figures(period))


def _replace(name: str, text: str) -> None:
    begin, end = f'<!-- {name}: begin -->', f'<!-- {name}: end -->'
    before, _, rest = PAGE.read_text(encoding='utf-8').partition(begin)
    PAGE.write_text(f'{before}{begin}\n{text}\n{end}{rest.partition(end)[2]}', encoding='utf-8')


def figures(period: float) -> str:
    """Return a heading, the machine and a table for a control period [ms]."""
    rows, loads = [], []
    for case in CASES:
        loads.append(os.getloadavg()[0])
        try:
            rows.append(row(case, drive(case, 1e-3 * period)))
        except RunError as error:
            rows.append(f'| {case.name} | | | | | | no drive | {error} |')
        print(f'{period:g} ms: {rows[-1]}', flush=True)
    found = machine()
    words = (
        f'{found["processor"]}, {found["cores"]} cores, {found["system"]}; before the drives {min(loads):.1f} to '
        f'{max(loads):.1f} processes of others and our own wanted a core (load average).'
    )
    return '\n\n'.join([f'### {period:g} ms', words, '\n'.join([HEAD, *rows])])


def row(case: Case, outcome: Outcome) -> str:
    """Return a line of a table."""
    punctual = outcome.punctual
    answer = punctual.get('answer')
    times = f'{1e3 * answer["p50"]:.1f}, {1e3 * answer["p99"]:.1f}' if answer else 'none'
    share = punctual['missed'] / max(punctual['cycles'], 1)
    passive = ', '.join(outcome.passive) or 'none'
    end = 'stands' if outcome.speed < STANDS else f'{outcome.speed:.2f} of {SPEED:g} m/s'
    cells = (
        case.name, f'{punctual["cycles"]}', f'{punctual["missed"]} ({share:.0%})', times, f'{outcome.deviation:.3f}',
        passive, end, outcome.said.replace('|', '/'),
    )
    return f'| {" | ".join(cells)} |'


if __name__ == '__main__':
    main()
