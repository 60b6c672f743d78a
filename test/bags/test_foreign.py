"""Messages of types that are not ours, as columns and tables, against mcap-ros2-support and what was written."""

import csv
import json
import math
import random
import struct
from functools import cache

import numpy as np
import pyarrow.parquet as parquet
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader
from mcap.writer import Writer
from mcap_ros2.decoder import DecoderFactory
from numpy.testing import assert_array_equal
from rosbags.interfaces import Nodetype
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as RosbagsWriter
from rosbags.typesys import Stores, get_typestore

from omni_vehicle_ros.bags import open_bag
from omni_vehicle_ros.bags.columns.export import export
from omni_vehicle_ros.bags.columns.foreign import ForeignType
from omni_vehicle_ros.bags.columns.topic_blocks import TopicBlocks
from omni_vehicle_ros.bags.metadata import SECOND
from omni_vehicle_ros.errors import BagError
from omni_vehicle_ros.messages import VALUE_TYPES

STORE = get_typestore(Stores.ROS2_JAZZY)
PACKAGES = ('diagnostic_msgs', 'geometry_msgs', 'nav_msgs', 'sensor_msgs', 'shape_msgs', 'std_msgs', 'trajectory_msgs')
TYPES = [
    name for name in sorted(STORE.fielddefs)
    if name.split('/')[0] in PACKAGES and name not in VALUE_TYPES and '/msg/' in name and name != 'std_msgs/msg/Empty'
]
SCAN = 'sensor_msgs/msg/LaserScan'
SPECIAL = (0.0, -0.0, math.nan, math.inf, -math.inf, 1 / 3)


def number(dice, kind):
    if kind == 'bool':
        return dice.random() < 0.5
    if kind.startswith('float'):
        value = dice.choice((*SPECIAL, dice.uniform(-1e30, 1e30)))
        return struct.unpack('f', struct.pack('f', value))[0] if kind == 'float32' else value
    if kind == 'char':
        return dice.randrange(128)  # beyond that mcap-ros2-support has it signed, unlike ROS 2
    limits = np.iinfo({'byte': 'int8'}.get(kind, kind))  # as rosbags writes it
    return dice.randint(int(limits.min), int(limits.max))


def made(dice, description):
    """Return a value of a field with something of its own."""
    kind, inner = description
    if kind == Nodetype.NAME:
        return message(dice, inner)
    if kind == Nodetype.BASE:
        if inner[0] in ('string', 'wstring'):
            return dice.choice(('', 'a', 'räder', 'with "quotes",\n; and lines'))
        return number(dice, inner[0])
    element, size = inner
    values = [made(dice, element) for _ in range(size if kind == Nodetype.ARRAY else dice.randrange(4))]
    if element[0] == Nodetype.BASE and 'string' not in element[1][0]:
        return np.array(values, {'char': 'uint8', 'byte': 'int8'}.get(element[1][0], element[1][0]))
    return values


def message(dice, type_name):
    if type_name in ('builtin_interfaces/msg/Time', 'builtin_interfaces/msg/Duration'):
        return STORE.types[type_name](dice.randrange(-(2**31), 2**31), dice.randrange(10**9))
    return STORE.types[type_name](*(made(dice, field) for _, field in STORE.fielddefs[type_name][1]))


def write(directory, messages, plugin=StoragePlugin.MCAP):
    """Write (topic, message), logged at 0, 1, 2, ... ns."""
    with RosbagsWriter(directory, version=9, storage_plugin=plugin) as writer:
        connections = {}
        for time, (topic, value) in enumerate(messages):
            name = value.__msgtype__
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, name, typestore=STORE)
            writer.write(connections[topic], time, STORE.serialize_cdr(value, name))
    return directory


def plain(value):
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, bytes):
        return list(value)
    if isinstance(value, (list, tuple, np.ndarray)):
        return [plain(each) for each in value]
    if isinstance(value, dict):
        return {name: plain(each) for name, each in value.items()}
    if hasattr(value, '__slots__') and not isinstance(value, (str, int, float)):
        return {name: plain(getattr(value, name)) for name in value.__slots__}
    return value


@cache
def leaves(type_name):
    return ForeignType(type_name, None).leaves


def field(value, leaf):
    for _, name in leaf.path:
        value = getattr(value, name)
    return plain(value)


