"""The messages of one topic as columns: a numpy array for each field of the value."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import accumulate
from typing import Any, get_type_hints

import numpy as np
from numpy.typing import NDArray

from omni_vehicle_ros.messages import VALUE_TYPES

Array = NDArray[Any]
FORCES = tuple[tuple[float, float, float], ...]


@dataclass(frozen=True)
class Columns:
    """The messages of one topic.

    Columns are attributes, named as the fields of the value in ``messages``; all have one row a message.

    - ``stamp`` [s] and ``stamp_ns`` (int64); also where the type has no stamp: then it is the log time.
    - numbers: shape (n,).
    - arrays of joints, such as ``position``: shape (n, len(names)); NaN where a message doesn't have it.
    - ``forces``: shape (n, len(names), 3).
    - texts and what else there is: shape (n,), of objects.
    """

    topic: str
    type_name: str
    names: tuple[str, ...]
    """All joints named in any message, in the order of their first occurrence."""
    arrays: Mapping[str, Array]
    """The columns by name."""

    def __len__(self) -> int:
        """Return the number of messages."""
        return len(self.arrays['stamp_ns'])

    def __getattr__(self, name: str) -> Array:
        """Return a column."""
        try:
            return self.__dict__['arrays'][name]  # type: ignore[no-any-return]
        except KeyError:
            columns = ', '.join(self.__dict__.get('arrays', ()))
            raise AttributeError(f'no column {name!r}; there are {columns}', name=name, obj=self) from None

    def __dir__(self) -> Iterator[str]:
        """List the columns too."""
        return iter((*super().__dir__(), *self.arrays))


def make_columns(topic: str, type_name: str, log_times: Sequence[int], values: Sequence[Any]) -> Columns:
    """Return the columns of values of one type.

    Parameters
    ----------
    topic, type_name
        What they are.
    log_times
        When they were recorded [ns], for each value.
    values
        As `messages.decode` gives them.

    Returns
    -------
    Columns
        With NaN where a message lacks a joint, or has not as many numbers as names.
    """
    hints = _hints(type_name)
    fields = {name: [value[place] for value in values] for place, name in enumerate(hints)}
    named = fields.pop('names', [])
    names = tuple(dict.fromkeys(name for some in dict.fromkeys(named) for name in some))
    arrays: dict[str, Array] = {}
    _add_time(arrays, 'stamp', fields.pop('stamp', log_times))
    if 'end' in fields:
        _add_time(arrays, 'end', fields.pop('end'))
    for name, entries in fields.items():
        arrays[name] = _MAKERS.get(hints[name], _objects)(entries, named, names)
    _add_time(arrays, 'log_time', log_times)
    return Columns(topic, type_name, names, arrays)


def columns_of_rows(topic: str, type_name: str, log_times: Array, value: Any) -> Columns:
    """Return the columns of messages of one layout.

    Parameters
    ----------
    topic, type_name
        What they are.
    log_times
        When they were recorded [ns], shape (n,).
    value
        As `messages.rows.RowLayout.value` gives it: one value, with columns in place of numbers. They are not copied.
    """
    hints = _hints(type_name)
    fields = value._asdict()
    named = fields.pop('names', ())
    names = tuple(dict.fromkeys(named))
    arrays: dict[str, Array] = {}
    _add_time(arrays, 'stamp', fields.pop('stamp'))
    if 'end' in fields:
        _add_time(arrays, 'end', fields.pop('end'))
    for name, entry in fields.items():
        if hints[name] is float:
            arrays[name] = entry
        elif hints[name] in _MAKERS:
            arrays[name] = _stack(entry, named, names, len(log_times), (3,) if hints[name] == FORCES else ())
        else:
            arrays[name] = np.broadcast_to(_objects([entry], [], ()), len(log_times))
    _add_time(arrays, 'log_time', log_times)
    return Columns(topic, type_name, names, arrays)


def _stack(
    entry: Sequence[Any] | Array, named: tuple[str, ...], names: tuple[str, ...], count: int, shape: tuple[int, ...]
) -> Array:
    """Return the column of joints whose numbers, or triples of them, are columns; as an array, shape (joints, n)."""
    if len(entry) != len(named):
        return np.full((count, len(names), *shape), np.nan)
    if isinstance(entry, np.ndarray) and named == names:
        return entry.T
    last = dict(zip(named, entry, strict=True))
    whole = np.array([last[name] for name in names], np.float64).reshape(len(names), *shape, count)
    return np.moveaxis(whole, -1, 0)


def join_columns(parts: Sequence[Columns], rows: Sequence[Array] | None = None) -> Columns:
    """Return columns of the same topic as one, in the same way as if they had never been apart.

    Parameters
    ----------
    parts
        At least one. If the order in which joints first occur is to be right, each has only one list of names, or all
        of them follow one another.
    rows
        The row of each message of each part in the whole; by default they follow one another.
    """
    if len(parts) == 1:
        return parts[0]
    ends = list(accumulate(map(len, parts)))
    places: Sequence[Any] = rows or [slice(end - len(part), end) for part, end in zip(parts, ends, strict=True)]
    ordered = sorted(range(len(parts)), key=lambda part: 0 if rows is None else int(rows[part][0]))
    names = tuple(dict.fromkeys(name for part in ordered for name in parts[part].names))
    arrays = {}
    for name, first in parts[0].arrays.items():
        shape = (ends[-1], len(names), *first.shape[2:]) if first.ndim > 1 else (ends[-1],)
        arrays[name] = np.empty(shape, first.dtype)
        for part, place in zip(parts, places, strict=True):
            arrays[name][place] = _widened(part.arrays[name], part.names, names)
    return Columns(parts[0].topic, parts[0].type_name, names, arrays)


def _widened(column: Array, some: tuple[str, ...], names: tuple[str, ...]) -> Array:
    """Return a column of all joints, NaN for those that it does not have."""
    if column.ndim == 1 or some == names:
        return column
    wide = np.full((len(column), len(names), *column.shape[2:]), np.nan)
    wide[:, [names.index(name) for name in some]] = column
    return wide


@cache
def _hints(type_name: str) -> dict[str, Any]:
    return get_type_hints(VALUE_TYPES[type_name])


def _add_time(arrays: dict[str, Array], name: str, times: Sequence[int] | Array) -> None:
    nanoseconds = np.asarray(times, dtype=np.int64)
    arrays[name] = nanoseconds * 1e-9
    arrays[f'{name}_ns'] = nanoseconds


def _numbers(entries: list[Any], named: list[tuple[str, ...]], names: tuple[str, ...]) -> Array:
    return np.array(entries, dtype=np.float64)


def _objects(entries: list[Any], named: list[tuple[str, ...]], names: tuple[str, ...]) -> Array:
    column = np.empty(len(entries), dtype=object)
    column[:] = entries
    return column


def _by_name(entries: list[Any], named: list[tuple[str, ...]], names: tuple[str, ...], *shape: int) -> Array:
    if entries and all(some == names for some in named) and all(len(entry) == len(names) for entry in entries):
        return np.array(entries, dtype=np.float64).reshape(len(entries), len(names), *shape)
    column = np.full((len(entries), len(names), *shape), np.nan)
    places = {name: place for place, name in enumerate(names)}
    for row, (some, entry) in enumerate(zip(named, entries, strict=True)):
        if len(entry) != len(some):
            continue
        for name, number in zip(some, entry, strict=False):
            column[row, places[name]] = number
    return column


def _triples_by_name(entries: list[Any], named: list[tuple[str, ...]], names: tuple[str, ...]) -> Array:
    return _by_name(entries, named, names, 3)


_MAKERS: dict[Any, Callable[[list[Any], list[tuple[str, ...]], tuple[str, ...]], Array]] = {
    float: _numbers,
    tuple[float, ...]: _by_name,
    FORCES: _triples_by_name,
}
