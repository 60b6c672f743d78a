"""The wiring table holds together."""

import re

import pytest

from omni_vehicle_ros import interface
from omni_vehicle_ros.messages import VALUE_TYPES

KNOWN = {*interface.NODES, interface.ANYONE}
ROWS = pytest.mark.parametrize('row', interface.TOPICS, ids=lambda row: row.name)


def test_names_are_unique_and_found():
    names = [row.name for row in interface.TOPICS]
    assert len(set(names)) == len(names)
    assert [interface.topic(name) for name in names] == list(interface.TOPICS)
    with pytest.raises(KeyError):
        interface.topic('camera')


@ROWS
def test_a_row_names_known_nodes_and_a_known_type(row):
    assert row.type in VALUE_TYPES
    assert row.publishers
    assert KNOWN.issuperset(row.publishers)
    assert KNOWN.issuperset(row.subscribers)
    assert len(set(row.publishers)) == len(row.publishers)
    assert interface.ANYONE not in row.subscribers
    if row.name != 'faults':  # a node says to all, itself included, what its parameters are set to
        assert not set(row.publishers) & set(row.subscribers) - {interface.PLANT}


@ROWS
def test_a_row_is_fit_for_ros_and_for_a_page(row):
    assert re.fullmatch(r'/?[a-z][a-z0-9_]*(/[a-z][a-z0-9_]*)*', row.name)
    assert row.qos.depth > 0
    assert row.text.endswith('.')
    assert row.fields
    assert row.frame in ('', interface.BASE_FRAME, interface.ODOM_FRAME)


@ROWS
def test_cyclic_topics_have_one_publisher_and_are_not_latched(row):
    if row.cyclic:
        assert len(row.publishers) == 1
        assert not row.qos.latched


def test_every_node_is_wired():
    wired = {node for row in interface.TOPICS for node in (*row.publishers, *row.subscribers)}
    assert wired.issuperset(interface.NODES)


@pytest.mark.parametrize(
    ('name', 'namespace', 'full'),
    [
        ('odom', '', '/odom'),
        ('odom', '/', '/odom'),
        ('odom', 'car', '/car/odom'),
        ('odom', '/fleet/car/', '/fleet/car/odom'),
        ('/clock', '/car', '/clock'),
    ],
)
def test_names_are_resolved_like_those_of_ros(name, namespace, full):
    assert interface.resolve(name, namespace) == full
