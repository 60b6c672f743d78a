"""Segments of shared memory: the owner's are found, and removed when it has gone."""

import os

from omni_vehicle_ros.shared_memory import FOLDER, LOCK, existing, remove, segments_of


def test_what_an_owner_holds_open_is_found_and_can_be_removed() -> None:
    name = f'fastrtps_{os.getpid():016x}'
    with (FOLDER / f'{name}{LOCK}').open('w'), (FOLDER / name).open('w'):
        assert segments_of(os.getpid()) == {name}
    assert segments_of(os.getpid()) == set()
    assert existing([name, 'fastrtps_none']) == [name]
    remove([name, 'fastrtps_none'])
    assert existing([name]) == []
    assert not (FOLDER / f'{name}{LOCK}').exists()


def test_a_process_that_has_ended_has_none() -> None:
    assert segments_of(2**22 + 1) == set()
