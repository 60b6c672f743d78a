"""Schemas against the definitions and hashes that ROS 2 Jazzy itself installs."""

import importlib
import json
import re
from pathlib import Path

import pytest
from rosbags.typesys import get_types_from_msg

from omni_vehicle_ros.bags.schema import schema
from omni_vehicle_ros.errors import BagError
from omni_vehicle_ros.messages import VALUE_TYPES

TYPES = sorted(VALUE_TYPES)


def share(type_name, ending):
    package, _, name = type_name.split('/')
    installed = Path(importlib.import_module(package).__file__)
    file = Path('share', package, 'msg', f'{name}.{ending}')
    return next(parent / file for parent in installed.parents if (parent / file).exists())


@pytest.mark.parametrize('type_name', TYPES)
def test_definitions_are_those_of_the_installed_msg_files(type_name):
    sections = re.split(r'={80}\nMSG: (.+)\n', f'{"=" * 80}\nMSG: {type_name}\n{schema(type_name).definition}')
    for name, text in zip(sections[1::2], sections[2::2], strict=True):
        full_name = name if '/msg/' in name else name.replace('/', '/msg/')
        installed = share(full_name, 'msg').read_text(encoding='utf-8')
        ours, theirs = get_types_from_msg(text, full_name), get_types_from_msg(installed, full_name)
        assert ours[full_name][1] == theirs[full_name][1]


@pytest.mark.parametrize('type_name', TYPES)
def test_hashes_are_those_of_the_installed_interfaces(type_name):
    description = json.loads(share(type_name, 'json').read_text(encoding='utf-8'))
    hashes = {entry['type_name']: entry['hash_string'] for entry in description['type_hashes']}
    assert schema(type_name).type_hash == hashes[type_name]


def test_unknown_types_are_refused():
    with pytest.raises(BagError, match=r'std_msgs/msg/Byte.*known are'):
        schema('std_msgs/msg/Byte')
