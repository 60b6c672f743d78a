"""Messages against rclpy's and rosbags' own serialisation, and against bytes that are not messages."""

import math

import pytest
from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from geometry_msgs.msg import PointStamped, Transform, TwistStamped, Vector3Stamped, WrenchStamped
from geometry_msgs.msg import Wrench as RosWrench
from hypothesis import given, settings
from hypothesis import strategies as st
from nav_msgs.msg import Odometry as RosOdometry
from rclpy.serialization import deserialize_message, serialize_message
from rosbags.typesys import Stores, get_typestore
from rosgraph_msgs.msg import Clock as RosClock
from sensor_msgs.msg import Imu as RosImu
from sensor_msgs.msg import JointState, MultiDOFJointState, TimeReference
from std_msgs.msg import Bool, String

from omni_vehicle_ros import messages
from omni_vehicle_ros.errors import MessageError
from omni_vehicle_ros.messages import decode, encode
from omni_vehicle_ros.messages.cdr import HEADER
from omni_vehicle_ros.messages.codec import KEPT_LAYOUTS
from omni_vehicle_ros.messages.codecs import CODECS

pytestmark = pytest.mark.filterwarnings("ignore:module 'sre_:DeprecationWarning")  # rosidl imports lark

TYPESTORE = get_typestore(Stores.ROS2_JAZZY)
SECOND = 10**9


