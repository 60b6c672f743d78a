"""Blocks of columns against the slow decoder, message by message, and against what memory allows."""

import math
import tracemalloc

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.writer import CompressionType, Writer
from numpy.testing import assert_array_equal
from rosbags.typesys import Stores, get_typestore

from omni_vehicle_ros import interface, messages
from omni_vehicle_ros.bags import BagWriter, read_blocks
from omni_vehicle_ros.bags.columns import blocks
from omni_vehicle_ros.bags.columns.columns import join_columns, make_columns
from omni_vehicle_ros.bags.columns.kernel import compiled_walk
from omni_vehicle_ros.errors import BagError, MessageError
from omni_vehicle_ros.messages import VALUE_TYPES, decode, encode

TYPESTORE = get_typestore(Stores.ROS2_JAZZY)
JOINTS = 'sensor_msgs/msg/JointState'
CLOCK = 'rosgraph_msgs/msg/Clock'
TOPIC = '/topic'

numbers = st.floats(allow_nan=True, allow_infinity=True)
angles = st.floats(-math.pi, math.pi)
stamps = st.integers(-(2**31) * 10**9, (2**31 - 1) * 10**9)
words = st.sampled_from(('', 'a', 'b', 'left', 'right', 'räder'))
name_lists = st.lists(words, max_size=4).map(tuple)


def lists_like(names, elements):
    """Give a number for each name, none, or a wrong number of them."""
    sizes = st.sampled_from((len(names), 0, len(names) + 1))
    return sizes.flatmap(lambda size: st.tuples(*(elements,) * size))


def joints(names):
    numbers_of = lists_like(names, numbers)
    return st.builds(messages.Joints, stamps, st.just(names), numbers_of, numbers_of, numbers_of, words)


def forces(names):
    return st.builds(messages.Forces, stamps, st.just(names), lists_like(names, st.tuples(*(numbers,) * 3)), words)


status = st.builds(messages.Status, st.integers(0, 3), words, words, st.just((('key', 'value'),)), words)
VALUES = {
    'sensor_msgs/msg/JointState': name_lists.flatmap(joints),
    'sensor_msgs/msg/MultiDOFJointState': name_lists.flatmap(forces),
    'sensor_msgs/msg/TimeReference': st.builds(
        messages.Step, stamps, stamps, st.sampled_from(((), ('a',), ('a', 'b')))
    ),
    'sensor_msgs/msg/Imu': st.builds(messages.Imu, stamps, angles, angles, *(numbers,) * 4, words),
    'nav_msgs/msg/Odometry': st.builds(
        messages.Odometry, stamps, numbers, numbers, angles, *(numbers,) * 3, words, words
    ),
    'geometry_msgs/msg/PointStamped': st.builds(messages.Point, stamps, *(numbers,) * 3, words),
    'geometry_msgs/msg/Vector3Stamped': st.builds(messages.Vector, stamps, *(numbers,) * 3, words),
    'geometry_msgs/msg/TwistStamped': st.builds(messages.Twist, stamps, *(numbers,) * 3, words),
    'geometry_msgs/msg/WrenchStamped': st.builds(messages.Wrench, stamps, *(numbers,) * 6, words),
    'rosgraph_msgs/msg/Clock': st.builds(messages.Clock, stamps),
    'std_msgs/msg/Bool': st.builds(messages.Flag, st.booleans()),
    'std_msgs/msg/String': st.builds(messages.Text, words),
    'diagnostic_msgs/msg/DiagnosticArray': st.builds(messages.Diagnostics, stamps, st.tuples(status), words),
}


def big_endian(type_name, data):
    """Return the message in the other byte order, made by rosbags."""
    return bytes(TYPESTORE.serialize_cdr(TYPESTORE.deserialize_cdr(data, type_name), type_name, little_endian=False))


@st.composite
def recordings(draw, type_name):
    """Give messages: runs of one layout with new numbers, in between others, byte-swapped, padded, cut short."""
    few = [encode(type_name, value) for value in draw(st.lists(VALUES[type_name], min_size=1, max_size=4))]
    more = [*few, few[0] + bytes(4), big_endian(type_name, few[0]), few[0][:2] + b'\1\2' + few[0][4:]]
    if draw(st.integers(0, 3)) == 0:
        more.append(draw(st.sampled_from((few[0][:-5], few[0] + bytes(40), b'', b'\0\1\0\0', b'\7' * 40))))
    runs = draw(st.lists(st.tuples(st.sampled_from(more), st.integers(1, 25)), min_size=1, max_size=6))
    return [data for data, count in runs for _ in range(count)]


def write(path, type_name, recorded):
    with path.open('wb') as file:
        writer = Writer(file, compression=CompressionType.LZ4)
        writer.start('ros2')
        channel = writer.register_channel(TOPIC, 'cdr', writer.register_schema(type_name, 'ros2msg', b''))
        for number, data in enumerate(recorded):
            writer.add_message(channel, number, data, number)
        writer.finish()
    return path


