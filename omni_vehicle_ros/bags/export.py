"""Bags as tables for other tools: a parquet or CSV file for each topic, with units, in bounded memory."""

import csv
import json
from collections.abc import Callable, Collection
from contextlib import ExitStack
from pathlib import Path
from typing import IO, Any, NamedTuple, Protocol

from omni_vehicle_ros.bags.blocks import checked_blocks
from omni_vehicle_ros.bags.columns import Columns, join_columns
from omni_vehicle_ros.bags.flat import FlatColumn, flat_columns
from omni_vehicle_ros.bags.mcap_stream import MessageStream, read_messages
from omni_vehicle_ros.errors import BagError
from omni_vehicle_ros.messages import VALUE_TYPES
from omni_vehicle_ros.parameters import did_you_mean

FORMATS = ('parquet', 'csv')
UNITS_FILE = 'units.json'
ROW_GROUP = 16384
"""Messages of a row group of a parquet file."""


class Exported(NamedTuple):
    """What was exported.

    Attributes
    ----------
    files
        The messages in each file, by its path.
    skipped
        All topics of the bag whose type is not read here, with it.
    damage
        Why the bag isn't whole, if so.
    """

    files: dict[Path, int]
    skipped: dict[str, str]
    damage: tuple[str, ...]


class _Survey(NamedTuple):
    """Joints and numbers of messages, by topic."""

    names: dict[str, dict[str, None]]
    counts: dict[str, int]


class _Table(Protocol):
    def write(self, columns: list[FlatColumn]) -> None: ...


def export(
    path: Path | str,
    directory: Path,
    *,
    kind: str = 'parquet',
    topics: Collection[str] | None = None,
    progress: Callable[[float], None] = lambda done: None,
) -> Exported:
    """Write a file for each topic that has messages into a directory that exists.

    The bag is read twice: which joints a topic has is known at its end only.

    Parameters
    ----------
    path
        A bag directory or one MCAP file; one that breaks off gives what there is.
    directory
        Gets the files, named as their topics with ``.`` for ``/``. Beside CSV files, ``units.json`` has their units.
    kind
        One of `FORMATS`.
    topics
        Full names; by default all whose type is known here.
    progress
        Told how much is done, 0 .. 1.

    Raises
    ------
    BagError
        There is no such bag, it lacks one of the topics, messages can't be decoded, or the system refuses to write.
    """
    stream = read_messages(path)
    survey = _survey(stream, path, topics, lambda done: progress(0.4 * done))
    _check_topics(path, topics, stream)
    files = {topic: directory / f'{topic.strip("/").replace("/", ".")}.{kind}' for topic in survey.counts}
    try:
        _write(path, files, kind, survey, lambda done: progress(0.4 + 0.6 * done))
    except OSError as error:
        _remove(files)
        raise BagError(f'{directory}: {error.strerror or error}') from error
    except BaseException:
        _remove(files)
        raise
    skipped = {topic: type_name for topic, type_name in stream.types.items() if type_name not in VALUE_TYPES}
    return Exported({files[topic]: count for topic, count in survey.counts.items()}, skipped, tuple(stream.damage))


def _survey(
    stream: MessageStream, path: Path | str, topics: Collection[str] | None, progress: Callable[[float], None]
) -> _Survey:
    survey = _Survey({}, {})
    for topic, columns in checked_blocks(stream, path, topics):
        survey.names.setdefault(topic, {}).update(dict.fromkeys(columns.names))
        survey.counts[topic] = survey.counts.get(topic, 0) + len(columns)
        progress(stream.position / stream.size)
    return survey


def _check_topics(path: Path | str, topics: Collection[str] | None, stream: MessageStream) -> None:
    for topic in topics or ():
        if topic not in stream.types:
            raise BagError(f'{path} has no topic {topic!r}{did_you_mean(topic, list(stream.types))}')


def _remove(files: dict[str, Path]) -> None:
    """Leave no half of a table."""
    for path in files.values():
        path.unlink(missing_ok=True)


def _write(
    path: Path | str, files: dict[str, Path], kind: str, survey: _Survey, progress: Callable[[float], None]
) -> None:
    stream = read_messages(path)
    tables: dict[str, _Table] = {}
    waiting: dict[str, list[Columns]] = {}
    units: dict[str, dict[str, str]] = {}

    def flush(topic: str) -> None:
        block = join_columns(waiting.pop(topic))
        columns = list(flat_columns(block, tuple(survey.names[topic])))
        if topic not in tables:
            make = _ParquetTable if kind == 'parquet' else _CsvTable
            tables[topic] = make(files[topic], columns, block, stack)
            units[files[topic].name] = {column.name: column.unit for column in columns}
        tables[topic].write(columns)

    with ExitStack() as stack:
        for topic, columns in checked_blocks(stream, path, survey.counts):
            waiting.setdefault(topic, []).append(columns)
            if sum(map(len, waiting[topic])) >= ROW_GROUP:
                flush(topic)
            progress(stream.position / stream.size)
        for topic in tuple(waiting):
            flush(topic)
    if kind == 'csv':
        for folder in {file.parent for file in files.values()}:
            (folder / UNITS_FILE).write_text(json.dumps(units, indent=2) + '\n', encoding='utf-8')


class _ParquetTable:
    """A parquet file; each column has its unit as metadata."""

    def __init__(self, path: Path, columns: list[FlatColumn], block: Columns, stack: ExitStack) -> None:
        import pyarrow as pa
        from pyarrow import parquet

        types = {'int': pa.int64(), 'float': pa.float64(), 'text': pa.string()}
        fields = [pa.field(one.name, types[one.kind], metadata={'unit': one.unit}) for one in columns]
        self._schema = pa.schema(fields, metadata={'topic': block.topic, 'type': block.type_name})
        self._writer = stack.enter_context(parquet.ParquetWriter(path, self._schema, compression='zstd'))

    def write(self, columns: list[FlatColumn]) -> None:
        """Add a row group."""
        import pyarrow as pa

        arrays = [pa.array(one.values, field.type) for one, field in zip(columns, self._schema, strict=True)]
        self._writer.write_table(pa.Table.from_arrays(arrays, schema=self._schema))


class _CsvTable:
    """A CSV file with a line of names; numbers are written so that they read back as the same."""

    def __init__(self, path: Path, columns: list[FlatColumn], block: Columns, stack: ExitStack) -> None:
        file: IO[str] = stack.enter_context(path.open('w', newline='', encoding='utf-8'))
        self._writer = csv.writer(file)
        self._writer.writerow([one.name for one in columns])

    def write(self, columns: list[FlatColumn]) -> None:
        """Add lines."""
        values: list[Any] = [one.values if one.kind == 'text' else one.values.tolist() for one in columns]
        self._writer.writerows(zip(*values, strict=True))
