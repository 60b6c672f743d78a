"""Streams from files that are whole, broken off, damaged or no MCAP files at all."""

import random
import shutil

import pytest
from mcap.writer import CompressionType, Writer
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as RosbagsWriter
from rosbags.typesys import Stores, get_typestore

from omni_vehicle_ros.bags import open_bag, read_messages
from omni_vehicle_ros.errors import BagError


def triples(stream):
    return [(message.topic, message.log_time, message.data) for message in stream]


@pytest.fixture(scope='module')
def expected(sent):
    return [(message.topic, message.stamp, message.data) for message in sent]


@pytest.fixture(scope='module')
def content(bag):
    return (bag / 'drive_0.mcap').read_bytes()


def test_a_whole_bag_is_read_in_order(bag, expected):
    stream = read_messages(bag)
    assert triples(stream) == expected
    assert (stream.count, stream.complete, stream.damage) == (len(expected), True, [])
    assert triples(stream) == expected


def test_a_file_is_read_like_its_directory(bag, expected):
    assert triples(read_messages(bag / 'drive_0.mcap')) == expected


def test_a_truncated_file_gives_what_comes_before_its_end(tmp_path, content, expected):
    path = tmp_path / 'cut.mcap'
    cuts = random.Random(1).sample(range(len(content)), 120)
    last = -1
    for cut in sorted([*cuts, *range(12), *range(len(content) - 60, len(content))]):
        path.write_bytes(content[:cut])
        stream = read_messages(path)
        read = triples(stream)
        assert read == expected[: len(read)]
        assert last <= len(read) == stream.count
        assert not stream.complete
        assert f'{len(read)} messages before that are good' in stream.damage[0]
        last = len(read)
    assert last == len(expected)


def test_a_damaged_file_never_gives_what_was_not_written(tmp_path, content, expected):
    path = tmp_path / 'damaged.mcap'
    dice = random.Random(2)
    wrong = 0
    for _ in range(100):
        damaged = bytearray(content)
        for _ in range(dice.randint(1, 3)):
            damaged[dice.randrange(len(damaged))] ^= 1 << dice.randrange(8)
        path.write_bytes(damaged)
        stream = read_messages(path)
        try:
            read = triples(stream)
        except BagError:
            continue
        assert read == expected[: len(read)]
        wrong += not stream.complete
        assert stream.complete <= (len(read) == len(expected))
    assert wrong > 40


@pytest.mark.parametrize('compression', list(CompressionType))
def test_damage_inside_of_chunks_is_noticed_by_their_structure(tmp_path, compression):
    """Without checksums a damaged message can't be noticed, but nothing may break."""
    path = tmp_path / 'plain.mcap'
    with path.open('wb') as file:
        writer = Writer(file, compression=compression, enable_crcs=False)
        writer.start()
        schema = writer.register_schema('rosgraph_msgs/msg/Clock', 'ros2msg', b'')
        channel = writer.register_channel('/clock', 'cdr', schema)
        for number in range(50):
            writer.add_message(channel, number, bytes(12), number)
        writer.finish()
    whole = path.read_bytes()
    dice = random.Random(3)
    for _ in range(150):
        damaged = bytearray(whole)
        for _ in range(dice.randint(1, 3)):
            damaged[dice.randrange(len(damaged))] = dice.randrange(256)
        path.write_bytes(damaged)
        try:
            assert len(list(read_messages(path))) <= 51
            bag = open_bag(path)
            for topic in bag:
                bag[topic]
        except BagError as error:
            assert len(str(error).splitlines()) == 1


def test_files_without_chunks_are_read(tmp_path):
    path = tmp_path / 'plain.mcap'
    with path.open('wb') as file:
        writer = Writer(file, use_chunking=False)
        writer.start()
        schema = writer.register_schema('rosgraph_msgs/msg/Clock', 'ros2msg', b'')
        channel = writer.register_channel('/clock', 'cdr', schema)
        writer.add_attachment(0, 0, 'attached', 'text/plain', b'x' * 100)
        writer.add_message(channel, 5, bytes(12), 5)
        writer.finish()
    stream = read_messages(path)
    assert list(stream) == [('/clock', 'rosgraph_msgs/msg/Clock', 5, bytes(12))]
    assert stream.complete


def test_bags_of_rosbags_are_read(tmp_path, sent):
    typestore = get_typestore(Stores.ROS2_JAZZY)
    with RosbagsWriter(tmp_path / 'bag', version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connections = {}
        for message in sent:
            if message.topic not in connections:
                connections[message.topic] = writer.add_connection(
                    message.topic, message.type_name, typestore=typestore
                )
            writer.write(connections[message.topic], message.stamp, message.data)
    read = triples(read_messages(tmp_path / 'bag'))
    assert read == [(message.topic, message.stamp, message.data) for message in sent]


def test_split_bags_are_read_in_the_order_of_their_numbers(tmp_path, bag, sent, expected):
    for number in (2, 10):
        shutil.copy(bag / 'drive_0.mcap', tmp_path / f'drive_{number}.mcap')
    cut = tmp_path / 'drive_2.mcap'
    cut.write_bytes(cut.read_bytes()[: cut.stat().st_size // 2])
    stream = read_messages(tmp_path)
    read = triples(stream)
    first = len(read) - len(expected)
    assert 0 < first < len(expected)
    assert read == expected[:first] + expected
    (damage,) = stream.damage
    assert 'drive_2.mcap' in damage


def test_what_is_no_bag_is_refused_in_one_line(tmp_path):
    with pytest.raises(BagError, match=r'nothing does not exist; name a bag directory'):
        read_messages(tmp_path / 'nothing')
    with pytest.raises(BagError, match=r'holds no MCAP file'):
        read_messages(tmp_path)
    (tmp_path / 'text.mcap').write_text('not a bag')
    with pytest.raises(BagError, match=r'is not an MCAP file: it begins with'):
        list(read_messages(tmp_path / 'text.mcap'))
    (tmp_path / 'directory.mcap').mkdir()
    with pytest.raises(BagError, match='can not be read'):
        list(read_messages(tmp_path))
