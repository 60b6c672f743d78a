#!/usr/bin/env python3
"""Write the figures of docs/performance.md from results: ``omni_vehicle bench --json FILE``, then this with FILE."""

import json
import sys
from pathlib import Path
from typing import Any

PAGE = Path(__file__).resolve().parents[1] / 'docs' / 'performance.md'
BEGIN, END = '<!-- figures: begin -->', '<!-- figures: end -->'
HEAD = '| line | ours | bare limit | ratio | goal | |\n| --- | --- | --- | --- | --- | --- |'
VERDICTS = {True: 'met', False: 'missed', None: ''}


def main() -> None:
    """Put the tables of a file of results between the marks of the page."""
    results = json.loads(Path(sys.argv[1]).read_text(encoding='utf-8'))
    before, _, rest = PAGE.read_text(encoding='utf-8').partition(BEGIN)
    _, _, after = rest.partition(END)
    PAGE.write_text(f'{before}{BEGIN}\n{figures(results)}\n{END}{after}', encoding='utf-8')


def figures(results: dict[str, Any]) -> str:
    """Return the machine and a table for each benchmark."""
    machine = results.pop('machine')
    words = f'{machine["processor"]}, {machine["cores"]} cores, {machine["system"]}, Python {machine["python"]}.'
    return '\n\n'.join([words, *(table(name, result) for name, result in results.items())])


def table(name: str, result: dict[str, Any]) -> str:
    """Return the table of a benchmark."""
    calibration = result['calibration']
    machine = (
        f'Calibration: {calibration["wall"] * 1e3:.1f} ms wall, {calibration["cpu"] * 1e3:.1f} ms CPU, '
        f'wall/CPU {calibration["wall_per_cpu"]:.2f}.'
    )
    rows = '\n'.join(map(row, result['lines']))
    return '\n\n'.join([f'### {name}', *result['notes'], f'{HEAD}\n{rows}', machine])


def row(line: dict[str, Any]) -> str:
    """Return a line of a table."""
    ours = 'not measured' if line['ours'] is None else f'{number(line["ours"])} {line["unit"]}'
    limit = 'not measured' if line['limit'] is None else number(line['limit'])
    name = line['name'] + (f' ({line["note"]})' if line['note'] else '')
    ratio = '' if line['ratio'] is None else number(line['ratio'])
    bare = f'{line["against"]}: {limit}' if line['against'] else ''
    return f'| {name} | {ours} | {bare} | {ratio} | {line["goal"] or ""} | {VERDICTS[line["met"]]} |'


def number(value: float) -> str:
    """Return a number with three digits or more."""
    return f'{value:,.0f}' if abs(value) >= 1000.0 else f'{value:.3g}'


if __name__ == '__main__':
    main()
