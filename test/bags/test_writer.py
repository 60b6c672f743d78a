"""Written bags as independent readers see them, and what is left of them when the writer fails or dies."""

import resource
import signal
import subprocess
import sys

import pytest
import yaml
from mcap.reader import make_reader
from rosbags.highlevel import AnyReader
from rosbags.interfaces import QosDurability, QosHistory, QosReliability
from rosbags.typesys import Stores, get_typestore

from omni_vehicle_ros import __version__, interface, messages
from omni_vehicle_ros.bags import BagWriter, read_messages
from omni_vehicle_ros.errors import BagError

CLOCK = interface.topic('/clock')
TYPESTORE = get_typestore(Stores.ROS2_JAZZY)


def clock(number):
    return messages.encode(CLOCK.type, messages.Clock(number))


def new_clock_bag(directory, **options):
    writer = BagWriter(directory, **options)
    writer.add_topic(CLOCK.name, CLOCK.type, CLOCK.qos)
    return writer


def test_rosbags_reads_every_message_and_checks_the_hashes(bag, sent):
    with AnyReader([bag]) as reader:
        assert reader.message_count == len(sent)
        assert reader.start_time == sent[0].stamp
        assert reader.end_time == sent[-1].stamp + 1
        read = [(connection.topic, stamp, data) for connection, stamp, data in reader.messages()]
        assert sorted(read) == sorted((message.topic, message.stamp, message.data) for message in sent)
        for connection, _, data in reader.messages():
            ours = TYPESTORE.serialize_cdr(reader.deserialize(data, connection.msgtype), connection.msgtype)
            assert bytes(ours) == data


def test_quality_of_service_is_recorded(bag):
    with AnyReader([bag]) as reader:
        connections = {connection.topic: connection for connection in reader.connections}
    for row in interface.TOPICS:
        if not row.recorded:
            continue
        (qos,) = connections[interface.resolve(row.name, '')].ext.offered_qos_profiles
        assert (qos.history, qos.depth) == (QosHistory.KEEP_LAST, row.qos.depth)
        assert qos.reliability == QosReliability.RELIABLE
        assert qos.durability == (QosDurability.TRANSIENT_LOCAL if row.qos.latched else QosDurability.VOLATILE)


def test_metadata_is_that_of_version_9(bag, sent):
    information = yaml.safe_load((bag / 'metadata.yaml').read_text(encoding='utf-8'))['rosbag2_bagfile_information']
    assert information['version'] == 9
    assert information['storage_identifier'] == 'mcap'
    assert information['relative_file_paths'] == ['drive_0.mcap']
    assert information['message_count'] == len(sent)
    assert information['starting_time'] == {'nanoseconds_since_epoch': sent[0].stamp}
    assert information['duration'] == {'nanoseconds': sent[-1].stamp - sent[0].stamp}
    counts = {
        topic['topic_metadata']['name']: topic['message_count'] for topic in information['topics_with_message_count']
    }
    assert sum(counts.values()) == len(sent)
    assert counts['/odom'] == sum(message.topic == '/odom' for message in sent)
    assert counts['/environment/bank'] == 0
    assert [path.name for path in sorted(bag.iterdir())] == ['drive_0.mcap', 'metadata.yaml']


@pytest.mark.parametrize('compression', ['none', 'lz4', 'zstd'])
def test_the_indexed_reader_of_mcap_agrees(tmp_path, sent, compression):
    with BagWriter(tmp_path / 'bag', compression=compression) as writer:
        for message in sent:
            writer.add_topic(message.topic, message.type_name, interface.STATE)
            writer.write(message.topic, message.data, message.stamp, message.stamp + 1)
        metadata_name = writer.path
    with metadata_name.open('rb') as file:
        reader = make_reader(file, validate_crcs=True)
        assert reader.get_header().profile == 'ros2'
        assert reader.get_header().library == f'omni_vehicle_ros {__version__}'
        assert reader.get_summary().statistics.message_count == len(sent)
        read = [
            (channel.topic, schema.name, message.log_time, message.publish_time - 1, message.data)
            for schema, channel, message in reader.iter_messages(log_time_order=False)
        ]
        (metadata,) = reader.iter_metadata()
    assert read == [(one.topic, one.type_name, one.stamp, one.stamp, one.data) for one in sent]
    assert metadata.name == 'rosbag2'
    assert yaml.safe_load(metadata.metadata['serialized_metadata'])['message_count'] == len(sent)
    assert [tuple(one)[:3] for one in read_messages(tmp_path / 'bag')] == [one[:3] for one in sent]


