"""Repaired bags: what was cut off or damaged is left out, all else is as it was, and the original is not touched."""

import io
import random
import resource
import shutil
import struct
import subprocess
import sys

import pytest
import yaml
import zstandard
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader
from mcap.writer import CompressionType, Writer
from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as RosbagsWriter
from rosbags.typesys import Stores, get_typestore

from omni_vehicle_ros import interface, messages
from omni_vehicle_ros.bags import BagWriter, read_messages
from omni_vehicle_ros.bags.repair import repair
from omni_vehicle_ros.errors import BagError

CLOCK = interface.topic('/clock')
CHUNKS, IN_CHUNK = 4, 2
ALL = CHUNKS * IN_CHUNK


def clock(number):
    return messages.encode(CLOCK.type, messages.Clock(number))


def write_clocks(directory, compression='zstd', first=0):
    """Write a small bag of several chunks."""
    with BagWriter(directory, compression=compression) as writer:
        writer.add_topic(CLOCK.name, CLOCK.type, CLOCK.qos)
        for number in range(first, first + ALL):
            writer.write(CLOCK.name, clock(number), number, number + 7)
            if number % IN_CHUNK == IN_CHUNK - 1:
                writer.flush()
    return directory / f'{directory.name}_0.mcap'


def read(path):
    stream = read_messages(path)
    found = [(message.topic, message.log_time, message.data) for message in stream]
    assert stream.complete, stream.damage
    return found


EXPECTED = [(CLOCK.name, number, clock(number)) for number in range(ALL)]


def small_file(compression):
    """Return a file of some chunks as bytes."""
    file = io.BytesIO()
    writer = Writer(file, compression=compression, enable_data_crcs=True)
    writer.start('ros2')
    channel = writer.register_channel(CLOCK.name, 'cdr', writer.register_schema(CLOCK.type, 'ros2msg', b'text'))
    for number in range(ALL):
        writer.add_message(channel, number, clock(number), number + 7)
        if number % IN_CHUNK == IN_CHUNK - 1:
            writer.flush()
    writer.finish()
    return file.getvalue()


SMALL = {compression: small_file(compression) for compression in CompressionType}


@pytest.fixture(scope='module', params=SMALL, ids=str)
def content(request):
    return SMALL[request.param]


@pytest.fixture(scope='module')
def scratch(tmp_path_factory):
    return tmp_path_factory.mktemp('scratch')


def repair_bytes(directory, content):
    """Repair a file with this content; return its messages, None if there are none, and whether it is whole."""
    damaged, out = directory / 'damaged.mcap', directory / 'out'
    damaged.write_bytes(content)
    try:
        result = repair(damaged, out)
    except BagError as error:
        assert len(str(error).splitlines()) == 1
        assert not out.exists()
        return None, False
    finally:
        assert damaged.read_bytes() == content
    if result.directory is None:
        return read(damaged), True
    try:
        found = read(out)
        assert len(found) == result.saved
        assert f'message_count: {len(found)}\n' in (out / 'metadata.yaml').read_text(encoding='utf-8')
    finally:
        shutil.rmtree(out)
    return found, False


def chunk_places(content):
    """Return begin and end of each chunk of a file that is whole."""
    places, position = [], 8
    while position < len(content) - 8:
        opcode, length = struct.unpack_from('<BQ', content, position)
        if opcode == 6:
            places.append((position, position + 9 + length))
        position += 9 + length
    return places


def is_part(found, whole):
    """Tell whether messages were left out, and nothing else."""
    rest = iter(whole)
    return all(message in rest for message in found)


def test_a_whole_bag_is_said_to_be_whole(tmp_path, bag, sent):
    result = repair(bag, tmp_path / 'out')
    assert result.directory is None
    assert result.saved == len(sent)
    assert result.lines == [f'the bag is whole: {len(sent)} messages in 1 file(s); nothing was written']
    assert not (tmp_path / 'out').exists()


def test_cut_off_anywhere_all_before_the_cut_is_saved(scratch, content):
    ends = [end for _, end in chunk_places(content)]
    for cut in range(0, len(content), 1 if content == SMALL[CompressionType.ZSTD] else 11):
        found, whole = repair_bytes(scratch, content[:cut])
        assert not whole
        least = IN_CHUNK * sum(end <= cut for end in ends)
        assert (found or []) == EXPECTED[: len(found or [])]
        assert len(found or []) >= least
        assert (found is None) <= (least == 0)


def test_one_bit_flipped_costs_one_chunk_at_most(scratch, content):
    dice = random.Random(4)
    for place in dice.sample(range(len(content)), 100):
        damaged = bytearray(content)
        damaged[place] ^= 1 << dice.randrange(8)
        found, whole = repair_bytes(scratch, bytes(damaged))
        assert not whole, place
        assert is_part(found, EXPECTED)
        assert len(found) >= ALL - IN_CHUNK


