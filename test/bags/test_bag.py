"""Columns of bags against the values that were written."""

import copy

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from omni_vehicle_ros import interface, messages
from omni_vehicle_ros.bags import BagWriter, open_bag
from omni_vehicle_ros.errors import BagError
from omni_vehicle_ros.messages import encode
from omni_vehicle_ros.wheels import WHEELS


@pytest.fixture(scope='module')
def opened(bag):
    return open_bag(bag)


def values_of(sent, topic):
    return [message.value for message in sent if message.topic == topic]


def write(directory, *messages_of_topics):
    """Write (full topic name, type name, value) with the stamps 1, 2, 3, ... ns as log times."""
    with BagWriter(directory) as writer:
        for number, (topic, type_name, value) in enumerate(messages_of_topics, start=1):
            writer.add_topic(topic, type_name, interface.STATE)
            data = value if isinstance(value, bytes) else encode(type_name, value)
            writer.write(topic, data, number)
    return directory


def test_numbers_are_columns(opened, sent):
    values, odom = values_of(sent, '/odom'), opened['odom']
    assert len(odom) == len(values)
    for field in ('x', 'y', 'vx', 'vy', 'yaw_rate'):
        assert_array_equal(getattr(odom, field), [getattr(value, field) for value in values])
    assert_allclose(odom.heading, [value.heading for value in values], atol=1e-14)
    assert_array_equal(odom.stamp_ns, [value.stamp for value in values])
    assert odom.stamp_ns.dtype == np.int64
    assert_allclose(odom.stamp, odom.stamp_ns / 1e9, rtol=1e-15)
    assert_array_equal(odom.log_time_ns, odom.stamp_ns)
    assert set(odom.child_frame) == {'base_link'}


def test_joints_are_columns_by_name(opened, sent):
    values, slip = values_of(sent, '/tyres/side_slip'), opened['tyres/side_slip']
    assert slip.names == WHEELS
    assert_array_equal(slip.position, [value.position for value in values])
    assert_array_equal(slip.effort, [value.effort for value in values])
    assert slip.velocity.shape == (len(values), 4)
    assert np.isnan(opened['joint_states'].effort).all()


def test_forces_are_columns_by_name(opened, sent):
    forces = opened['tyres/force'].forces
    assert forces.shape == (len(values_of(sent, '/tyres/force')), 4, 3)
    assert_array_equal(forces, [value.forces for value in values_of(sent, '/tyres/force')])


def test_joints_that_are_not_always_named_have_gaps(opened):
    friction = opened['environment/friction']
    assert friction.names == WHEELS
    expected = np.full((4, 4), np.nan)
    np.fill_diagonal(expected, [0.1, 0.2, 0.3, 0.4])
    assert_allclose(friction.effort, expected)


def test_joints_in_another_order_land_in_their_columns(tmp_path):
    type_name = 'sensor_msgs/msg/JointState'
    path = write(
        tmp_path / 'bag',
        ('/a', type_name, messages.Joints(1, ('x', 'y'), (1.0, 2.0))),
        ('/a', type_name, messages.Joints(2, ('y', 'x'), (2.0, 1.0))),
        ('/a', type_name, messages.Joints(3, ('y',))),
    )
    assert_array_equal(open_bag(path)['a'].position, [[1, 2], [1, 2], [np.nan, np.nan]])


def test_joints_with_too_few_numbers_are_not_numbers(tmp_path):
    type_name = 'sensor_msgs/msg/JointState'
    good, bad = messages.Joints(1, ('x', 'y'), (1.0, 2.0)), messages.Joints(2, ('x', 'y'), (1.0,))
    path = write(tmp_path / 'bag', ('/a', type_name, good), ('/a', type_name, bad))
    position = open_bag(path)['a'].position
    assert position[0].tolist() == [1.0, 2.0]
    assert np.isnan(position[1]).all()


def test_texts_are_columns_and_unstamped_messages_have_the_log_time(tmp_path, opened):
    texts = [('/ready', 'std_msgs/msg/String', messages.Text(text)) for text in ('plant', 'driver')]
    path = write(tmp_path / 'bag', *texts)
    ready = open_bag(path)['ready']
    assert list(ready.data) == ['plant', 'driver']
    assert list(ready.stamp_ns) == [1, 2]
    assert [status.message for status, in opened['/diagnostics'].statuses] == [f'cycle {n}' for n in (0, 60, 120, 180)]


