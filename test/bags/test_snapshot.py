"""A ring buffer of messages: what it keeps, and what it writes when asked."""

import itertools

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rosbags.highlevel import AnyReader

from omni_vehicle_ros import interface, messages
from omni_vehicle_ros.bags import read_messages
from omni_vehicle_ros.bags.snapshot import OVERHEAD, PORTION, SnapshotBuffer
from omni_vehicle_ros.errors import BagError

CLOCK = interface.topic('/clock')
SECOND = 1_000_000_000


def clock(number):
    return messages.encode(CLOCK.type, messages.Clock(number))


def filled(directory, count, step, *, size=10**9, span=10**18, **options):
    buffer = SnapshotBuffer(directory, size, span, **options)
    buffer.add_topic(CLOCK.name, CLOCK.type, CLOCK.qos)
    for number in range(count):
        buffer.write(CLOCK.name, clock(number), number * step)
    return buffer


def test_what_is_older_than_the_span_is_dropped(tmp_path):
    buffer = filled(tmp_path / 'bag', 1000, SECOND // 10, span=5 * SECOND)
    assert len(buffer) == 51
    assert buffer.take() == f'51 messages of 5.000 s in {tmp_path / "bag" / "snapshot_0"}'
    assert next(iter(read_messages(tmp_path / 'bag' / 'snapshot_0'))).log_time == 949 * SECOND // 10


@settings(deadline=None)
@given(st.lists(st.integers(0, 3000), max_size=60), st.integers(1, 20_000))
def test_no_more_is_kept_than_the_limit_and_the_latest_are(tmp_path_factory, sizes, limit):
    buffer = SnapshotBuffer(tmp_path_factory.mktemp('ring') / 'bag', limit, 10**18)
    for number, size in enumerate(sizes):
        buffer.write('/a', bytes(size), number)
    fitting = [size + OVERHEAD for size in sizes if size + OVERHEAD <= limit]
    kept = fitting[len(fitting) - len(buffer) :]
    assert sum(kept) <= limit
    if len(kept) < len(fitting):
        assert sum(kept) + fitting[len(fitting) - len(kept) - 1] > limit


def test_a_message_that_is_too_large_takes_the_place_of_no_other(tmp_path):
    buffer = filled(tmp_path / 'bag', 5, 1, size=5000)
    buffer.write(CLOCK.name, bytes(5000), 5)
    assert len(buffer) == 5
    assert buffer.take().endswith('/snapshot_0; 1 so far were too large for snapshot_size, 5000 B')


def test_snapshots_are_bags_and_follow_each_other(tmp_path):
    buffer = filled(tmp_path / 'bag', 30, 1)
    buffer.take()
    buffer.write(CLOCK.name, clock(30), 30)
    buffer.take()
    assert buffer.count == 30 + 31
    for number, count in enumerate((30, 31)):
        with AnyReader([tmp_path / 'bag' / f'snapshot_{number}']) as reader:
            assert reader.message_count == count


def test_nothing_kept_makes_an_empty_bag(tmp_path):
    assert filled(tmp_path / 'bag', 0, 1).take().startswith('0 messages of 0.000 s in ')
    with AnyReader([tmp_path / 'bag' / 'snapshot_0']) as reader:
        assert reader.message_count == 0


def test_a_directory_that_exists_is_refused(tmp_path):
    with pytest.raises(BagError, match='exists; name a directory that does not'):
        SnapshotBuffer(tmp_path, 1, 1)


def test_what_comes_while_a_snapshot_is_written_is_kept_for_the_next(tmp_path):
    buffer = filled(tmp_path / 'bag', 3 * PORTION, 1)
    numbers = itertools.count(3 * PORTION)

    def meanwhile():
        buffer.write(CLOCK.name, clock(0), next(numbers))

    assert buffer.take(meanwhile).startswith(f'{3 * PORTION} messages')
    assert buffer.take().startswith(f'{3 * PORTION + 3} messages')