@settings(deadline=None, max_examples=100)
@given(
    edits=st.lists(st.tuples(st.floats(0, 1), st.binary(min_size=1, max_size=12)), min_size=1, max_size=4),
    cuts=st.tuples(st.floats(0, 1), st.floats(0, 1)),
    compression=st.sampled_from(CompressionType),
)
def test_whatever_is_overwritten_or_missing_nothing_wrong_is_saved(scratch, edits, cuts, compression):
    content = SMALL[compression]
    damaged = bytearray(content)
    for place, text in edits:
        begin = int(place * len(content))
        damaged[begin : begin + len(text)] = text
    begin, end = sorted(int(cut * len(damaged)) for cut in cuts)
    for text in (damaged, damaged[:begin] + damaged[end:]):
        found, whole = repair_bytes(scratch, bytes(text))
        if whole:
            assert found == EXPECTED
        assert is_part(found or [], EXPECTED) or compression != CompressionType.ZSTD  # cut chunks have no checksum


@settings(deadline=None, max_examples=100)
@given(st.binary(max_size=400), st.booleans(), st.lists(st.integers(1, 15), max_size=6))
def test_random_bytes_are_refused_in_one_line(scratch, text, magic, opcodes):
    begin = b'\x89MCAP0\r\n' if magic else b''
    records = b''.join(struct.pack('<BQ', opcode, len(text)) + text for opcode in opcodes)
    found, whole = repair_bytes(scratch, begin + (records or text))
    assert not found
    assert not whole


def test_a_damaged_chunk_in_the_middle_is_left_out_and_counted(tmp_path, content):
    begin, end = chunk_places(content)[1]
    damaged = bytearray(content)
    damaged[begin + 60 : end] = random.Random(5).randbytes(end - begin - 60)
    (tmp_path / 'x.mcap').write_bytes(damaged)
    result = repair(tmp_path / 'x.mcap', tmp_path / 'out')
    assert read(tmp_path / 'out') == EXPECTED[:IN_CHUNK] + EXPECTED[2 * IN_CHUNK :]
    (file,) = result.files
    assert (file.saved, file.lost, file.all_known) == (ALL - IN_CHUNK, IN_CHUNK, True)
    assert file.lost_bytes == end - begin
    assert result.lines[0] == (
        f'x.mcap: {ALL - IN_CHUNK} messages saved, {IN_CHUNK} lost; {end - begin} of {len(content)} bytes lost'
    )
    assert f'byte {begin}: a chunk ' in result.lines[1]
    assert result.lines[-1] == f'bag     {tmp_path / "out"}'


def test_without_its_end_a_file_tells_by_its_indexes_what_is_lost(tmp_path, content):
    places = chunk_places(content)
    damaged = bytearray(content[: places[3][0]])
    damaged[places[1][1] - 1] ^= 1
    damaged[places[1][1] - 9] ^= 255
    (tmp_path / 'x.mcap').write_bytes(damaged)
    (file,) = repair(tmp_path / 'x.mcap', tmp_path / 'out').files
    assert (file.saved, file.lost, file.all_known) == (2 * IN_CHUNK, IN_CHUNK, False)
    assert f'at least {IN_CHUNK} lost' in file.lines[0]


def test_bytes_missing_in_the_middle_cost_what_they_touch(scratch, content):
    places = chunk_places(content)
    found, _ = repair_bytes(scratch, content[: places[1][0] + 70] + content[places[1][0] + 90 :])
    assert found == EXPECTED[:IN_CHUNK] + EXPECTED[2 * IN_CHUNK :]


def test_lost_definitions_are_taken_from_the_summary(scratch, content):
    begin, end = chunk_places(content)[0]
    found, _ = repair_bytes(scratch, content[:begin] + bytes(end - begin) + content[end:])
    assert found == EXPECTED[IN_CHUNK:]


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


def test_files_without_chunks_are_repaired(tmp_path):
    path = tmp_path / 'plain.mcap'
    with path.open('wb') as file:
        writer = Writer(file, use_chunking=False)
        writer.start()
        channel = writer.register_channel(CLOCK.name, 'cdr', writer.register_schema(CLOCK.type, 'ros2msg', b''))
        for number in range(ALL):
            writer.add_message(channel, number, clock(number), number)
        writer.finish()
    content = bytearray(path.read_bytes())
    record = struct.pack('<BQ', 5, 22 + len(clock(0)))
    content[content.index(record) + 2] = 77  # a length that leads nowhere
    path.write_bytes(content)
    (file,) = repair(path, tmp_path / 'out').files
    assert (file.saved, file.unchecked, file.lost) == (ALL - 1, ALL - 1, 1)
    assert read(tmp_path / 'out') == EXPECTED[1:]
    assert file.lines[-1] == f'  {ALL - 1} of the saved messages have no checksum: they may be damaged inside'


def test_bags_of_rosbags_are_whole_or_repaired(tmp_path, sent):
    typestore = get_typestore(Stores.ROS2_JAZZY)
    with RosbagsWriter(tmp_path / 'bag', version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connection = writer.add_connection('/odom', 'nav_msgs/msg/Odometry', typestore=typestore)
        for message in sent:
            if message.topic == '/odom':
                writer.write(connection, message.stamp, message.data)
    assert repair(tmp_path / 'bag', tmp_path / 'out').directory is None
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
from omni_vehicle_ros.bags.repair import repair
from omni_vehicle_ros.errors import BagError
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
try:
    repair(sys.argv[1], sys.argv[2])
except BagError:
    pass
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before)
"""


def test_a_chunk_that_is_larger_than_it_looks_takes_little_memory(tmp_path):
    size = 2**29
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
    for count in (5_000, 50_000):
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
    assert grown[1] - grown[0] < 4 * 1024  # KiB, for 45 MB more
