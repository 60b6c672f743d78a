"""The definitions of installed message types, read from the share folders of their packages.

Their text is put together as rosbag2 does it: the ``.msg`` file as it is, and after it those of all types in it, each
once, in alphabetical order at every level.
"""

import json
import os
import re
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from omni_vehicle_ros.bags.schema import Schema
from omni_vehicle_ros.errors import BagError

DELIMITER = '=' * 80

_TYPE_NAME = re.compile(r'([a-zA-Z]\w*)/(?:msg/)?([a-zA-Z]\w*)', re.ASCII)
_FIELD = re.compile(r'^\s*([a-zA-Z][\w/]*)(?:<=\d+)?(?:\[[^\]]*\])?\s+\w', re.ASCII | re.MULTILINE)
_PRIMITIVE = frozenset((
    'bool', 'byte', 'char', 'float32', 'float64', 'int8', 'uint8', 'int16', 'uint16', 'int32', 'uint32', 'int64',
    'uint64', 'string', 'wstring',
))


@cache
def installed_schema(type_name: str) -> Schema:
    """Return the schema of an installed type.

    Parameters
    ----------
    type_name
        Such as ``sensor_msgs/msg/JointState``.

    Raises
    ------
    BagError
        The type, or one in it, isn't installed as a ``.msg`` file, or its hash isn't.
    """
    path = _definition(type_name)
    parts = [_text(path)]
    parts += [f'{DELIMITER}\nMSG: {name}\n{_text(_definition(name))}' for name in _dependencies(type_name, set())]
    return Schema('\n'.join(parts), _type_hash(type_name, path.with_suffix('.json')))


def _dependencies(type_name: str, seen: set[str]) -> Iterator[str]:
    package = type_name.split('/')[0]
    found = {match[1] for match in _FIELD.finditer(_text(_definition(type_name)))} - _PRIMITIVE
    for name in sorted(name if '/' in name else f'{package}/{name}' for name in found):
        if name not in seen:
            seen.add(name)
            yield name
            yield from _dependencies(name, seen)


def _definition(type_name: str) -> Path:
    """Return the ``.msg`` file of a type, from the first prefix that has it."""
    match = _TYPE_NAME.fullmatch(type_name)
    if not match:
        raise BagError(f'type {type_name!r} is no message type: package/msg/Name')
    for prefix in (*filter(None, os.environ.get('AMENT_PREFIX_PATH', '').split(os.pathsep)), sys.prefix):
        path = Path(prefix) / 'share' / match[1] / 'msg' / f'{match[2]}.msg'
        if path.is_file():
            return path
    where = f'no share/{match[1]}/msg/{match[2]}.msg in AMENT_PREFIX_PATH or {sys.prefix}'
    raise BagError(f'type {type_name} is not installed: {where}')


def _text(path: Path) -> str:
    return path.read_text(encoding='utf-8')


def _type_hash(type_name: str, path: Path) -> str:
    try:
        hashes = json.loads(_text(path))['type_hashes']
        return next(str(entry['hash_string']) for entry in hashes if entry['type_name'] == type_name)
    except (OSError, ValueError, LookupError, TypeError, StopIteration) as error:
        raise BagError(f'type {type_name}: {path} does not give its hash') from error