def test_steps_have_their_end_as_time(tmp_path):
    step = messages.Step(1, 3 * 10**9, ('a', 'b'))
    path = write(tmp_path / 'bag', ('/driver/step', 'sensor_msgs/msg/TimeReference', step))
    step = open_bag(path)['driver/step']
    assert (step.end[0], step.end_ns[0], step.topics[0]) == (3.0, 3 * 10**9, ('a', 'b'))


def test_topics_are_listed_with_type_and_number(opened, sent):
    assert opened.complete
    assert opened.topics['odom'] == ('nav_msgs/msg/Odometry', len(values_of(sent, '/odom')))
    assert set(opened) == {row.name for row in interface.TOPICS if row.recorded}
    assert 'odom' in opened
    assert '/clock' in opened
    assert 'camera' not in opened


def test_topics_without_messages_have_empty_columns(opened):
    assert len(opened['environment/wind']) == 0
    assert opened['environment/wind'].y.shape == (0,)
    assert opened['front_left/state'].position.shape == (0, 0)


def test_unknown_topics_and_columns_are_named_with_those_there_are(opened):
    with pytest.raises(BagError, match="no topic 'odometry'; did you mean 'odom/truth'"):
        opened['odometry']
    with pytest.raises(AttributeError, match="no column 'speed'; there are stamp, stamp_ns, x, y, heading"):
        _ = opened['odom'].speed
    assert 'heading' in dir(opened['odom'])


def test_columns_can_be_copied(opened):
    assert_array_equal(copy.copy(opened['odom']).x, opened['odom'].x)


def test_a_topic_of_several_types_is_refused_when_asked_for(tmp_path):
    for number, type_name in enumerate(('geometry_msgs/msg/PointStamped', 'geometry_msgs/msg/Vector3Stamped')):
        write(tmp_path / 'bag' / str(number), ('/a', type_name, messages.Point(1, 2.0, 3.0)))
        (tmp_path / 'bag' / str(number) / f'{number}_0.mcap').rename(tmp_path / 'bag' / f'bag_{number}.mcap')
    with pytest.raises(BagError, match=r'topic a has several types: geometry_msgs/msg/PointStamped, geo'):
        open_bag(tmp_path / 'bag')['a']


CLOCK = 'rosgraph_msgs/msg/Clock'
JOINTS = 'sensor_msgs/msg/JointState'


def test_the_namespace_of_the_only_vehicle_is_found(tmp_path):
    path = write(
        tmp_path / 'bag',
        ('/fleet/car/joint_states', JOINTS, messages.Joints(1, ('a',))),
        ('/clock', CLOCK, messages.Clock(2)),
        ('/camera', CLOCK, messages.Clock(3)),
    )
    bag = open_bag(path)
    assert bag.namespace == '/fleet/car'
    assert set(bag.topics) == {'joint_states', '/clock', '/camera'}
    assert bag['joint_states'].stamp_ns == [1]
    assert bag['/fleet/car/joint_states'] is bag['joint_states']
    assert open_bag(path, namespace='/').topics.keys() == {'fleet/car/joint_states', '/clock', 'camera'}


def test_of_several_vehicles_one_must_be_named(tmp_path):
    path = write(
        tmp_path / 'bag',
        ('/a/joint_states', JOINTS, messages.Joints(1, ('left',))),
        ('/b/joint_states', JOINTS, messages.Joints(2, ('right',))),
    )
    with pytest.raises(BagError, match='several vehicles; name the namespace of one: /a, /b'):
        open_bag(path)
    for namespace in ('b', '/b', '/b/'):
        assert open_bag(path, namespace=namespace)['joint_states'].names == ('right',)


def test_messages_that_can_not_be_decoded_are_refused_when_asked_for(tmp_path):
    path = write(tmp_path / 'bag', ('/clock', CLOCK, b'\0\1\0\0'), ('/camera', CLOCK, messages.Clock(2)))
    assert open_bag(path)['camera'].stamp_ns == [2]
    with pytest.raises(BagError, match='topic /clock: rosgraph_msgs/msg/Clock: ends after 4 bytes, where 12'):
        open_bag(path)['/clock']


def test_a_bag_that_breaks_off_says_so(tmp_path, bag):
    path = tmp_path / 'cut.mcap'
    content = (bag / 'drive_0.mcap').read_bytes()
    path.write_bytes(content[: len(content) // 2])
    cut = open_bag(path)
    assert not cut.complete
    assert 'the file ends after' in cut.damage[0]
    assert 0 < len(cut['odom']) < len(open_bag(bag)['odom'])