def test_an_empty_bag_is_a_bag(tmp_path):
    new_clock_bag(tmp_path / 'bag').close()
    with AnyReader([tmp_path / 'bag']) as reader:
        assert reader.message_count == 0
    stream = read_messages(tmp_path / 'bag')
    assert list(stream) == []
    assert stream.complete


def test_custom_words_are_kept(tmp_path):
    writer = new_clock_bag(tmp_path / 'bag')
    writer.write(CLOCK.name, clock(1), 1)
    writer.close({'scenario': 'simple_turning: {radius: 5}'})
    information = yaml.safe_load((tmp_path / 'bag' / 'metadata.yaml').read_text(encoding='utf-8'))
    assert information['rosbag2_bagfile_information']['custom_data'] == {'scenario': 'simple_turning: {radius: 5}'}


def test_an_existing_directory_is_not_touched(tmp_path):
    with pytest.raises(BagError, match=r'exists; name a directory that does not'):
        BagWriter(tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_a_directory_that_can_not_be_made_is_named(tmp_path):
    (tmp_path / 'file').touch()
    with pytest.raises(BagError, match='file/bag can not be made'):
        BagWriter(tmp_path / 'file' / 'bag')


def test_wrong_use_is_refused(tmp_path):
    with pytest.raises(BagError, match="compression 'zip' is unknown; known are none, lz4, zstd"):
        BagWriter(tmp_path / 'bag', compression='zip')
    assert not (tmp_path / 'bag').exists()
    writer = new_clock_bag(tmp_path / 'bag')
    with pytest.raises(BagError, match='/odom is unknown'):
        writer.write('/odom', clock(1), 1)
    with pytest.raises(BagError, match='/clock: the times -1'):
        writer.write(CLOCK.name, clock(1), -1)
    with pytest.raises(BagError, match='has the type rosgraph_msgs/msg/Clock, not std_msgs/msg/String'):
        writer.add_topic(CLOCK.name, 'std_msgs/msg/String', CLOCK.qos)
    writer.close()
    writer.close()
    with pytest.raises(BagError, match='closed'):
        writer.write(CLOCK.name, clock(1), 1)


def test_a_bag_survives_an_error_of_its_user(tmp_path):
    with pytest.raises(ZeroDivisionError), new_clock_bag(tmp_path / 'bag') as writer:
        writer.write(CLOCK.name, clock(7), 7)
        writer.write(CLOCK.name, clock(1 // 0), 8)
    stream = read_messages(tmp_path / 'bag')
    assert [message.log_time for message in stream] == [7]
    assert stream.complete


WRITE_UNTIL_KILLED = """
import sys
from omni_vehicle_ros import interface, messages
from omni_vehicle_ros.bags import BagWriter

row = interface.topic('/clock')
writer = BagWriter(sys.argv[1])
writer.add_topic(row.name, row.type, row.qos)
number = 0
while True:
    for _ in range(1000):
        writer.write(row.name, messages.encode(row.type, messages.Clock(number)), number)
        number += 1
    writer.flush()
    print(number, flush=True)
"""


def test_all_that_was_flushed_survives_a_kill(tmp_path):
    directory = tmp_path / 'bag'
    with subprocess.Popen([sys.executable, '-c', WRITE_UNTIL_KILLED, directory], stdout=subprocess.PIPE) as process:
        for _ in range(3):
            process.stdout.readline()
        process.kill()
        flushed = 1000 * (3 + len(process.stdout.readlines()))
    assert process.returncode == -signal.SIGKILL
    stream = read_messages(directory)
    numbers = [message.log_time for message in stream]
    assert numbers == list(range(len(numbers)))
    assert len(numbers) >= flushed
    assert not stream.complete
    information = yaml.safe_load((directory / 'metadata.yaml').read_text(encoding='utf-8'))
    assert information['rosbag2_bagfile_information']['relative_file_paths'] == ['bag_0.mcap']


def test_what_was_written_before_the_disk_was_full_stays_readable(tmp_path):
    writer = new_clock_bag(tmp_path / 'bag', compression='none')
    limit = resource.getrlimit(resource.RLIMIT_FSIZE)
    written = 0
    resource.setrlimit(resource.RLIMIT_FSIZE, (500_000, limit[1]))
    try:
        with pytest.raises(BagError, match='File too large; what was written before stays readable'):
            while True:
                writer.write(CLOCK.name, clock(written), written)
                written += 1
        with pytest.raises(BagError, match='File too large'):
            writer.flush()
        writer.close()
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limit)
    stream = read_messages(tmp_path / 'bag')
    numbers = [message.log_time for message in stream]
    assert numbers == list(range(len(numbers)))
    assert 0 < written - len(numbers) < 2500
    assert not stream.complete
