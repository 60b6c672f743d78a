"""The verdict on one drive of a campaign."""

import re
from typing import NamedTuple

from omni_vehicle_ros.analysis.troubles import Trouble, troubles
from omni_vehicle_ros.bags import open_bag, read_messages
from omni_vehicle_ros.campaign.checks import incomplete, named_after, not_finite, steering_excess
from omni_vehicle_ros.campaign.draw import Drive
from omni_vehicle_ros.campaign.effect import has_effect
from omni_vehicle_ros.campaign.trial import LIMIT, Trial
from omni_vehicle_ros.errors import OmniVehicleError
from omni_vehicle_ros.scenarios import FaultEvent

LOST = re.compile(r'(\d+) messages, (\d+) lost')


class Finding(NamedTuple):
    """What came of a fault.

    Attributes
    ----------
    event
        The fault.
    after
        Time from its begin to the diagnostic that names it [s]; None: none does.
    acts
        Whether it has an effect, by `has_effect`; taken for granted of what a diagnostic names.
    """

    event: FaultEvent
    after: float | None
    acts: bool = True

    @property
    def unnamed(self) -> bool:
        """Whether it has an effect and no diagnostic names it."""
        return self.after is None and self.acts


class Verdict(NamedTuple):
    """What came of a drive.

    Attributes
    ----------
    drive
        Which one.
    wall
        Time that it took [s].
    failures
        A line for each check that it did not pass.
    findings
        For each fault, in the order of the scenario; none of a drive that came to a bad end.
    """

    drive: Drive
    wall: float
    failures: tuple[str, ...]
    findings: tuple[Finding, ...]

    @property
    def passed(self) -> bool:
        """Whether nothing is to be said against it."""
        return not self.failures and not any(finding.unnamed for finding in self.findings)


def judge(drive: Drive, trial: Trial) -> Verdict:
    """Check how a drive ended, what it recorded, and whether its faults were found."""
    failures, findings = _end_failures(trial), []
    if trial.code == 0:
        path = trial.directory / 'bag'
        try:
            bag = open_bag(path)
            failures += incomplete(bag, drive.scenario)
            failures += not_finite(read_messages(path))
            failures += steering_excess(bag, drive.scenario)
            findings = _findings(drive, troubles(bag))
        except OmniVehicleError as error:
            failures.append(f'bag: {error}')
    return Verdict(drive, trial.wall, tuple(failures), tuple(findings))


def _findings(drive: Drive, found: list[Trouble]) -> list[Finding]:
    findings = []
    for event in drive.scenario.faults:
        after = named_after(event, drive.scenario.faults, found)
        findings.append(Finding(event, after, after is not None or has_effect(drive.scenario, event)))
    return findings


def _end_failures(trial: Trial) -> list[str]:
    """Return what is wrong with the end of a drive."""
    found: list[str] = []
    if trial.code is None:
        found.append(f'hangs: not over after {LIMIT:g} s')
    elif trial.code != 0:
        lines = [line for line in trial.said.splitlines() if line.startswith('error:')]
        found.append(f'exit code {trial.code}: {lines[-1] if lines else "without a reason"}')
    if 'Traceback' in trial.said:
        found.append('a traceback in its output or the logs of its nodes')
    if trial.left:
        found.append(f'{len(trial.left)} processes left')
    if trial.segments:
        found.append(f'{len(trial.segments)} segments of shared memory left')
    lost = LOST.search(trial.said)
    if lost and int(lost[2]):
        found.append(f'{lost[2]} messages lost')
    return found
