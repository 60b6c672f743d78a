"""The layouts for Foxglove and RViz name topics that exist, with fields that their messages have."""

import json
import re

import pytest
import yaml
from rosbags.typesys import Stores, get_typestore

from omni_vehicle_ros import interface

DISPLAYS = {
    'rviz_default_plugins/Odometry': 'nav_msgs/msg/Odometry',
    'rviz_default_plugins/PointStamped': 'geometry_msgs/msg/PointStamped',
}
OTHERS = {'/robot_description'}  # of robot_state_publisher
TYPES = get_typestore(Stores.ROS2_JAZZY).fielddefs
PLAIN = 1  # what rosbags calls a field that is no message


def topics():
    return {interface.resolve(row.name, ''): row for row in interface.TOPICS}


def field_kind(type_name, path):
    """Return the kind of what a path such as ``pose.pose.position.x`` ends in: a number, a text ..."""
    for step in path:
        name, index = re.fullmatch(r'(\w+)(\[\d+\])?', step).groups()
        kind, detail = dict(TYPES[type_name][1])[name]
        if index:
            assert kind in (3, 4), f'{step} is no array'
            kind, detail = detail[0]
        if kind == PLAIN:
            return detail[0]
        assert kind == 2, f'{step} is an array'
        type_name = detail
    raise AssertionError(f'{path} is no value')


@pytest.fixture(scope='module')
def layout(root):
    return json.loads((root / 'config' / 'foxglove_layout.json').read_text(encoding='utf-8'))


@pytest.fixture(scope='module')
def rviz(root):
    return yaml.safe_load((root / 'rviz' / 'vehicle.rviz').read_text(encoding='utf-8'))['Visualization Manager']


def leaves(node):
    """Return the panels of a layout."""
    if isinstance(node, str):
        return [node]
    assert node['direction'] in ('row', 'column')
    assert 0 < node['splitPercentage'] < 100
    return leaves(node['first']) + leaves(node['second'])


def test_every_panel_has_its_settings_and_stands_once(layout):
    assert sorted(leaves(layout['layout'])) == sorted(layout['configById'])
    kinds = {name.split('!')[0] for name in layout['configById']}
    assert kinds == {'3D', 'Plot', 'DiagnosticSummary'}


def test_every_plot_shows_numbers_of_our_topics(layout):
    plots = [panel for name, panel in layout['configById'].items() if name.startswith('Plot!')]
    for plot in plots:
        for path in plot['paths'] + ([plot['xAxisPath']] if 'xAxisPath' in plot else []):
            topic, *steps = path['value'].split('.')
            assert field_kind(topics()[topic].type, steps) == 'float64', path['value']
    shown = {path['value'].split('.')[0] for plot in plots for path in plot['paths']}
    assert {'/tyres/side_slip', '/joint_states', '/odom', '/commanded_twist', '/tyres/force'} <= shown


def test_every_plot_has_a_title_for_foxglove_and_for_lichtblick(layout):
    titles = [
        (panel['foxglovePanelTitle'], panel['lichtblickPanelTitle'])
        for name, panel in layout['configById'].items() if name.startswith('Plot!')
    ]
    assert all(one == other for one, other in titles)
    assert len(set(titles)) == len(titles)


def test_other_panels_name_our_topics(layout):
    view = layout['configById']['3D!vehicle']
    assert 'topics' not in view, 'the 3D panels of both draw neither Odometry nor PointStamped'
    assert view['followTf'] == interface.BASE_FRAME
    assert {layer['topic'] for layer in view['layers'].values() if 'topic' in layer} <= OTHERS
    assert {layer['frameId'] for layer in view['layers'].values() if 'frameId' in layer} == {interface.ODOM_FRAME}
    diagnostics = layout['configById']['DiagnosticSummary!nodes']['topicToRender']
    assert topics()[diagnostics].type == 'diagnostic_msgs/msg/DiagnosticArray'


def test_displays_of_rviz_fit_their_topics(rviz):
    shown = {display['Class']: display for display in rviz['Displays']}
    assert {'rviz_default_plugins/RobotModel', 'rviz_default_plugins/TF', *DISPLAYS} <= set(shown)
    for kind, type_name in DISPLAYS.items():
        subscription = shown[kind]['Topic']
        row = interface.topic(subscription['Value'])
        assert row.type == type_name
        assert subscription['Reliability Policy'] == 'Reliable'
        assert subscription['Durability Policy'] == 'Volatile'
    description = shown['rviz_default_plugins/RobotModel']['Description Topic']
    assert f'/{description["Value"]}' in OTHERS
    assert description['Durability Policy'] == 'Transient Local'


def test_rviz_looks_at_our_frames(rviz):
    assert rviz['Global Options']['Fixed Frame'] == interface.ODOM_FRAME
    assert rviz['Views']['Current']['Target Frame'] == interface.BASE_FRAME
