"""The environment of a node is what the user has made it, and ours where he has not."""

import os
from pathlib import Path

import pytest

from omni_vehicle_ros.network import (
    DISCOVERY_RANGE,
    PROFILE,
    QOS_FROM_PROFILE,
    network_environment,
    profile_environment,
)


@pytest.fixture(autouse=True)
def _nothing_chosen(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in (DISCOVERY_RANGE, PROFILE, QOS_FROM_PROFILE):
        monkeypatch.delenv(name, raising=False)


def test_who_chooses_nothing_gets_our_profile_and_this_machine() -> None:
    found = network_environment()
    assert Path(found[PROFILE]).is_file()
    assert (found[QOS_FROM_PROFILE], found[DISCOVERY_RANGE]) == ('1', 'LOCALHOST')
    assert DISCOVERY_RANGE not in profile_environment()


@pytest.mark.parametrize('name', [PROFILE, QOS_FROM_PROFILE])
def test_who_has_chosen_how_fast_dds_works_keeps_that(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """One of both without the other would mean something else."""
    monkeypatch.setenv(name, '0')
    assert profile_environment() == {}
    assert {key: network_environment().get(key) for key in (PROFILE, QOS_FROM_PROFILE)} == {
        PROFILE: os.environ.get(PROFILE), QOS_FROM_PROFILE: os.environ.get(QOS_FROM_PROFILE)
    }


def test_who_has_chosen_a_range_keeps_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(DISCOVERY_RANGE, 'SUBNET')
    assert network_environment()[DISCOVERY_RANGE] == 'SUBNET'