def slow(type_name, recorded):
    try:
        return make_columns(TOPIC, type_name, range(len(recorded)), [decode(type_name, data) for data in recorded])
    except MessageError as error:
        return str(error)


def fast(path, rows):
    try:
        parts = [columns for _, columns in read_blocks(path, rows=rows)]
    except BagError as error:
        return str(error).removeprefix(f'{path}: topic {TOPIC}: ')
    assert max(map(len, parts)) <= rows
    return join_columns(parts)


def assert_same(one, other):
    if isinstance(other, str):
        assert one == other
        return
    assert (one.names, list(one.arrays)) == (other.names, list(other.arrays))
    for name, column in other.arrays.items():
        assert one.arrays[name].dtype == column.dtype
        assert one.arrays[name].shape == column.shape
        if column.dtype == object:
            assert one.arrays[name].tolist() == column.tolist()
        else:
            assert_array_equal(one.arrays[name], column, strict=True)


def choose_walk(monkeypatch, kind):
    compiled = compiled_walk()
    if kind == 'compiled' and compiled is None:
        pytest.skip('numba is missing or switched off')
    monkeypatch.setattr(blocks, 'COMPILED_FROM', 0)
    monkeypatch.setattr(blocks, 'compiled_walk', lambda: compiled if kind == 'compiled' else None)


KINDS = ['plain', 'compiled']


@pytest.fixture(params=KINDS)
def walk(request, monkeypatch):
    choose_walk(monkeypatch, request.param)


def test_every_type_is_tried():
    assert VALUES.keys() == VALUE_TYPES.keys()


@pytest.mark.parametrize('type_name', sorted(VALUE_TYPES))
def test_every_value_is_that_of_the_slow_decoder(type_name, tmp_path):
    @settings(deadline=None, max_examples=25)
    @given(recordings(type_name), st.sampled_from((20, blocks.ROWS)))
    def check(recorded, rows):
        path, expected = write(tmp_path / 'x.mcap', type_name, recorded), slow(type_name, recorded)
        for kind in KINDS if compiled_walk() else KINDS[:1]:
            with pytest.MonkeyPatch.context() as monkeypatch:
                choose_walk(monkeypatch, kind)
                assert_same(fast(path, rows), expected)

    check()


def test_a_whole_vehicle_is_read_like_message_by_message(bag, sent, walk):
    read = {}
    for topic, columns in read_blocks(bag, rows=50):
        read.setdefault(topic, []).append(columns)
    for topic, parts in read.items():
        own = [message for message in sent if message.topic == topic]
        values = [decode(message.type_name, message.data) for message in own]
        assert_same(
            join_columns(parts), make_columns(topic, own[0].type_name, [message.stamp for message in own], values)
        )
    assert read.keys() == {message.topic for message in sent}


def test_topics_that_are_not_asked_for_need_not_make_sense(tmp_path, walk):
    with BagWriter(tmp_path / 'bag') as writer:
        for topic in ('/good', '/bad'):
            writer.add_topic(topic, CLOCK, interface.STATE)
        for number in range(30):
            writer.write('/good', encode(CLOCK, messages.Clock(number)), number)
            writer.write('/bad', b'?', number)
    ((topic, columns),) = read_blocks(tmp_path / 'bag', ['/good'])
    assert (topic, columns.stamp_ns.tolist()) == ('/good', list(range(30)))
    with pytest.raises(BagError, match='topic /bad: rosgraph_msgs/msg/Clock: begins with 3f'):
        list(read_blocks(tmp_path / 'bag'))


@pytest.mark.parametrize('cut', range(40, 4000, 331))
def test_a_bag_that_breaks_off_gives_what_a_stream_gives(tmp_path, bag, walk, cut):
    content = (bag / 'drive_0.mcap').read_bytes()
    (tmp_path / 'cut.mcap').write_bytes(content[: len(content) * cut // 4000])
    stream, other = blocks.read_messages(tmp_path / 'cut.mcap'), blocks.read_messages(tmp_path / 'cut.mcap')
    count = sum(len(columns) for _, columns in blocks.checked_blocks(stream, tmp_path))
    assert count == sum(1 for _ in other) == stream.count
    assert stream.damage == other.damage != []


def peak_of(path):
    tracemalloc.start()
    try:
        last = 0
        for _, columns in read_blocks(path):
            last = columns.log_time_ns[-1]
        return last, tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def test_memory_does_not_grow_with_the_bag(tmp_path, walk):
    """The larger bag holds 3.6 MB of messages more than the smaller one."""
    data = encode('nav_msgs/msg/Odometry', messages.Odometry(1, 1.0, 2.0, 0.1, 3.0, 0.0, 0.5))
    peaks = {}
    for count in (5_000, 5_000, 10_000):  # what is compiled and cached the first time stays
        path = write(tmp_path / 'x.mcap', 'nav_msgs/msg/Odometry', [data] * count)
        last, peaks[count] = peak_of(path)
        assert last == count - 1
    assert peaks[10_000] - peaks[5_000] < 2**20
