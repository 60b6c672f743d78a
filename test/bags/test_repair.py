"""Repaired bags as a whole: all but the damage is as it was, the original is not touched, memory has a bound."""

import random
import resource
import shutil
import struct
import subprocess
import sys

import pytest
import yaml
import zstandard
from mcap.reader import make_reader
from mcap.writer import CompressionType, Writer
from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as RosbagsWriter
from rosbags.typesys import Stores, get_typestore

from omni_vehicle_ros import interface, messages
from omni_vehicle_ros.bags import BagWriter, read_messages
from omni_vehicle_ros.bags.repair.repair import repair
from omni_vehicle_ros.errors import BagError

CLOCK = interface.topic('/clock')
ALL = 8


def clock(number):
    return messages.encode(CLOCK.type, messages.Clock(number))


def write_clocks(directory):
    """Write a small bag."""
    with BagWriter(directory) as writer:
        writer.add_topic(CLOCK.name, CLOCK.type, CLOCK.qos)
        for number in range(ALL):
            writer.write(CLOCK.name, clock(number), number, number + 7)


def read(path):
    stream = read_messages(path)
    found = [(message.topic, message.log_time, message.data) for message in stream]
    assert stream.complete, stream.damage
    return found


EXPECTED = [(CLOCK.name, number, clock(number)) for number in range(ALL)]


def test_a_whole_bag_is_said_to_be_whole(tmp_path, bag, sent):
    result = repair(bag, tmp_path / 'out')
    assert result.directory is None
    assert result.saved == len(sent)
    assert result.lines == [f'the bag is whole: {len(sent)} messages in 1 file(s); nothing was written']
    assert not (tmp_path / 'out').exists()


def test_all_but_the_damage_is_kept_as_it_was(tmp_path, bag, sent):
    path = tmp_path / 'damaged' / 'drive_0.mcap'
    shutil.copytree(bag, path.parent)
    path.write_bytes(path.read_bytes()[:-50])
    result = repair(path.parent, tmp_path / 'out')
    assert result.saved == len(sent)
    with AnyReader([bag]) as old, AnyReader([tmp_path / 'out']) as new:
        assert [(c.topic, t, d) for c, t, d in old.messages()] == [(c.topic, t, d) for c, t, d in new.messages()]
        assert {(c.topic, c.msgtype, c.digest, tuple(c.ext.offered_qos_profiles)) for c in old.connections} == {
            (c.topic, c.msgtype, c.digest, tuple(c.ext.offered_qos_profiles)) for c in new.connections
        }
    texts = [(where / 'metadata.yaml').read_text(encoding='utf-8') for where in (bag, tmp_path / 'out')]
    old, new = (yaml.safe_load(text)['rosbag2_bagfile_information'] for text in texts)
    for each in (old, new):
        each['topics_with_message_count'].sort(key=lambda row: row['topic_metadata']['name'])
    assert old == new
    assert repair(tmp_path / 'out', tmp_path / 'again').directory is None


def test_channels_attachments_words_and_times_are_kept(tmp_path):
    path = tmp_path / 'x.mcap'
    with path.open('wb') as file:
        writer = Writer(file, compression=CompressionType.LZ4)
        writer.start('ros2')
        schema = writer.register_schema('some_msgs/msg/Thing', 'ros2idl', b'\x00\xff some bytes')
        channels = [writer.register_channel('/t', 'cdr', each, {'a': 'ä'}) for each in (schema, 0)]
        writer.add_attachment(1, 2, 'name', 'text/plain', b'x' * 100)
        writer.add_metadata('words', {'key': 'word', '': ''})
        writer.add_message(channels[0], 5, b'\x01', 3, 9)
        writer.add_message(channels[1], 4, b'', 6, 8)
        writer.finish()
    path.write_bytes(path.read_bytes()[:-8])
    repair(path, tmp_path / 'out')
    with (tmp_path / 'out' / 'x.mcap').open('rb') as file:
        reader = make_reader(file, validate_crcs=True)
        found = [
            (s and (s.name, s.encoding, s.data), c.topic, c.metadata, m.log_time, m.publish_time, m.sequence, m.data)
            for s, c, m in reader.iter_messages(log_time_order=False)
        ]
        thing = ('some_msgs/msg/Thing', 'ros2idl', b'\x00\xff some bytes')
        assert found == [(thing, '/t', {'a': 'ä'}, 5, 3, 9, b'\x01'), (None, '/t', {'a': 'ä'}, 4, 6, 8, b'')]
        (attachment,) = reader.iter_attachments()
        assert (attachment.create_time, attachment.log_time, attachment.data) == (1, 2, b'x' * 100)
        assert {each.name: each.metadata for each in reader.iter_metadata()}['words'] == {'key': 'word', '': ''}


