"""Messages of types that are not ours as columns, one by one, by the definition that lies in the bag itself."""

import json
from collections.abc import Collection, Generator, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from omni_vehicle_ros.bags.columns.columns import Array, Columns
from omni_vehicle_ros.bags.columns.flat import FlatColumn
from omni_vehicle_ros.bags.mcap.definitions import SchemaDefinition, read_schema
from omni_vehicle_ros.bags.mcap.file_reader import McapFileReader
from omni_vehicle_ros.bags.mcap.records import RECORD, SCHEMA
from omni_vehicle_ros.bags.mcap.stream import read_messages
from omni_vehicle_ros.bags.metadata import SECOND
from omni_vehicle_ros.errors import MessageError

if TYPE_CHECKING:
    from rosbags.interfaces.typing import FieldDesc
    from rosbags.typesys.store import Typestore

TIMES = ('builtin_interfaces/msg/Time', 'builtin_interfaces/msg/Duration')


UNITS: dict[str, dict[str, str]] = {
    'geometry_msgs/msg/Accel': {'linear': 'm/s2', 'angular': 'rad/s2'},
    'geometry_msgs/msg/Pose': {'position': 'm', 'orientation': '1'},
    'geometry_msgs/msg/PointStamped': {'point': 'm'},
    'geometry_msgs/msg/Pose2D': {'x': 'm', 'y': 'm', 'theta': 'rad'},
    'geometry_msgs/msg/Transform': {'translation': 'm', 'rotation': '1'},
    'geometry_msgs/msg/Twist': {'linear': 'm/s', 'angular': 'rad/s'},
    'geometry_msgs/msg/Wrench': {'force': 'N', 'torque': 'N m'},
    'nav_msgs/msg/MapMetaData': {'resolution': 'm'},
    'sensor_msgs/msg/FluidPressure': {'fluid_pressure': 'Pa', 'variance': 'Pa2'},
    'sensor_msgs/msg/LaserScan': {
        'angle_min': 'rad', 'angle_max': 'rad', 'angle_increment': 'rad', 'time_increment': 's', 'scan_time': 's',
        'range_min': 'm', 'range_max': 'm', 'ranges': 'm',
    },
    'sensor_msgs/msg/MagneticField': {'magnetic_field': 'T', 'magnetic_field_covariance': 'T2'},
    'sensor_msgs/msg/Range': {'field_of_view': 'rad', 'min_range': 'm', 'max_range': 'm', 'range': 'm'},
}
"""What the comments of common_interfaces say, by type and field; also for what lies in the field."""


class Leaf(NamedTuple):
    """A column of a type: the fields that lead to it, and what it holds."""

    path: tuple[tuple[str, str], ...]
    """Type and field, from the message inwards."""
    kind: str
    """``time``, ``text``, ``objects``, or the name of a numpy type."""
    length: int
    """Of an array of fixed size; 0: a single one; -1: a sequence."""


class ForeignType:
    """Decodes messages of one type.

    Parameters
    ----------
    type_name
        Such as ``sensor_msgs/msg/LaserScan``.
    schema
        Its definition; None: that of ROS 2 Jazzy.

    Attributes
    ----------
    leaves
        The columns by name: fields of fields with ``_`` between, as in ``pose_position_x``.

    Raises
    ------
    MessageError
        The definition is missing or makes no sense.
    """

    def __init__(self, type_name: str, schema: SchemaDefinition | None) -> None:
        self.type_name = type_name
        try:
            self._store = _typestore(type_name, schema)
            self.leaves: dict[str, Leaf] = {}
            for leaf in _leaves(self._store, type_name, ()):
                name = '_'.join(field for _, field in leaf.path)
                self._add(leaf, 'stamp' if name == 'header_stamp' else name)
        except Exception as error:  # whatever rosbags makes of a definition that makes no sense
            text = f'{type_name} is not defined in the bag in a way that can be read: {_line(error)}'
            raise MessageError(text) from error

    @property
    def units(self) -> dict[str, str]:
        """The units of the columns, as far as they are known."""
        found = {}
        for name, leaf in self.leaves.items():
            known = (UNITS.get(type_name, {}).get(field) for type_name, field in leaf.path)
            found[name] = next((unit for unit in known if unit), '')
        return found

    def _add(self, leaf: Leaf, name: str) -> None:
        """Add a column, with ``_`` after a name that is taken: by a_b.c beside a.b_c, or by what `Columns` has."""
        taken = {'log_time', 'log_time_ns', 'stamp_ns', 'arrays', 'names', 'topic', 'type_name', *self.leaves}
        taken |= {f'{name}_ns' for name, other in self.leaves.items() if other.kind == 'time'}
        taken |= set() if leaf.kind == 'time' else {'stamp'}
        while name in taken:
            name += '_'
        self.leaves[name] = leaf

    def columns(self, topic: str, log_times: Sequence[int], messages: Sequence[bytes]) -> Columns:
        """Return messages as columns.

        Parameters
        ----------
        topic
            What they are.
        log_times
            When they were recorded [ns].
        messages
            In CDR.

        Returns
        -------
        Columns
            Numbers in their own numpy type, arrays of fixed size k with the shape (n, k), sequences and texts as
            objects; messages in sequences as dictionaries.

        Raises
        ------
        MessageError
            The bytes are not such messages.
        """
        try:
            values = [self._store.deserialize_cdr(data, self.type_name) for data in messages]
        except Exception as error:  # rosbags lets through what numpy, struct and a text may raise
            raise MessageError(f'{self.type_name}: {_line(error)}') from error
        arrays: dict[str, Array] = {}
        if 'stamp' not in self.leaves:
            _add_times(arrays, 'stamp', log_times)
        for name, leaf in self.leaves.items():
            found: list[Any] = list(values)
            for _, field in leaf.path:
                found = [getattr(value, field) for value in found]
            if leaf.kind == 'time':
                _add_times(arrays, name, [value.sec * SECOND + value.nanosec for value in found])
            else:
                arrays[name] = _column(leaf, found)
        _add_times(arrays, 'log_time', log_times)
        return Columns(topic, self.type_name, (), arrays)