def ros_time(stamp):
    """Return the ROS time of a stamp."""
    return Time(sec=stamp // SECOND, nanosec=stamp % SECOND)


def stamped(message_type, value):
    """Return an rclpy message with the stamp, and the frame where there is one."""
    message = message_type()
    message.header.stamp = ros_time(value.stamp)
    message.header.frame_id = getattr(value, 'frame', '')
    return message


def ros_joints(value):
    """Return rclpy's message."""
    message = stamped(JointState, value)
    message.name = list(value.names)
    message.position, message.velocity, message.effort = value.position, value.velocity, value.effort
    return message


def ros_point(value):
    """Return rclpy's message."""
    message = stamped(PointStamped, value)
    message.point.x, message.point.y, message.point.z = value.x, value.y, value.z
    return message


def ros_vector(value):
    """Return rclpy's message."""
    message = stamped(Vector3Stamped, value)
    message.vector.x, message.vector.y, message.vector.z = value.x, value.y, value.z
    return message


def ros_twist(value):
    """Return rclpy's message."""
    message = stamped(TwistStamped, value)
    message.twist.linear.x, message.twist.linear.y = value.vx, value.vy
    message.twist.angular.z = value.yaw_rate
    return message


def ros_wrench(value):
    """Return rclpy's message."""
    message = stamped(WrenchStamped, value)
    force, torque = message.wrench.force, message.wrench.torque
    force.x, force.y, force.z = value.fx, value.fy, value.fz
    torque.x, torque.y, torque.z = value.tx, value.ty, value.tz
    return message


def ros_forces(value):
    """Return rclpy's message."""
    message = stamped(MultiDOFJointState, value)
    message.joint_names = list(value.names)
    for x, y, z in value.forces:
        wrench = RosWrench()
        wrench.force.x, wrench.force.y, wrench.force.z = x, y, z
        message.wrench.append(wrench)
    return message


def ros_odometry(value):
    """Return rclpy's message."""
    message = stamped(RosOdometry, value)
    message.child_frame_id = value.child_frame
    pose, twist = message.pose.pose, message.twist.twist
    pose.position.x, pose.position.y = value.x, value.y
    pose.orientation.z, pose.orientation.w = math.sin(value.heading / 2), math.cos(value.heading / 2)
    twist.linear.x, twist.linear.y, twist.angular.z = value.vx, value.vy, value.yaw_rate
    return message


def ros_imu(value):
    """Return rclpy's message: the quaternion product of heading about z and roll about x."""
    message = stamped(RosImu, value)
    half_heading, half_roll = value.heading / 2, value.roll / 2
    orientation, acceleration = message.orientation, message.linear_acceleration
    orientation.w = math.cos(half_heading) * math.cos(half_roll)
    orientation.x = math.cos(half_heading) * math.sin(half_roll)
    orientation.y = math.sin(half_heading) * math.sin(half_roll)
    orientation.z = math.sin(half_heading) * math.cos(half_roll)
    message.angular_velocity.z = value.yaw_rate
    acceleration.x, acceleration.y, acceleration.z = value.ax, value.ay, value.az
    return message


def ros_clock(value):
    """Return rclpy's message."""
    return RosClock(clock=ros_time(value.stamp))


def ros_step(value):
    """Return rclpy's message."""
    message = stamped(TimeReference, value)
    message.time_ref, message.source = ros_time(value.end), ' '.join(value.topics)
    return message


def ros_text(value):
    """Return rclpy's message."""
    return String(data=value.data)


def ros_flag(value):
    """Return rclpy's message."""
    return Bool(data=value.data)


def ros_diagnostics(value):
    """Return rclpy's message."""
    message = stamped(DiagnosticArray, value)
    for status in value.statuses:
        message.status.append(
            DiagnosticStatus(
                level=bytes([status.level]), name=status.name, message=status.message,
                hardware_id=status.hardware_id, values=[KeyValue(key=key, value=text) for key, text in status.values],
            )
        )
    return message


numbers = st.floats(allow_nan=False, width=64)
any_numbers = st.floats(width=64)
angles = st.floats(-3.141592, 3.141592)
stamps = st.integers(0, (2**31 - 1) * SECOND)
texts = st.text(st.characters(exclude_categories=['Cs'], exclude_characters='\0'), max_size=12)
names = st.lists(texts, max_size=9).map(tuple)
words = st.lists(st.from_regex(r'[a-z_]+(/[a-z_]+)?', fullmatch=True), max_size=5).map(tuple)


def arrays(elements):
    """Generate tuples of numbers."""
    return st.lists(elements, max_size=9).map(tuple)


def cases(real):
    """Generate values of every type; ``real`` makes their numbers."""
    pairs = st.lists(st.tuples(texts, texts), max_size=3).map(tuple)
    status = st.builds(messages.Status, st.integers(0, 255), texts, texts, pairs, texts)
    triples = st.lists(st.tuples(real, real, real), max_size=5).map(tuple)
    return {
        'sensor_msgs/msg/JointState': (
            ros_joints, st.builds(messages.Joints, stamps, names, arrays(real), arrays(real), arrays(real), texts),
        ),
        'geometry_msgs/msg/PointStamped': (ros_point, st.builds(messages.Point, stamps, real, real, real, texts)),
        'geometry_msgs/msg/Vector3Stamped': (ros_vector, st.builds(messages.Vector, stamps, real, real, real, texts)),
        'geometry_msgs/msg/TwistStamped': (ros_twist, st.builds(messages.Twist, stamps, real, real, real, texts)),
        'geometry_msgs/msg/WrenchStamped': (
            ros_wrench, st.builds(messages.Wrench, stamps, real, real, real, real, real, real, texts),
        ),
        'sensor_msgs/msg/MultiDOFJointState': (
            ros_forces, st.builds(messages.Forces, stamps, names, triples, texts),
        ),
        'nav_msgs/msg/Odometry': (
            ros_odometry, st.builds(messages.Odometry, stamps, real, real, angles, real, real, real, texts, texts),
        ),
        'sensor_msgs/msg/Imu': (
            ros_imu,
            st.builds(messages.Imu, stamps, st.floats(-1.5, 1.5), angles, real, real, real, real, texts),
        ),
        'rosgraph_msgs/msg/Clock': (ros_clock, st.builds(messages.Clock, stamps)),
        'sensor_msgs/msg/TimeReference': (ros_step, st.builds(messages.Step, stamps, stamps, words)),
        'std_msgs/msg/Bool': (ros_flag, st.builds(messages.Flag, st.booleans())),
        'std_msgs/msg/String': (ros_text, st.builds(messages.Text, texts)),
        'diagnostic_msgs/msg/DiagnosticArray': (
            ros_diagnostics,
            st.builds(messages.Diagnostics, stamps, st.lists(status, max_size=3).map(tuple), texts),
        ),
    }


CASES = cases(numbers)
WILD_CASES = cases(any_numbers)
TYPES = sorted(CASES)
some = settings(deadline=None, max_examples=20)


def assert_same(value, expected):
    """Compare two values; angles went through a quaternion, which costs them some 1e-16."""
    assert type(value) is type(expected)
    for field, got, wanted in zip(value._fields, value, expected, strict=True):
        if field in ('heading', 'roll'):
            assert got == pytest.approx(wanted, abs=1e-14)
        else:
            assert got == wanted, field


def test_every_type_is_tested():
    assert set(CASES) == set(messages.VALUE_TYPES)


@pytest.mark.parametrize('type_name', TYPES)
@some
@given(data=st.data())
def test_rclpy_reads_what_is_encoded(type_name, data):
    to_ros, values = CASES[type_name]
    value = data.draw(values)
    expected = to_ros(value)
    assert deserialize_message(encode(type_name, value), type(expected)) == expected


@pytest.mark.parametrize('type_name', TYPES)
@some
@given(data=st.data())
def test_what_rclpy_writes_is_decoded(type_name, data):
    to_ros, values = CASES[type_name]
    value = data.draw(values)
    content = serialize_message(to_ros(value))
    assert_same(decode(type_name, content), value)
    assert_same(decode(type_name, content), value)


@pytest.mark.parametrize('type_name', TYPES)
@some
@given(data=st.data())
def test_bytes_are_those_of_rosbags(type_name, data):
    content = encode(type_name, data.draw(CASES[type_name][1]))
    message = TYPESTORE.deserialize_cdr(content, type_name)
    expected = bytes(TYPESTORE.serialize_cdr(message, type_name))
    assert content == expected + bytes(-len(expected) % 4)  # whole words, as on the wire


@pytest.mark.parametrize('type_name', TYPES)
@some
@given(data=st.data())
def test_big_endian_is_decoded(type_name, data):
    value = data.draw(CASES[type_name][1])
    message = TYPESTORE.deserialize_cdr(encode(type_name, value), type_name)
    content = bytes(TYPESTORE.serialize_cdr(message, type_name, little_endian=False))
    assert content[:2] == b'\0\0'
    assert_same(decode(type_name, content), value)


@pytest.mark.parametrize('type_name', TYPES)
@some
@given(data=st.data())
def test_not_a_number_and_infinity_keep_every_bit(type_name, data):
    value = data.draw(WILD_CASES[type_name][1])
    content = encode(type_name, value)
    exact_angles = {angle: getattr(value, angle) for angle in ('heading', 'roll') if hasattr(value, angle)}
    assert encode(type_name, decode(type_name, content)._replace(**exact_angles)) == content


@pytest.mark.parametrize('type_name', TYPES)
@some
@given(data=st.data())
def test_padding_at_the_end_is_ignored(type_name, data):
    value = data.draw(CASES[type_name][1])
    content = encode(type_name, value)
    padding = data.draw(st.binary(max_size=3))
    assert_same(decode(type_name, content + padding), value)
    with pytest.raises(MessageError, match='after its end'):
        decode(type_name, content + bytes(16))


@pytest.mark.parametrize('type_name', TYPES)
@some
@given(data=st.data())
def test_truncated_messages_are_refused(type_name, data):
    content = encode(type_name, data.draw(CASES[type_name][1]))
    with pytest.raises(MessageError, match=type_name):
        decode(type_name, content[: data.draw(st.integers(0, len(content) - 4))])  # 3 may be padding


@pytest.mark.parametrize('type_name', TYPES)
@settings(deadline=None, max_examples=50)
@given(data=st.data())
def test_damaged_messages_are_refused_or_decoded(type_name, data):
    content = bytearray(encode(type_name, data.draw(CASES[type_name][1])))
    for _ in range(data.draw(st.integers(1, 4))):
        content[data.draw(st.integers(0, len(content) - 1))] ^= 1 << data.draw(st.integers(0, 7))
    try:
        value = decode(type_name, bytes(content))
    except MessageError:
        return
    assert isinstance(value, messages.VALUE_TYPES[type_name])


@pytest.mark.parametrize('type_name', TYPES)
@settings(deadline=None, max_examples=50)
@given(begin=st.sampled_from([b'', bytes(4), HEADER, HEADER + bytes(8) + b'\1\0\0\0']), rest=st.binary(max_size=300))
def test_arbitrary_bytes_are_refused_or_decoded(type_name, begin, rest):
    try:
        value = decode(type_name, begin + rest)
    except MessageError:
        return
    assert isinstance(value, messages.VALUE_TYPES[type_name])


def test_a_huge_sequence_is_refused_before_it_is_read():
    content = b'\0\1\0\0' + bytes(8) + b'\1\0\0\0\0\0\0\0' + b'\xff\xff\xff\xff'
    with pytest.raises(MessageError, match='sequence of 4294967295'):
        decode('sensor_msgs/msg/JointState', content)


same = st.just((1.0,) * 4)
none = st.just(())
wheel_names = st.permutations(['front_left', 'front_right', 'rear_left', 'rear_right']).map(tuple)


@some
@given(st.lists(st.builds(messages.Joints, stamps, wheel_names, same, none, none, st.sampled_from('ab'))))
def test_messages_of_equal_length_are_told_apart(values):
    type_name = 'sensor_msgs/msg/JointState'
    contents = [encode(type_name, value) for value in values]
    assert len({len(content) for content in contents}) <= 1
    assert [decode(type_name, content) for content in contents] == values


def test_array_lengths_are_told_apart_at_equal_length():
    type_name = 'sensor_msgs/msg/JointState'
    short, long = (1.0, 2.0), (1.0, 2.0, 3.0, 4.0)
    values = [
        messages.Joints(5, ('a',), first, second, third)
        for first, second, third in ((short, long, long), (long, short, long), (long, long, short))
    ]
    for value in values * 2:
        assert decode(type_name, encode(type_name, value)) == value


def test_ever_new_names_do_not_fill_the_memory():
    type_name = 'geometry_msgs/msg/PointStamped'
    codec = CODECS[type_name]
    for number in range(4 * KEPT_LAYOUTS):
        value = messages.Point(number, 1.0, 2.0, 3.0, f'frame_{number}')
        assert decode(type_name, encode(type_name, value)) == value
    assert len(codec._by_shape) <= KEPT_LAYOUTS
    assert sum(map(len, codec._by_length.values())) <= KEPT_LAYOUTS


def test_long_messages_are_read_and_not_kept():
    """A kept layout takes more than its message: of a flood of long ones nothing stays."""
    type_name = 'sensor_msgs/msg/JointState'
    names = tuple(f'joint_{number}' for number in range(1000))
    value = messages.Joints(5, names, tuple(map(float, range(1000))))
    data = encode(type_name, value)
    codec = CODECS[type_name]
    codec._by_shape.clear()
    assert decode(type_name, data) == value
    assert not codec._by_shape
    assert len(data) not in codec._by_length


def test_unused_fields_are_ignored():
    twist = messages.Twist(7 * SECOND, 1.0, 2.0, 3.0)
    message = ros_twist(twist)
    message.twist.linear.z = message.twist.angular.x = math.nan
    assert decode('geometry_msgs/msg/TwistStamped', serialize_message(message)) == twist
    forces = messages.Forces(7 * SECOND, ('a',), ((1.0, 2.0, 3.0),))
    message = ros_forces(forces)
    message.transforms, message.twist = [Transform()] * 2, [TwistStamped().twist] * 3
    assert decode('sensor_msgs/msg/MultiDOFJointState', serialize_message(message)) == forces


@some
@given(st.floats(-1e3, 1e3))
def test_heading_is_read_within_one_turn(heading):
    value = messages.Odometry(0, 0.0, 0.0, heading, 0.0, 0.0, 0.0)
    read = decode('nav_msgs/msg/Odometry', encode('nav_msgs/msg/Odometry', value)).heading
    assert -math.pi <= read <= math.pi
    assert math.sin(read - heading) == pytest.approx(0.0, abs=1e-12)
    assert math.cos(read - heading) == pytest.approx(1.0)


@some
@given(st.floats(-1.5, 1.5), angles, st.floats(0.1, 10.0))
def test_orientation_need_not_have_unit_length(roll, heading, length):
    message = ros_imu(messages.Imu(0, roll, heading, 0.0, 0.0, 0.0, 0.0))
    for axis in 'xyzw':
        setattr(message.orientation, axis, length * getattr(message.orientation, axis))
    value = decode('sensor_msgs/msg/Imu', serialize_message(message))
    assert value.roll == pytest.approx(roll, abs=1e-13)
    assert value.heading == pytest.approx(heading, abs=1e-13)


@pytest.mark.parametrize(
    ('type_name', 'value'),
    [
        ('rosgraph_msgs/msg/Clock', messages.Clock(2**31 * SECOND)),
        ('rosgraph_msgs/msg/Clock', messages.Clock(1.5)),
        ('geometry_msgs/msg/PointStamped', messages.Point(0, 'east', 0.0)),
        ('geometry_msgs/msg/PointStamped', messages.Point(0, 1.0, 2.0, 3.0, 'a\0b')),
        ('geometry_msgs/msg/PointStamped', messages.Text('a')),
        ('sensor_msgs/msg/JointState', messages.Joints(0, ('\ud800',))),
        ('sensor_msgs/msg/JointState', None),
        ('nav_msgs/msg/Odometry', messages.Odometry(0, 0.0, 0.0, math.inf, 0.0, 0.0, 0.0)),
        ('sensor_msgs/msg/TimeReference', messages.Step(0, 0, ('two words',))),
        ('std_msgs/msg/String', messages.Text(3)),
        ('diagnostic_msgs/msg/DiagnosticArray', messages.Diagnostics(0, (messages.Status(256, '', ''),))),
    ],
)
def test_what_does_not_fit_is_refused(type_name, value):
    with pytest.raises(MessageError, match=f'{type_name}: .* can not be encoded: .'):
        encode(type_name, value)


def test_unknown_types_are_named_with_the_known_ones():
    for call in (lambda: encode('std_msgs/msg/Char', None), lambda: decode('std_msgs/msg/Char', b'')):
        with pytest.raises(MessageError, match=r'std_msgs/msg/Char.*geometry_msgs/msg/PointStamped'):
            call()


def test_texts_that_are_no_texts_are_refused():
    for content in (b'\2\0\0\0\xff\0', b'\3\0\0\0a\0\0', b'\1\0\0\0a'):
        with pytest.raises(MessageError, match='text'):
            decode('std_msgs/msg/String', b'\0\1\0\0' + content)
    assert decode('std_msgs/msg/String', b'\0\1\0\0' + bytes(4)) == messages.Text('')
