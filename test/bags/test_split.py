"""Bags of several files: each can be read alone, and metadata.yaml speaks of all."""

import resource

import pytest
import yaml
from mcap.reader import make_reader
from rosbags.highlevel import AnyReader

from omni_vehicle_ros import interface, messages
from omni_vehicle_ros.bags import BagWriter, read_messages
from omni_vehicle_ros.bags.mcap.file_writer import CHUNK_SIZE
from omni_vehicle_ros.bags.metadata import OfferedQos
from omni_vehicle_ros.errors import BagError

CLOCK = interface.topic('/clock')
ODOM = interface.topic('odom')
SECOND = 1_000_000_000


def write(directory, count, step, **options):
    with BagWriter(directory, **options) as writer:
        for row in (CLOCK, ODOM):
            writer.add_topic(interface.resolve(row.name, ''), row.type, row.qos)
        for number in range(count):
            writer.write(CLOCK.name, messages.encode(CLOCK.type, messages.Clock(number * step)), number * step)
    return directory


def information(bag):
    return yaml.safe_load((bag / 'metadata.yaml').read_text(encoding='utf-8'))['rosbag2_bagfile_information']


def times(path):
    return [message.log_time for message in read_messages(path)]


def test_a_file_ends_before_the_message_that_would_make_it_too_long(tmp_path):
    bag = write(tmp_path / 'bag', 1001, SECOND // 100, split_time=4 * SECOND)
    names = [f'bag_{number}.mcap' for number in range(3)]
    assert sorted(path.name for path in bag.glob('*.mcap')) == names
    spans = [times(bag / name) for name in names]
    assert [(span[0] / SECOND, span[-1] / SECOND) for span in spans] == [(0.0, 3.99), (4.0, 7.99), (8.0, 10.0)]
    assert times(bag) == [time for span in spans for time in span]


def test_metadata_speaks_of_all_files(tmp_path):
    bag = write(tmp_path / 'bag', 1001, SECOND // 100, split_time=4 * SECOND)
    found = information(bag)
    assert found['relative_file_paths'] == [entry['path'] for entry in found['files']]
    assert [entry['message_count'] for entry in found['files']] == [400, 400, 201]
    assert found['files'][1]['starting_time'] == {'nanoseconds_since_epoch': 4 * SECOND}
    assert found['files'][1]['duration'] == {'nanoseconds': 3990 * SECOND // 1000}
    assert (found['message_count'], found['duration']) == (1001, {'nanoseconds': 10 * SECOND})


@pytest.mark.parametrize('compression', ['none', 'lz4', 'zstd'])
def test_a_file_is_larger_than_the_limit_by_a_chunk_and_an_index_at_most(tmp_path, compression):
    limit = 100_000
    bag = write(tmp_path / 'bag', 40_000, 1_000_000, split_size=limit, compression=compression)
    files = sorted(bag.glob('*.mcap'), key=lambda path: int(path.stem.split('_')[1]))
    assert len(files) > 2
    assert all(limit <= path.stat().st_size < limit + 2 * CHUNK_SIZE for path in files[:-1])
    assert sum(len(times(path)) for path in files) == 40_000


def test_each_file_is_a_bag_by_itself(tmp_path):
    bag = write(tmp_path / 'bag', 1001, SECOND // 100, split_time=4 * SECOND)
    for number, count in enumerate((400, 400, 201)):
        with (bag / f'bag_{number}.mcap').open('rb') as file:
            summary = make_reader(file, validate_crcs=True).get_summary()
        assert {channel.topic for channel in summary.channels.values()} == {'/clock', '/odom'}
        assert {kind.name for kind in summary.schemas.values()} == {CLOCK.type, ODOM.type}
        assert summary.statistics.message_count == count


def test_rosbags_reads_them_as_one(tmp_path):
    bag = write(tmp_path / 'bag', 1001, SECOND // 100, split_time=4 * SECOND)
    with AnyReader([bag]) as reader:
        assert reader.message_count == 1001
        read = [reader.deserialize(data, connection.msgtype).clock for connection, _, data in reader.messages()]
    assert [stamp.sec * SECOND + stamp.nanosec for stamp in read] == [k * SECOND // 100 for k in range(1001)]


def test_a_topic_that_comes_late_is_in_all_files_after_that(tmp_path):
    with BagWriter(tmp_path / 'bag', split_time=SECOND) as writer:
        writer.add_topic(CLOCK.name, CLOCK.type, CLOCK.qos)
        for second in range(4):
            if second == 2:
                writer.add_topic('/odom', ODOM.type, ODOM.qos)
            writer.write(CLOCK.name, messages.encode(CLOCK.type, messages.Clock(second)), second * SECOND)
    found = []
    for number in range(4):
        with (tmp_path / 'bag' / f'bag_{number}.mcap').open('rb') as file:
            found.append(len(make_reader(file).get_summary().channels))
    assert found == [1, 2, 2, 2]  # it was announced before the third file began


def test_offers_are_written_as_rosbag2_does(tmp_path):
    offers = (
        OfferedQos('unknown', 0, 'best_effort', 'volatile', deadline=1_500_000_000),
        OfferedQos('keep_last', 7, 'reliable', 'transient_local', liveliness='manual_by_topic'),
    )
    with BagWriter(tmp_path / 'bag') as writer:
        writer.add_topic(CLOCK.name, CLOCK.type, offers)
    (topic,) = information(tmp_path / 'bag')['topics_with_message_count']
    first, second = topic['topic_metadata']['offered_qos_profiles']
    assert (first['history'], first['depth'], first['reliability']) == ('unknown', 0, 'best_effort')
    assert first['deadline'] == {'sec': 1, 'nsec': 500_000_000}
    assert second['lifespan'] == {'sec': 9223372036, 'nsec': 854775807}
    with AnyReader([tmp_path / 'bag']) as reader:
        (connection,) = reader.connections
    assert [qos.depth for qos in connection.ext.offered_qos_profiles] == [0, 7]


def test_files_that_were_finished_before_the_disk_was_full_are_whole(tmp_path):
    limit = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (300_000, limit[1]))
    try:
        with BagWriter(tmp_path / 'bag', compression='none', split_time=SECOND) as writer, \
                pytest.raises(BagError, match='File too large; what was written before stays readable'):
            writer.add_topic(CLOCK.name, CLOCK.type, CLOCK.qos)
            data = messages.encode(CLOCK.type, messages.Clock(1))
            for number in range(2000):
                writer.write(CLOCK.name, data, number * SECOND // 1000)
            while True:
                writer.write(CLOCK.name, data, 2 * SECOND)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limit)
    whole = read_messages(tmp_path / 'bag' / 'bag_0.mcap')
    assert len(list(whole)) == 1000
    assert whole.complete
    both = read_messages(tmp_path / 'bag')
    assert len(list(both)) > 1000
    assert len(both.damage) == 1
