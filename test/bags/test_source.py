"""Bags of others: sqlite3 and compressed ones, as ``rosbags`` writes them, give the same messages as ours."""

import pytest
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.rosbag2.metadata import parse_qos
from rosbags.typesys import Stores, get_typestore

from omni_vehicle_ros.bags import BagWriter
from omni_vehicle_ros.bags.metadata import offer, qos_profiles
from omni_vehicle_ros.bags.schema import schema
from omni_vehicle_ros.bags.source import open_source
from omni_vehicle_ros.errors import BagError
from omni_vehicle_ros.interface import LATCHED, STATE
from omni_vehicle_ros.messages import Text, Vector, encode

TEXT, VECTOR = 'std_msgs/msg/String', 'geometry_msgs/msg/Vector3Stamped'
TOPICS = {'/said': (TEXT, STATE), '/bank': (VECTOR, LATCHED)}
MESSAGES = [
    (topic, kind, time, encode(kind, Text(f'at {time}') if kind == TEXT else Vector(time, 0.1, 0.0)))
    for time in range(1_000_000, 1_000_050)
    for topic, (kind, _) in TOPICS.items()
]


def write_ours(path):
    with BagWriter(path) as writer:
        for topic, (kind, qos) in TOPICS.items():
            writer.add_topic(topic, kind, qos)
        for topic, _, time, data in MESSAGES:
            writer.write(topic, data, time)


def write_theirs(path, plugin=StoragePlugin.SQLITE3, mode=None):
    store = get_typestore(Stores.ROS2_JAZZY)
    writer = Writer(path, version=9, storage_plugin=plugin)
    if mode:
        writer.set_compression(mode, CompressionFormat.ZSTD)
    with writer:
        connections = {
            topic: writer.add_connection(
                topic, kind, typestore=store, offered_qos_profiles=parse_qos(qos_profiles([offer(qos)]))
            )
            for topic, (kind, qos) in TOPICS.items()
        }
        for topic, _, time, data in MESSAGES:
            writer.write(connections[topic], time, data)


WRITERS = {
    'ours': write_ours,
    'mcap': lambda path: write_theirs(path, StoragePlugin.MCAP),
    'sqlite3': write_theirs,
    'sqlite3, messages compressed': lambda path: write_theirs(path, mode=CompressionMode.MESSAGE),
    'sqlite3, files compressed': lambda path: write_theirs(path, mode=CompressionMode.FILE),
}


@pytest.mark.parametrize('write', WRITERS.values(), ids=WRITERS)
def test_messages_and_topics_are_those_that_were_written(tmp_path, write):
    write(tmp_path / 'bag')
    source = open_source(tmp_path / 'bag')
    told = dict(source.topics)
    for _ in range(2):
        assert [tuple(message)[:4] for message in source] == MESSAGES
    assert dict(source.topics) == told
    assert not source.damage
    for topic, (kind, qos) in TOPICS.items():
        facts = source.topics[topic]
        assert facts.type_name == kind
        assert facts.encoding == 'cdr'
        assert facts.offers == (offer(qos),)
        assert facts.type_hash == schema(kind).type_hash


@pytest.mark.parametrize('write', [write_ours, write_theirs], ids=['mcap', 'sqlite3'])
def test_one_file_alone_is_a_bag(tmp_path, write):
    write(tmp_path / 'bag')
    (file,) = (path for path in (tmp_path / 'bag').iterdir() if path.suffix != '.yaml')
    source = open_source(file)
    assert [tuple(message)[:4] for message in source] == MESSAGES
    assert source.topics['/bank'].offers == (offer(LATCHED),)


def test_topics_without_messages_are_not_told(tmp_path):
    with BagWriter(tmp_path / 'bag') as writer:
        writer.add_topic('/silent', TEXT, STATE)
    assert not open_source(tmp_path / 'bag').topics


def test_a_broken_bag_gives_what_there_is_and_says_so(tmp_path):
    write_ours(tmp_path / 'bag')
    file = tmp_path / 'bag' / 'bag_0.mcap'
    file.write_bytes(file.read_bytes()[:-100])
    source = open_source(tmp_path / 'bag')
    assert len(list(source)) == len(MESSAGES)
    assert len(source.damage) == 1


def test_a_broken_database_gives_no_trace(tmp_path):
    write_theirs(tmp_path / 'bag')
    (file,) = (tmp_path / 'bag').glob('*.db3')
    whole = file.read_bytes()
    for cut in range(0, len(whole), 1500):
        file.write_bytes(whole[:cut] + bytes(min(1000, len(whole) - cut)) + whole[cut + 1000 :])
        try:
            source = open_source(tmp_path / 'bag')
        except BagError as error:
            assert '\n' not in str(error)
            continue
        found = [tuple(message)[:4] for message in source]
        assert len(found) <= len(MESSAGES)
        assert all(isinstance(data, bytes) for *_, data in found)
        assert all('\n' not in line for line in source.damage)
    file.write_bytes(b'')
    with pytest.raises(BagError, match='no bag that can be read here'):
        open_source(tmp_path / 'bag')


@pytest.mark.parametrize('name', ['none', 'bag.txt', 'folder'])
def test_what_is_no_bag_is_refused_in_one_line(tmp_path, name):
    (tmp_path / 'bag.txt').write_text('no bag')
    (tmp_path / 'folder').mkdir()
    with pytest.raises(BagError) as refused:
        open_source(tmp_path / name)
    assert name in str(refused.value)
    assert '\n' not in str(refused.value)