@settings(deadline=None, max_examples=4, phases=[Phase.generate])  # a seed can not be made smaller
@given(st.integers(0, 2**32))
def test_every_value_is_that_of_mcap_ros2_support(tmp_path_factory, seed):
    dice = random.Random(seed)
    directory = write(
        tmp_path_factory.mktemp('bags') / 'bag',
        [(f'/t{number}', message(dice, name)) for _ in range(2) for number, name in enumerate(TYPES)],
    )
    theirs = {}
    with (directory / 'bag.mcap').open('rb') as file:
        for _, channel, _, value in make_reader(file, decoder_factories=[DecoderFactory()]).iter_decoded_messages():
            theirs.setdefault(channel.topic, []).append(value)
    blocks = TopicBlocks(directory)
    assert not list(blocks.ours(lambda topic: True))
    ours = {block.topic: block.columns for block in blocks.foreign(blocks.types)}
    assert len(theirs) == len(ours) == len(TYPES)
    for number, name in enumerate(TYPES):
        columns = ours[f'/t{number}']
        for column, leaf in leaves(name).items():
            found = columns.arrays[f'{column}_ns' if leaf.kind == 'time' else column].tolist()
            expected = [field(value, leaf) for value in theirs[f'/t{number}']]
            if leaf.kind == 'time':
                expected = [time['sec'] * SECOND + time.get('nanosec', time.get('nanosecs')) for time in expected]
            np.testing.assert_equal([plain(value) for value in found], expected, f'{name}.{column}')
        assert columns.log_time_ns.tolist() == [number, number + len(TYPES)]


@pytest.fixture(scope='module', params=StoragePlugin, ids=str)
def scans(request, tmp_path_factory):
    header = STORE.types['std_msgs/msg/Header'](STORE.types['builtin_interfaces/msg/Time'](3, 4), 'laser')
    twist = STORE.types['geometry_msgs/msg/Twist']
    vector = STORE.types['geometry_msgs/msg/Vector3']
    cloud = STORE.types['sensor_msgs/msg/PointCloud']
    point = STORE.types['geometry_msgs/msg/Point32']
    messages = [
        ('/scan', STORE.types[SCAN](header, *(0.5,) * 7, np.arange(n, dtype=np.float32), np.zeros(0, np.float32)))
        for n in (2, 0, 3)
    ]
    messages.append(('/cmd_vel', twist(vector(1.0, 2.0, 3.0), vector(0.0, 0.0, math.nan))))
    messages.append(('/cloud', cloud(header, [point(1.0, 2.0, 3.0)], [])))
    return write(tmp_path_factory.mktemp('scans') / 'bag', messages, request.param)


def test_a_foreign_topic_has_columns(scans):
    scan = open_bag(scans)['scan']
    assert scan.stamp_ns.tolist() == [3_000_000_004] * 3
    assert [ranges.tolist() for ranges in scan.ranges] == [[0.0, 1.0], [], [0.0, 1.0, 2.0]]
    assert (scan.angle_min.dtype, scan.angle_min.shape) == (np.float32, (3,))
    assert list(scan.header_frame_id) == ['laser'] * 3
    twist = open_bag(scans)['cmd_vel']
    assert (twist.linear_y.tolist(), twist.stamp_ns.tolist()) == ([2.0], [3])
    assert open_bag(scans)['cloud'].points[0] == [{'x': 1.0, 'y': 2.0, 'z': 3.0}]


def test_foreign_topics_are_exported_with_their_types_and_units(scans, tmp_path):
    found = export(scans, tmp_path)
    assert not found.skipped
    assert set(found.files.values()) == {3, 1}
    scan = parquet.read_table(tmp_path / 'scan.parquet')
    assert scan['ranges'].to_pylist() == [[0.0, 1.0], [], [0.0, 1.0, 2.0]]
    assert [str(scan.schema.field(name).type) for name in ('ranges', 'angle_min', 'stamp_ns')] == [
        'list<element: float>', 'float', 'int64',
    ]
    assert [scan.schema.field(name).metadata[b'unit'] for name in ('ranges', 'angle_min', 'stamp', 'intensities')] == [
        b'm', b'rad', b's', b'',
    ]
    twist = parquet.read_table(tmp_path / 'cmd_vel.parquet')
    assert_array_equal(twist['angular_z'].to_numpy(), [math.nan])
    assert twist.schema.field('angular_z').metadata == {b'unit': b'rad/s'}


