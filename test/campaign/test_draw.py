"""Which drives a campaign draws."""

from hypothesis import given, settings
from hypothesis import strategies as st

from omni_vehicle_ros.campaign.draw import DURATIONS, WATCHED, draw
from omni_vehicle_ros.checks import check_commands, check_loop
from omni_vehicle_ros.faults import KINDS, PROCESSES, kind_of
from omni_vehicle_ros.scenarios import scenario_names

SHIPPED = [name for name in scenario_names() if name.startswith('faults/')]
MOST = len(SHIPPED) + 12


@settings(deadline=None, max_examples=10)
@given(st.integers(0, 10**9))
def test_pairs_are_drives_that_a_vehicle_can_make(seed: int) -> None:
    """Two faults of different components, early enough to be seen; no command that would be refused."""
    for drive in draw(MOST, seed, 'mixed')[len(SHIPPED) :]:
        scenario = drive.scenario
        assert scenario.duration in DURATIONS
        assert len({event.fault.component for event in scenario.faults}) == 2
        assert all(0.5 <= event.at <= scenario.duration - WATCHED for event in scenario.faults)
        check_commands(scenario)
        check_loop(scenario)
        if any(event.fault.component in PROCESSES for event in scenario.faults):
            assert drive.mode == 'processes'


def test_every_shipped_fault_is_driven_alone_first() -> None:
    drives = draw(len(SHIPPED), 3, 'offline')
    assert [drive.manoeuvre for drive in drives] == SHIPPED
    assert {drive.mode for drive in drives} == {'offline'}
    assert max(event.at for drive in drives for event in drive.scenario.faults[:1]) < 3.0


def test_a_longer_campaign_begins_with_the_shorter_one() -> None:
    assert draw(MOST, 5, 'mixed')[:MOST - 4] == draw(MOST - 4, 5, 'mixed')
    assert draw(MOST, 5, 'mixed')[-1] != draw(MOST, 6, 'mixed')[-1]


def test_200_drives_have_each_kind_with_each_failure() -> None:
    events = [event for drive in draw(200, 0, 'mixed') for event in drive.scenario.faults]
    found = {(kind_of(event.fault.component), event.fault.failure) for event in events}
    assert found == {(kind, failure) for kind, failures in KINDS.items() for failure in failures}
