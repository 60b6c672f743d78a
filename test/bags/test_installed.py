"""Definitions of installed types, against the parser and the hashes of rosbags."""

import sys
from pathlib import Path

import pytest
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from omni_vehicle_ros.bags.installed import installed_schema
from omni_vehicle_ros.bags.schema import schema
from omni_vehicle_ros.errors import BagError
from omni_vehicle_ros.messages import VALUE_TYPES

JAZZY = get_typestore(Stores.ROS2_JAZZY)
PREFIX = Path(sys.prefix)
pytestmark = pytest.mark.skipif(
    not (PREFIX / 'share' / 'std_msgs').is_dir(), reason='the message packages are not in the environment of Python'
)


def installed(*packages):
    return [
        f'{path.parts[-3]}/msg/{path.stem}'
        for package in packages for path in sorted((PREFIX / 'share' / package / 'msg').glob('*.msg'))
    ]


@pytest.mark.parametrize('package', ['geometry_msgs', 'nav_msgs', 'sensor_msgs', 'std_msgs', 'diagnostic_msgs'])
def test_definitions_are_complete_and_have_the_hash_of_ros(package):
    types = [name for name in installed(package) if name != 'std_msgs/msg/Char']  # rosbags takes a char for a uint8
    assert types
    for name in types:
        found = installed_schema(name)
        store = get_typestore(Stores.EMPTY)
        store.register(get_types_from_msg(found.definition, name))
        assert store.hash_rihs01(name) == found.type_hash
        assert name not in JAZZY.fielddefs or JAZZY.hash_rihs01(name) == found.type_hash


def test_types_are_told_apart_as_rosbag2_does():
    found = installed_schema('geometry_msgs/msg/TwistStamped').definition
    assert [line for line in found.splitlines() if line.startswith('MSG: ')] == [
        'MSG: geometry_msgs/Twist', 'MSG: geometry_msgs/Vector3',
        'MSG: std_msgs/Header', 'MSG: builtin_interfaces/Time',
    ]
    assert f'\n\n{"=" * 80}\nMSG: std_msgs/Header\n# Standard metadata' in found


@pytest.mark.parametrize('name', sorted(VALUE_TYPES))
def test_the_vehicles_own_types_are_the_installed_ones(name):
    assert schema(name).type_hash == installed_schema(name).type_hash


def package(prefix, text, json='{"type_hashes": [{"type_name": "my_msgs/msg/Thing", "hash_string": "RIHS01_0"}]}'):
    folder = prefix / 'share' / 'my_msgs' / 'msg'
    folder.mkdir(parents=True)
    (folder / 'Thing.msg').write_text(text)
    (folder / 'Thing.json').write_text(json)


def test_bounds_constants_and_comments_are_no_types(tmp_path, monkeypatch):
    monkeypatch.setenv('AMENT_PREFIX_PATH', str(tmp_path))
    text = '# Other thing\nstring<=10[<=5] names\nuint8 KIND=1\nwstring<=4 wide\nstd_msgs/Bool[3] flags # A b\n'
    package(tmp_path, text)
    installed_schema.cache_clear()
    found = installed_schema('my_msgs/msg/Thing')
    assert found.type_hash == 'RIHS01_0'
    assert [line for line in found.definition.splitlines() if line.startswith('MSG: ')] == ['MSG: std_msgs/Bool']


@pytest.mark.parametrize(
    ('name', 'text', 'json', 'words'),
    [
        ('my_msgs/msg/None', 'bool a\n', '{}', 'type my_msgs/msg/None is not installed: no share/my_msgs/msg/None.msg'),
        ('my_msgs/msg/Thing', 'Gone gone\n', '{}', 'type my_msgs/Gone is not installed'),
        ('my_msgs/msg/Thing', 'bool a\n', '{}', 'Thing.json does not give its hash'),
        ('my_msgs/msg/Thing', 'bool a\n', '[', 'Thing.json does not give its hash'),
        ('../../msg/Thing', 'bool a\n', '{}', 'is no message type'),
        ('my_msgs/srv/Thing_Event', 'bool a\n', '{}', 'is no message type'),
    ],
)
def test_what_can_not_be_described_is_refused(tmp_path, monkeypatch, name, text, json, words):
    monkeypatch.setenv('AMENT_PREFIX_PATH', str(tmp_path))
    package(tmp_path, text, json)
    installed_schema.cache_clear()
    with pytest.raises(BagError, match=words):
        installed_schema(name)
