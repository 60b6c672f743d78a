"""Items of an iterator that runs in another thread."""

import threading
from collections.abc import Iterator

import pytest

from omni_vehicle_ros.bags.columns.read_ahead import MOST, read_ahead


def others() -> list[str]:
    return [thread.name for thread in threading.enumerate() if thread.name == 'read_ahead']


def test_all_items_in_their_order() -> None:
    assert list(read_ahead(iter(range(10 * MOST)))) == list(range(10 * MOST))
    assert list(read_ahead(iter(()))) == []
    assert not others()


def test_an_error_comes_after_the_items_before_it() -> None:
    def items() -> Iterator[int]:
        yield from range(3)
        raise ValueError('here')

    found = []
    with pytest.raises(ValueError, match='here'):
        for item in read_ahead(items()):
            found.append(item)
    assert found == [0, 1, 2]
    assert not others()


def test_it_goes_no_farther_ahead_than_it_may_and_ends_when_closed() -> None:
    begun = []

    def items() -> Iterator[int]:
        for number in range(1000):
            begun.append(number)
            yield number

    given = read_ahead(items())
    assert next(given) == 0
    given.close()  # type: ignore[attr-defined]
    assert not others()
    assert len(begun) <= MOST + 2