def state_of(directory):
    return [
        (each, each.lstat().st_mtime_ns, each.is_file() and each.read_bytes())
        for each in (directory, *directory.iterdir())
    ]


def test_the_original_is_not_touched(tmp_path, bag):
    damaged = tmp_path / 'damaged'
    shutil.copytree(bag, damaged)
    path = damaged / 'drive_0.mcap'
    path.write_bytes(path.read_bytes()[:-1000])
    before = state_of(damaged)
    damaged.chmod(0o500)
    try:
        repair(damaged, tmp_path / 'out')
        with pytest.raises(BagError, match='lies in the bag'):
            repair(damaged, damaged / 'out')
        with pytest.raises(BagError, match='lies in the bag'):
            repair(path, damaged / 'out')
    finally:
        damaged.chmod(0o700)
    assert state_of(damaged) == before


def test_of_a_split_bag_each_file_is_repaired(tmp_path):
    with BagWriter(tmp_path / 'bag', split_time=2) as writer:
        writer.add_topic(CLOCK.name, CLOCK.type, CLOCK.qos)
        for number in range(ALL):
            writer.write(CLOCK.name, clock(number), number)
    assert repair(tmp_path / 'bag', tmp_path / 'out').directory is None
    first, *_, last = sorted((tmp_path / 'bag').glob('*.mcap'))
    saved = sum(1 for _ in read_messages(first))
    first.write_bytes(first.read_bytes()[:-1])
    last.write_bytes(b'')
    lost = [message for message in EXPECTED if message[1] >= ALL - sum(1 for _ in read_messages(first))]
    result = repair(tmp_path / 'bag', tmp_path / 'out')
    assert read(tmp_path / 'out') == [message for message in EXPECTED if message not in lost]
    assert [file.saved for file in result.files] == [saved] * (len(result.files) - 1) + [0]
    information = yaml.safe_load((tmp_path / 'out' / 'metadata.yaml').read_text())['rosbag2_bagfile_information']
    assert information['relative_file_paths'] == [file.name for file in result.files[:-1]]
    with AnyReader([tmp_path / 'out']) as reader:
        assert reader.message_count == result.saved
    assert result.files[1].lines == [f'{result.files[1].name}: {saved} messages saved; the file is whole']


@pytest.mark.parametrize(
    ('text', 'words'),
    [
        (None, 'metadata.yaml is missing'),
        (b'\xff', 'metadata.yaml can not be read'),
        (b'[' * 5000, 'metadata.yaml can not be read'),
        (b'rosbag2_bagfile_information: {message_count: 1, relative_file_paths: []}', 'metadata.yaml is not complete'),
        (b'#' * 2**23, 'metadata.yaml has more than 4194304 bytes'),
        ((b'bag_0.mcap', b'bag_1.mcap'), "metadata.yaml names 'bag_1.mcap', which is missing"),
        ((b'message_count: 8', b'message_count: 9'), 'metadata.yaml is wrong about message_count, topics'),
    ],
)
def test_metadata_is_made_anew(tmp_path, text, words):
    write_clocks(tmp_path / 'bag')
    path = tmp_path / 'bag' / 'metadata.yaml'
    good = path.read_bytes()
    path.unlink()
    if text is not None:
        path.write_bytes(good.replace(*text) if isinstance(text, tuple) else text)
    result = repair(tmp_path / 'bag', tmp_path / 'out')
    assert result.metadata_damage.startswith(words)
    assert read(tmp_path / 'out') == EXPECTED
    assert (tmp_path / 'out' / 'metadata.yaml').read_bytes() == good


