"""Independent readers of our bags agree with ours, value by value: rosbags, mcap with mcap-ros2-support, Foxglove's."""

import json
import math
import os
import shutil
import subprocess
from pathlib import Path

import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from numpy.testing import assert_array_equal
from rosbags.highlevel import AnyReader

from omni_vehicle_ros import interface, messages
from omni_vehicle_ros.bags import BagWriter, open_bag, read_messages
from omni_vehicle_ros.messages import decode, encode
from omni_vehicle_ros.wheels import WHEELS

NPM_PACKAGES = ('@mcap/core@2.2.2', '@foxglove/rosmsg@5.0.5', '@foxglove/rosmsg2-serialization@3.1.0', 'fzstd@0.1.1')
NPM_LIMIT = 90  # s
SECOND = 1_000_000_000


def value_of(type_name, stamp):
    """Return a value with something of its own in every field."""
    k = stamp * 1e-9
    return {
        'sensor_msgs/msg/JointState': messages.Joints(
            stamp, WHEELS, (k, -0.1, 1e-300, 3.5), (1 / 3, 2.0, -0.0, 1e300), (0.1, 0.2), 'base_link'
        ),
        'sensor_msgs/msg/MultiDOFJointState': messages.Forces(stamp, WHEELS, ((k, 2.0, 3.0),) * 3 + ((0.1, 0.2, 0.3),)),
        'sensor_msgs/msg/TimeReference': messages.Step(stamp, stamp + 3 * SECOND + 1, ('a', 'driver/icr')),
        'sensor_msgs/msg/Imu': messages.Imu(stamp, 0.05, 0.5, k, 0.1, -0.2, 9.81),
        'nav_msgs/msg/Odometry': messages.Odometry(stamp, k, -k, 0.7, 4.0, 0.1, 1 / 7),
        'geometry_msgs/msg/PointStamped': messages.Point(stamp, k, 2.0, 3.0),
        'geometry_msgs/msg/Vector3Stamped': messages.Vector(stamp, k, 2.0, 3.0),
        'geometry_msgs/msg/TwistStamped': messages.Twist(stamp, k, 2.0, 3.0),
        'geometry_msgs/msg/WrenchStamped': messages.Wrench(stamp, k, 2.0, 3.0, 4.0, 5.0, 6.0),
        'rosgraph_msgs/msg/Clock': messages.Clock(stamp),
        'std_msgs/msg/Bool': messages.Flag(k % 2 == 0),
        'std_msgs/msg/String': messages.Text(f'Grüße {k}'),
        'diagnostic_msgs/msg/DiagnosticArray': messages.Diagnostics(
            stamp,
            (messages.Status(2, 'plant', f'at {k} s', (('key', 'ä'), ('', ''))), messages.Status(0, 'a', '', (), 'id')),
        ),
    }[type_name]


@pytest.fixture(scope='module', params=['zstd', 'none'])
def everything(request, tmp_path_factory):
    """Return a bag with messages of every topic of the vehicle."""
    directory = tmp_path_factory.mktemp('readers') / request.param
    with BagWriter(directory, compression=request.param) as writer:
        for row in interface.TOPICS:
            writer.add_topic(interface.resolve(row.name, ''), row.type, row.qos)
        for stamp in (5_000_000, 2 * SECOND, 3 * SECOND + 999_999_999):
            for row in interface.TOPICS:
                data = encode(row.type, value_of(row.type, stamp))
                writer.write(interface.resolve(row.name, ''), data, stamp)
    return directory


def tree(value):
    """Return a message as dictionaries and lists of plain values."""
    if isinstance(value, bytes):
        return value[0] if len(value) == 1 else list(value)
    if hasattr(value, 'tolist'):
        return value.tolist()
    if isinstance(value, (list, tuple)):
        return [tree(each) for each in value]
    names = getattr(value, '__slots__', None) or getattr(value, '__dataclass_fields__', None)
    if names:
        return {name: tree(getattr(value, name)) for name in names if not name.startswith('__')}
    return value


def nanoseconds(stamp):
    return stamp['sec'] * SECOND + stamp.get('nanosec', stamp.get('nsec', 0))


def triple(point):
    return point['x'], point['y'], point['z']


def roll_and_heading(q):
    roll = math.atan2(2 * (q['w'] * q['x'] + q['y'] * q['z']), 1 - 2 * (q['x'] ** 2 + q['y'] ** 2))
    return roll, math.atan2(2 * (q['w'] * q['z'] + q['x'] * q['y']), 1 - 2 * (q['y'] ** 2 + q['z'] ** 2))


def joints(m, head):
    columns = (tuple(m[name]) for name in ('position', 'velocity', 'effort'))
    return messages.Joints(head[0], tuple(m['name']), *columns, head[1])


def odometry(m, head):
    pose, twist = m['pose']['pose'], m['twist']['twist']
    x, y, _ = triple(pose['position'])
    vx, vy, _ = triple(twist['linear'])
    heading = pytest.approx(roll_and_heading(pose['orientation'])[1], abs=1e-12)
    return messages.Odometry(head[0], x, y, heading, vx, vy, twist['angular']['z'], head[1], m['child_frame_id'])


def imu(m, head):
    turned = (pytest.approx(angle, abs=1e-12) for angle in roll_and_heading(m['orientation']))
    return messages.Imu(head[0], *turned, m['angular_velocity']['z'], *triple(m['linear_acceleration']), head[1])


