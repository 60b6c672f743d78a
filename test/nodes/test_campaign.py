"""A small campaign, with real graphs."""

import csv

import pytest

from .conftest import Lab, finish

pytestmark = pytest.mark.graph


def test_a_campaign_leaves_a_verdict_on_each_drive_and_goes_on_with_what_is_there(lab: Lab) -> None:
    """The first two drives, of shipped faults, pass; what passed leaves no directory, and is not driven again."""
    for runs, said in ('1', '1 of 1 drives passed'), ('2', '2 of 2 drives passed'):
        out, _ = finish(lab.command('campaign', '--runs', runs, '--mode', 'offline', '--out', 'found'))
        assert said in out
    with (lab.path / 'found' / 'runs.csv').open() as file:
        assert [(row['run'], row['failures']) for row in csv.DictReader(file)] == [('1', ''), ('2', '')]
    assert {path.name for path in (lab.path / 'found').iterdir()} == {'runs.csv', 'runs.json', 'campaign.md'}
    _, errors = finish(lab.command('campaign', '--mode', 'offline', '--seed', '1', '--out', 'found'), 2)
    assert errors == 'error: found: holds a campaign with seed 0, not 1; name another directory\n'