def test_bags_of_rosbags_are_whole_or_repaired(tmp_path, sent):
    typestore = get_typestore(Stores.ROS2_JAZZY)
    with RosbagsWriter(tmp_path / 'bag', version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connection = writer.add_connection('/odom', 'nav_msgs/msg/Odometry', typestore=typestore)
        for message in sent:
            if message.topic == '/odom':
                writer.write(connection, message.stamp, message.data)
    whole = repair(tmp_path / 'bag', tmp_path / 'out')
    assert whole.directory is None
    assert f'{whole.saved} of them have no checksum: they may be damaged inside' in whole.lines[0]
    path = tmp_path / 'bag' / 'bag.mcap'
    path.write_bytes(path.read_bytes()[:-20])
    repair(tmp_path / 'bag', tmp_path / 'out')
    assert read(tmp_path / 'out') == [(m.topic, m.stamp, m.data) for m in sent if m.topic == '/odom']


def test_what_can_not_be_repaired_is_said_in_one_line(tmp_path):
    (tmp_path / 'empty.mcap').touch()
    with pytest.raises(BagError, match=r'nothing can be saved of .*empty\.mcap'):
        repair(tmp_path / 'empty.mcap', tmp_path / 'new' / 'out')
    assert not (tmp_path / 'new').exists()
    with pytest.raises(BagError, match='does not exist'):
        repair(tmp_path / 'nothing', tmp_path / 'out')
    with pytest.raises(BagError, match='exists; name a directory'):
        repair(tmp_path / 'empty.mcap', tmp_path)
    (tmp_path / 'bag' / 'x.mcap').mkdir(parents=True)
    with pytest.raises(BagError, match='is not a regular file'):
        repair(tmp_path / 'bag', tmp_path / 'out')


def test_a_full_disk_leaves_nothing(tmp_path, bag):
    path = tmp_path / 'x.mcap'
    path.write_bytes((bag / 'drive_0.mcap').read_bytes()[:-1])
    limit = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, limit[1]))
    try:
        with pytest.raises(BagError, match='File too large; no repaired bag is left'):
            repair(path, tmp_path / 'out')
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limit)
    assert [each.name for each in tmp_path.iterdir()] == ['x.mcap']


BOUNDED = """
import resource, sys
from omni_vehicle_ros.bags.repair.repair import repair
from omni_vehicle_ros.errors import BagError
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
try:
    repair(sys.argv[1], sys.argv[2])
except BagError:
    pass
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before)
"""


def test_a_chunk_that_is_larger_than_it_looks_takes_little_memory(tmp_path):
    size = 2**28
    packed = zstandard.ZstdCompressor(level=1).compress(bytes(size))
    chunk = struct.pack('<QQQII', 0, 0, size, 0, 4) + b'zstd' + struct.pack('<Q', len(packed)) + packed
    path = tmp_path / 'x.mcap'
    path.write_bytes(b'\x89MCAP0\r\n' + struct.pack('<BQ', 6, len(chunk)) + chunk)
    assert path.stat().st_size < 100_000
    done = subprocess.run(
        [sys.executable, '-c', BOUNDED, path, tmp_path / 'out'], capture_output=True, text=True, check=True, timeout=60
    )
    assert int(done.stdout) < 64 * 1024  # KiB


def test_memory_does_not_grow_with_the_bag(tmp_path):
    grown = []
    for count in (2_000, 20_000):
        path = tmp_path / f'{count}.mcap'
        dice = random.Random(6)
        with path.open('wb') as file:
            writer = Writer(file)
            writer.start('ros2')
            schema = writer.register_schema('std_msgs/msg/String', 'ros2msg', b'')
            channel = writer.register_channel('/t', 'cdr', schema)
            for number in range(count):
                writer.add_message(channel, number, dice.randbytes(1000), number)
            writer.finish()
            file.truncate(file.tell() - 10)
        done = subprocess.run(
            [sys.executable, '-c', BOUNDED, path, tmp_path / f'out{count}'], capture_output=True, text=True, check=True
        )
        assert sum(1 for _ in read_messages(tmp_path / f'out{count}')) == count
        grown.append(int(done.stdout))
    assert grown[1] - grown[0] < 4 * 1024  # KiB, for 18 MB more