def diagnostics(m, head):
    found = tuple(
        messages.Status(
            s['level'], s['name'], s['message'], tuple((v['key'], v['value']) for v in s['values']), s['hardware_id']
        )
        for s in m['status']
    )
    return messages.Diagnostics(head[0], found, head[1])


MAKERS = {
    'sensor_msgs/msg/JointState': joints,
    'sensor_msgs/msg/MultiDOFJointState': lambda m, h: messages.Forces(
        h[0], tuple(m['joint_names']), tuple(triple(wrench['force']) for wrench in m['wrench']), h[1]
    ),
    'sensor_msgs/msg/TimeReference': lambda m, h: messages.Step(
        h[0], nanoseconds(m['time_ref']), tuple(m['source'].split())
    ),
    'sensor_msgs/msg/Imu': imu,
    'nav_msgs/msg/Odometry': odometry,
    'geometry_msgs/msg/PointStamped': lambda m, h: messages.Point(h[0], *triple(m['point']), h[1]),
    'geometry_msgs/msg/Vector3Stamped': lambda m, h: messages.Vector(h[0], *triple(m['vector']), h[1]),
    'geometry_msgs/msg/TwistStamped': lambda m, h: messages.Twist(
        h[0], *triple(m['twist']['linear'])[:2], m['twist']['angular']['z'], h[1]
    ),
    'geometry_msgs/msg/WrenchStamped': lambda m, h: messages.Wrench(
        h[0], *triple(m['wrench']['force']), *triple(m['wrench']['torque']), h[1]
    ),
    'rosgraph_msgs/msg/Clock': lambda m, h: messages.Clock(nanoseconds(m['clock'])),
    'std_msgs/msg/Bool': lambda m, h: messages.Flag(m['data']),
    'std_msgs/msg/String': lambda m, h: messages.Text(m['data']),
    'diagnostic_msgs/msg/DiagnosticArray': diagnostics,
}


def check(bag, found):
    """Compare what another reader found, as (topic, type, log time, tree), with ours."""
    ours = [(m.topic, m.type_name, m.log_time, decode(m.type_name, m.data)) for m in read_messages(bag)]
    theirs = []
    for topic, type_name, log_time, message in found:
        header = message.get('header')
        head = header and (nanoseconds(header['stamp']), header['frame_id'])
        theirs.append((topic, type_name, log_time, MAKERS[type_name](message, head)))
    assert len(ours) == 3 * len(interface.TOPICS)
    assert sorted(theirs, key=lambda row: (row[2], row[0])) == sorted(ours, key=lambda row: (row[2], row[0]))


def test_rosbags_agrees(everything):
    with AnyReader([everything]) as reader:
        check(
            everything,
            [(c.topic, c.msgtype, time, tree(reader.deserialize(d, c.msgtype))) for c, time, d in reader.messages()],
        )


def test_mcap_with_its_ros2_support_agrees(everything):
    with (everything / f'{everything.name}_0.mcap').open('rb') as file:
        reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        found = reader.iter_decoded_messages()
        check(everything, [(c.topic, s.name, m.log_time, tree(value)) for s, c, m, value in found])


def test_the_readers_of_foxglove_agree(everything, foxglove):
    command = ['node', str(Path(__file__).with_name('read_bag.mjs')), str(foxglove) + os.sep]
    path = everything / f'{everything.name}_0.mcap'
    done = subprocess.run([*command, str(path)], capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stderr
    rows = [json.loads(line) for line in done.stdout.splitlines()]
    check(everything, [(topic, type_name, int(time), value) for topic, type_name, time, value in rows])


def test_columns_agree_with_rosbags(everything):
    opened = open_bag(everything)
    with AnyReader([everything]) as reader:
        odom = [reader.deserialize(d, c.msgtype) for c, _, d in reader.messages() if c.topic == '/odom']
        slip = [reader.deserialize(d, c.msgtype) for c, _, d in reader.messages() if c.topic == '/tyres/side_slip']
    assert_array_equal(opened['odom'].x, [each.pose.pose.position.x for each in odom])
    assert_array_equal(opened['odom'].yaw_rate, [each.twist.twist.angular.z for each in odom])
    assert_array_equal(opened['tyres/side_slip'].position, [each.position for each in slip])
    assert_array_equal(opened['tyres/side_slip'].velocity, [each.velocity for each in slip])


@pytest.fixture(scope='session')
def foxglove(tmp_path_factory):
    """Install Foxglove's readers into a temporary folder and return it."""
    npm = shutil.which('npm')
    if not npm or not shutil.which('node'):
        pytest.skip('node and npm are not installed')
    folder = tmp_path_factory.mktemp('foxglove')
    (folder / 'package.json').write_text('{"private": true}', encoding='utf-8')
    options = ['--ignore-scripts', '--no-audit', '--no-fund', '--fetch-retries=0', '--prefer-offline']
    try:
        done = subprocess.run(
            [npm, 'install', *options, *NPM_PACKAGES],
            cwd=folder, capture_output=True, text=True, timeout=NPM_LIMIT, check=False,
        )
    except subprocess.TimeoutExpired:
        pytest.skip(f'npm did not install {", ".join(NPM_PACKAGES)} within {NPM_LIMIT} s')
    if done.returncode:
        reason = (done.stderr.strip() or 'no reason given').splitlines()[-1]
        pytest.skip(f'npm can not install {", ".join(NPM_PACKAGES)}: {reason}')
    return folder