def test_foreign_topics_are_exported_as_csv(scans, tmp_path):
    export(scans, tmp_path, kind='csv', topics=['/scan', '/cloud'])
    with (tmp_path / 'scan.csv').open(newline='') as file:
        assert [json.loads(row['ranges']) for row in csv.DictReader(file)] == [[0.0, 1.0], [], [0.0, 1.0, 2.0]]
    with (tmp_path / 'cloud.csv').open(newline='') as file:
        assert [json.loads(row['points']) for row in csv.DictReader(file)] == [[{'x': 1.0, 'y': 2.0, 'z': 3.0}]]
    assert json.loads((tmp_path / 'units.json').read_text())['scan.csv']['range_max'] == 'm'


def bare(path, rows):
    """Write an MCAP file of (topic, type, definition, encoding, message)."""
    with path.open('wb') as file:
        writer = Writer(file)
        writer.start('ros2')
        for time, (topic, name, definition, encoding, data) in enumerate(rows):
            schema = writer.register_schema(name, 'ros2msg', definition)
            writer.add_message(writer.register_channel(topic, encoding, schema), time, data, time)
        writer.finish()
    return path


HEADER = b'\0\1\0\0'


def test_fields_whose_columns_would_have_one_name_have_two(tmp_path):
    text = b'p/A a\nint8 a_b\nint8 stamp\nint8 log_time\n' + b'=' * 80 + b'\nMSG: p/A\nint8 b\n'
    path = bare(tmp_path / 'x.mcap', [('/t', 'p/msg/T', text, 'cdr', HEADER + bytes((1, 2, 3, 4)))])
    columns = open_bag(path)['t']
    assert len(columns) == 1
    assert [columns.arrays[name][0] for name in ('a_b', 'a_b_', 'stamp_', 'log_time_')] == [1, 2, 3, 4]


@pytest.mark.parametrize(
    ('definition', 'encoding', 'data', 'words'),
    [
        (b'int32', 'cdr', HEADER, 'is not defined in the bag in a way that can be read'),
        (b'p/Other a', 'cdr', HEADER, 'is not defined in the bag in a way that can be read'),
        (b'p/T a', 'cdr', HEADER, 'is not defined in the bag in a way that can be read'),
        (b'\xff', 'cdr', HEADER, 'is not defined in the bag in a way that can be read'),
        (b'int32[] a', 'cdr', HEADER + b'\xff\xff\xff\x7f', 'p/msg/T: '),
        (b'string[] a', 'cdr', HEADER + b'\xff\xff\xff\xff', 'p/msg/T: '),
        (b'int32 a', 'cdr', b'', 'p/msg/T: '),
        (b'int32 a', 'json', b'{}', "the encoding 'json' is not read here"),
    ],
)
def test_what_can_not_be_decoded_is_said_in_one_line_and_left_out(tmp_path, definition, encoding, data, words):
    path = bare(tmp_path / 'x.mcap', [('/t', 'p/msg/T', definition, encoding, data)] * 3)
    with pytest.raises(BagError, match='topic t: ') as raised:
        open_bag(path)['t']
    assert words in str(raised.value)
    assert len(str(raised.value).splitlines()) == 1
    assert words in export(path, tmp_path).skipped['/t']
    with pytest.raises(BagError, match='topic /t: '):
        export(path, tmp_path, topics=['/t'])
    assert [each.name for each in tmp_path.iterdir()] == ['x.mcap']


def test_topics_whose_files_would_have_one_name_have_two(tmp_path):
    text = b'int8 a'
    rows = [(topic, 'p/msg/T', text, 'cdr', HEADER + bytes((n,))) for n, topic in enumerate(('/a/b', '/a.b', 'a/b'))]
    found = export(bare(tmp_path / 'x.mcap', rows), tmp_path)
    assert sorted(path.name for path in found.files) == ['a.b.parquet', 'a.b_.parquet', 'a.b__.parquet']
    assert sorted(parquet.read_table(path)['a'].to_pylist() for path in found.files) == [[0], [1], [2]]
