"""A small campaign, with real graphs."""

import csv

import pytest

from .conftest import Lab

pytestmark = pytest.mark.graph


def test_a_campaign_leaves_a_verdict_on_each_drive_and_no_process(lab: Lab) -> None:
    """Whatever the verdicts are: the exit code is that of the table, and what passed leaves no directory."""
    command = lab.command('campaign', '--runs', '6', '--mode', 'offline', '--jobs', '2', '--out', 'found')
    out, errors = command.communicate(timeout=240.0)
    with (lab.path / 'found' / 'runs.csv').open() as file:
        rows = list(csv.DictReader(file))
    assert [row['run'] for row in rows] == list('123456')
    assert not [row for row in rows if row['failures']], rows
    failed = [row['run'] for row in rows if row['passed'] != 'True']
    assert command.returncode == (2 if failed else 0), errors
    assert f'{6 - len(failed)} of 6 drives passed' in out
    kept = {path.name for path in (lab.path / 'found').iterdir() if path.is_dir()}
    assert kept == {f'run_{int(number):04}' for number in failed}