def _line(error: Exception) -> str:
    return ' '.join(str(error).split())[:200] or type(error).__name__


def _typestore(type_name: str, schema: SchemaDefinition | None) -> 'Typestore':
    from rosbags.typesys import Stores, get_types_from_idl, get_types_from_msg, get_typestore

    if schema is None:
        store = get_typestore(Stores.ROS2_JAZZY)
        if type_name not in store.fielddefs:
            raise MessageError('there is no definition')
        return store
    text = schema.data.decode()
    found = get_types_from_idl(text) if schema.encoding == 'ros2idl' else get_types_from_msg(text, type_name)
    store = get_typestore(Stores.EMPTY)
    store.register({name: fields for name, fields in found.items() if name not in store.fielddefs})
    return store


def _leaves(store: 'Typestore', type_name: str, before: tuple[tuple[str, str], ...]) -> Iterator[Leaf]:
    from rosbags.interfaces import Nodetype

    for name, description in store.fielddefs[type_name][1]:
        path = (*before, (type_name, name))
        if description[0] == Nodetype.NAME and description[1] not in TIMES:
            yield from _leaves(store, description[1], path)
        elif description[0] == Nodetype.ARRAY or description[0] == Nodetype.SEQUENCE:
            element, size = description[1]
            named = element[0] == Nodetype.NAME
            yield Leaf(path, 'objects' if named else _kind(element), size if description[0] == Nodetype.ARRAY else -1)
        else:
            yield Leaf(path, _kind(description), 0)


def _kind(description: 'FieldDesc') -> str:
    from rosbags.interfaces import Nodetype

    if description[0] == Nodetype.NAME:
        return 'time'
    name = str(description[1][0])
    return {'string': 'text', 'wstring': 'text', 'char': 'uint8'}.get(name, name)


def _column(leaf: Leaf, found: list[Any]) -> Array:
    if leaf.kind not in ('text', 'objects') and leaf.length >= 0:
        shape = (len(found), leaf.length) if leaf.length else (len(found),)
        return _unsigned(np.array(found, np.dtype(leaf.kind)).reshape(shape), leaf.kind)
    column = np.empty(len(found), object)
    for row, value in enumerate(found):
        if isinstance(value, np.ndarray):
            column[row] = _unsigned(value, leaf.kind)
        else:
            column[row] = value if leaf.length == 0 else [_plain(each) for each in value]
    return column


def _unsigned(values: Array, kind: str) -> Array:
    """Return a ``byte`` as ROS has it, 0 .. 255; rosbags and numpy take it for signed."""
    return values.view(np.uint8) if kind == 'byte' else values


def _plain(value: Any) -> Any:
    """Return a message as a dictionary."""
    if hasattr(value, '__msgtype__'):
        names = (name for name in value.__dataclass_fields__ if name != '__msgtype__' and not name.isupper())
        return {name: _plain(getattr(value, name)) for name in names}  # constants are in capitals
    return [_plain(each) for each in value] if isinstance(value, list) else value


def _add_times(arrays: dict[str, Array], name: str, times: Sequence[int]) -> None:
    nanoseconds = np.array(times, np.int64)
    arrays[name], arrays[f'{name}_ns'] = nanoseconds * 1e-9, nanoseconds


def bag_schemas(path: Path | str, types: Collection[str]) -> dict[str, SchemaDefinition]:
    """Return the first definition of each of these types in the files of a bag."""
    found: dict[str, SchemaDefinition] = {}
    for _, schema in read_messages(path).walk(_schemas):
        if schema.name in types:
            found.setdefault(schema.name, schema)
        if len(found) == len(types):
            break
    return found


def _schemas(reader: McapFileReader) -> Generator[tuple[int, SchemaDefinition], None, None]:
    for piece in reader.pieces():
        position = 0
        while position + RECORD.size <= len(piece):
            opcode, length = RECORD.unpack_from(piece, position)
            position += RECORD.size
            if opcode == SCHEMA:
                yield 0, read_schema(piece[position : position + length])[1]
            position += length


def flat_foreign(columns: Columns, units: Mapping[str, str]) -> Iterator[FlatColumn]:
    """Give the columns of a block with messages as those of a table, and their units.

    Their kind is as in `FlatColumn`, or the name of a numpy type, or ``list of`` and that; all else is JSON text.
    """
    times = {name.removesuffix('_ns') for name in columns.arrays if name.endswith('_ns')}
    for name, column in columns.arrays.items():
        unit = 's' if name in times else 'ns' if name.removesuffix('_ns') in times else units.get(name, '')
        first = column[0]
        if isinstance(first, np.ndarray):
            yield FlatColumn(name, unit, f'list of {first.dtype.name}', list(column))
        elif column.dtype != object:
            yield FlatColumn(name, unit, column.dtype.name, column)
        elif isinstance(first, str):
            yield FlatColumn(name, '', 'text', list(column))
        else:
            yield FlatColumn(name, '', 'text', [json.dumps(value, default=np.ndarray.tolist) for value in column])


def join_blocks(parts: Sequence[Columns]) -> Columns:
    """Return blocks of a topic of a foreign type as one."""
    arrays = {name: np.concatenate([part.arrays[name] for part in parts]) for name in parts[0].arrays}
    return Columns(parts[0].topic, parts[0].type_name, (), arrays)
