"""What a campaign leaves: a table of its drives as CSV and JSON, and a page that sums them up."""

import csv
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from statistics import median
from typing import Any

from omni_vehicle_ros import __version__
from omni_vehicle_ros.campaign.effect import ANGLE, PLACE, SPEED
from omni_vehicle_ros.campaign.judge import Finding, Verdict
from omni_vehicle_ros.campaign.store import Campaign, fault_words, row, write
from omni_vehicle_ros.faults import KINDS, kind_of
from omni_vehicle_ros.scenarios import FaultEvent

PAGE = 'campaign.md'


def write_tables(campaign: Campaign, directory: Path) -> None:
    """Write ``runs.csv``, ``runs.json`` and `PAGE`; the same again with each drive more."""
    write(campaign, directory)
    rows = [row(verdict) for verdict in campaign.verdicts]
    with (directory / 'runs.csv').open('w', encoding='utf-8', newline='') as file:
        writer = csv.DictWriter(file, rows[0])
        writer.writeheader()
        for entries in rows:
            writer.writerow({key: _cell(value) for key, value in entries.items()})
    (directory / PAGE).write_text(page(campaign), encoding='utf-8')


def _cell(value: Any) -> Any:
    return '; '.join('-' if entry is None else str(entry) for entry in value) if isinstance(value, list) else value


def page(campaign: Campaign) -> str:
    """Return the summary of a campaign as Markdown."""
    (asked, seed, mode, _, _), wall, verdicts = campaign
    modes = Counter(verdict.drive.mode for verdict in verdicts)
    broken = [f'{_name(v)}: {"; ".join(v.failures)}; {_faults(v)}' for v in verdicts if v.failures]
    silent = [
        f'{_name(verdict)}: {fault_words(finding.event)}; of {_faults(verdict)}'
        for verdict in verdicts
        for finding in verdict.findings
        if finding.unnamed
    ]
    command = f'omni_vehicle campaign --runs {asked} --seed {seed} --mode {mode}'
    lines = [
        '# Campaign of faults', '',
        f'Written by `{command}`, version {__version__}' + _so_far(len(verdicts), asked), '',
        f'{len(verdicts)} drives ({", ".join(f"{count} {name}" for name, count in sorted(modes.items()))}) in '
        f'{wall / 60.0:.1f} min. {len(verdicts) - len(broken)} passed the checks of the end and of the bag: exit code '
        '0, no traceback, no hang, no process and no segment of shared memory left, bag complete, no message lost, no '
        'number that is not finite, steer angles within range and rate.', '',
        _found([finding for verdict in verdicts for finding in verdict.findings]), '',
        *_by_failure(verdicts), '',
        '## Drives that failed', '', *_points(broken), '',
        '## Faults with an effect that no diagnostic named', '', *_points(silent),
    ]  # fmt: skip
    return '\n'.join(lines) + '\n'


def _so_far(done: int, asked: int) -> str:
    return '.' if done == asked else f': the {done} drives that were over when it was last written.'


def _found(findings: Sequence[Finding]) -> str:
    named, unnamed = (sum(f.after is not None for f in findings), sum(f.unnamed for f in findings))
    return (
        f'Of {len(findings)} faults in drives with a bag {named} were named by a diagnostic within the drive, '
        f'{unnamed} had an effect and were not, and {len(findings) - named - unnamed} were not and had none: the true '
        f'motion of the same drive with that fault alone, offline, stays within {PLACE:g} m, {SPEED:g} m/s and '
        f'{ANGLE:g} rad of that without faults. A diagnostic names a component if it has the name of its wheel, or of '
        'its topic or node, and was not said before the fault. What a drive with two faults says of a wheel counts '
        'for both, if both are of that wheel.'
    )


def _points(lines: Sequence[str]) -> list[str]:
    return [f'- {line}' for line in lines] or ['None.']


def _name(verdict: Verdict) -> str:
    return f'run {verdict.drive.number} ({verdict.drive.mode})'


def _faults(verdict: Verdict) -> str:
    return f'{verdict.drive.manoeuvre}: {", ".join(map(fault_words, verdict.drive.scenario.faults))}'


def _by_failure(verdicts: Sequence[Verdict]) -> list[str]:
    """Return a table: what came of the faults of each kind and failure."""
    lines = [
        '| component | failure | faults | named | median time [s] | not named | without effect |',
        '| --- | --- | --- | --- | --- | --- | --- |',
    ]
    findings = [finding for verdict in verdicts for finding in verdict.findings]
    for kind, failures in KINDS.items():
        for failure in failures:
            found = [one for one in findings if _sort(one.event) == (kind, failure)]
            if found:
                lines.append(f'| {kind} | {failure} | {_cells(found)} |')
    return lines


def _sort(event: FaultEvent) -> tuple[str, str]:
    return kind_of(event.fault.component), event.fault.failure


def _cells(found: Sequence[Finding]) -> str:
    times = [finding.after for finding in found if finding.after is not None]
    unnamed = sum(finding.unnamed for finding in found)
    middle = f'{median(times):.2f}' if times else '-'
    return f'{len(found)} | {len(times)} | {middle} | {unnamed} | {len(found) - len(times) - unnamed}'
