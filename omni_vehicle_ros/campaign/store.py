"""What a campaign was asked for and what it found: it lies in its directory, and the command can go on with it."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from omni_vehicle_ros import __version__
from omni_vehicle_ros.campaign.draw import Drive
from omni_vehicle_ros.campaign.judge import Finding, Verdict
from omni_vehicle_ros.errors import RunError
from omni_vehicle_ros.scenarios import FaultEvent

FILE = 'runs.json'


class Request(NamedTuple):
    """What a campaign is asked for.

    Attributes
    ----------
    runs, seed, mode
        As of `omni_vehicle_ros.campaign.draw.draw`.
    jobs
        How many drives at a time.
    domain
        The first of as many ROS domains as there are jobs.
    """

    runs: int
    seed: int
    mode: str
    jobs: int
    domain: int


class Campaign(NamedTuple):
    """A campaign until now.

    Attributes
    ----------
    request
        What it was asked for.
    wall
        Time that it took [s].
    verdicts
        On its drives, in their order.
    """

    request: Request
    wall: float
    verdicts: Sequence[Verdict]


def write(campaign: Campaign, directory: Path) -> None:
    """Write all of a campaign; what was there before stays whole if this is cut off."""
    rows = [row(verdict) for verdict in campaign.verdicts]
    entries = {**_asked(campaign.request), 'wall': round(campaign.wall, 1), 'runs': rows}
    unfinished = directory / f'.unfinished-{FILE}'
    unfinished.write_text(json.dumps(entries, indent=1, allow_nan=False) + '\n', encoding='utf-8')
    unfinished.replace(directory / FILE)


def read_before(directory: Path, request: Request, drives: Sequence[Drive]) -> Campaign:
    """Return what of a campaign is in a directory; nothing is in a new one.

    Raises
    ------
    RunError
        There is something else in it.
    """
    if not directory.exists():
        return Campaign(request, 0.0, ())
    try:
        found = json.loads((directory / FILE).read_text(encoding='utf-8'))
    except OSError:
        raise RunError(f'{directory}: exists already and holds no campaign; name another directory') from None
    for key, value in _asked(request).items():
        if found[key] != value:
            held = f'{key} {found[key]}, not {value}'
            raise RunError(f'{directory}: holds a campaign with {held}; name another directory')
    rows = {entries['run']: entries for entries in found['runs']}
    verdicts = [verdict(drive, rows[drive.number]) for drive in drives if drive.number in rows]
    return Campaign(request, found['wall'], verdicts)


def _asked(request: Request) -> dict[str, Any]:
    return {'seed': request.seed, 'mode': request.mode, 'version': __version__}


def row(verdict: Verdict) -> dict[str, Any]:
    """Return what there is to say about one drive."""
    drive, findings = verdict.drive, verdict.findings
    return {
        'run': drive.number,
        'mode': drive.mode,
        'manoeuvre': drive.manoeuvre,
        'duration': drive.scenario.duration,
        'reaction': drive.scenario.steering.fault_reaction,
        'faults': list(map(fault_words, drive.scenario.faults)),
        'wall': round(verdict.wall, 2),
        'passed': verdict.passed,
        'failures': list(verdict.failures),
        'named_after': [None if finding.after is None else round(finding.after, 3) for finding in findings],
        'without_effect': [not finding.acts for finding in findings],
    }


def verdict(drive: Drive, entries: dict[str, Any]) -> Verdict:
    """Return the verdict on a drive of which `row` has made ``entries``."""
    seen = zip(entries['named_after'], entries['without_effect'], strict=True)
    events = drive.scenario.faults
    findings = tuple(Finding(event, after, not idle) for event, (after, idle) in zip(events, seen, strict=False))
    return Verdict(drive, entries['wall'], tuple(entries['failures']), findings)


def fault_words(event: FaultEvent) -> str:
    """Return a fault in words."""
    lasting = '' if event.lasting is None else f' for {event.lasting:g} s'
    return f'{event.fault.component} {event.fault.words} at {event.at:g} s{lasting}'
