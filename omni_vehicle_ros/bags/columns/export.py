"""Bags as tables for other tools: a parquet or CSV file for each topic, with units, in bounded memory."""

import csv
import json
from collections.abc import Collection, Iterable
from contextlib import ExitStack
from pathlib import Path
from typing import IO, Any, NamedTuple, Protocol

from omni_vehicle_ros.bags.columns.columns import Columns, join_columns
from omni_vehicle_ros.bags.columns.flat import FlatColumn, flat_columns
from omni_vehicle_ros.bags.columns.foreign import flat_foreign
from omni_vehicle_ros.bags.columns.topic_blocks import Progress, TopicBlocks
from omni_vehicle_ros.errors import BagError, MessageError
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
        Why topics that were not asked for by name were left out.
    damage
        Why the bag isn't whole, if so.
    """

    files: dict[Path, int]
    skipped: dict[str, str]
    damage: tuple[str, ...]


class _Survey(NamedTuple):
    """What there is: joints of topics of our types, and messages of all that are to be exported."""

    names: dict[str, dict[str, None]]
    counts: dict[str, int]
    skipped: dict[str, str]
    ours: set[str]


class _Table(Protocol):
    def write(self, columns: list[FlatColumn]) -> None: ...


def export(
    path: Path | str,
    directory: Path,
    *,
    kind: str = 'parquet',
    topics: Collection[str] | None = None,
    progress: Progress = lambda done: None,
) -> Exported:
    """Write a file for each topic that has messages into a directory that exists.

    The bag is read twice: which joints a topic has is known at its end only. Topics of types that are not ours are read
    a third time, and decoded one by one by their definition in the bag.

    Parameters
    ----------
    path
        A bag directory, one MCAP file, or what else ``rosbags`` reads; one that breaks off gives what there is.
    directory
        Gets the files, named as their topics with ``.`` for ``/``. Beside CSV files, ``units.json`` has their units.
    kind
        One of `FORMATS`.
    topics
        Full names; by default all.
    progress
        Told how much is done, 0 .. 1.

    Raises
    ------
    BagError
        There is no such bag, it lacks one of the topics, messages of a topic that is ours or was asked for can't be
        decoded, or the system refuses to write.
    """
    survey = _survey(path, topics, lambda done: progress(0.3 * done))
    files = _file_names(directory, survey.counts, kind)
    skipped = dict(survey.skipped)
    try:
        damage = _write(path, files, kind, survey, skipped, topics, lambda done: progress(0.3 + 0.7 * done))
        for topic in skipped.keys() & files.keys():
            files.pop(topic).unlink(missing_ok=True)
    except OSError as error:
        _remove(files)
        raise BagError(f'{directory}: {error.strerror or error}') from error
    except BaseException:
        _remove(files)
        raise
    return Exported({files[topic]: survey.counts[topic] for topic in files}, skipped, damage)


def _survey(path: Path | str, topics: Collection[str] | None, progress: Progress) -> _Survey:
    blocks, names = TopicBlocks(path), dict[str, dict[str, None]]()
    for topic, _, columns in blocks.ours(lambda topic: topics is None or topic in topics, progress):
        if isinstance(columns, MessageError):
            raise BagError(f'{path}: topic {topic}: {columns}') from columns
        names.setdefault(topic, {}).update(dict.fromkeys(columns.names))
    for topic in topics or ():
        if topic not in blocks.types:
            raise BagError(f'{path} has no topic {topic!r}{did_you_mean(topic, list(blocks.types))}')
    wanted = [topic for topic in blocks.types if topics is None or topic in topics]
    for topic in wanted:
        types = [name for other, name in blocks.counts if other == topic]
        if len(types) > 1:
            raise BagError(f'{path}: topic {topic} has several types: {", ".join(types)}')
    counts = {topic: blocks.counts.get((topic, blocks.types[topic]), 0) for topic in wanted}
    skipped = {topic: 'it has no messages' for topic, count in counts.items() if not count}
    return _Survey(names, {topic: count for topic, count in counts.items() if count}, skipped, set(names))


def _file_names(directory: Path, topics: Iterable[str], kind: str) -> dict[str, Path]:
    """Return the path of the file of each topic: no two are the same."""
    files: dict[str, Path] = {}
    for topic in topics:
        name = topic.strip('/').replace('/', '.')
        while (file := directory / f'{name}.{kind}') in files.values():
            name += '_'
        files[topic] = file
    return files


def _remove(files: dict[str, Path]) -> None:
    """Leave no half of a table."""
    for path in files.values():
        path.unlink(missing_ok=True)


def _write(
    path: Path | str, files: dict[str, Path], kind: str, survey: _Survey, skipped: dict[str, str],
    topics: Collection[str] | None, progress: Progress,
) -> tuple[str, ...]:
    blocks = TopicBlocks(path)
    foreign = survey.counts.keys() - survey.ours
    share = 0.5 if foreign else 1.0
    with ExitStack() as stack:
        tables = _Tables(files, kind, survey.names, stack)
        for topic, _, columns in blocks.ours(survey.ours.__contains__, lambda done: progress(share * done)):
            if isinstance(columns, Columns):
                tables.add(topic, columns)
        tables.finish()
        others = blocks.foreign(foreign, lambda done: progress(share + (1.0 - share) * done)) if foreign else ()
        for topic, _, columns in others:
            if isinstance(columns, Columns):
                tables.write(topic, columns, list(flat_foreign(columns, blocks.units[topic])))
            elif topics is not None:
                raise BagError(f'{path}: topic {topic}: {columns}')
            else:
                skipped.setdefault(topic, str(columns))
    units = {files[topic].name: units for topic, units in tables.units.items() if topic not in skipped}
    if kind == 'csv' and units:
        folder = next(iter(files.values())).parent
        (folder / UNITS_FILE).write_text(json.dumps(units, indent=2) + '\n', encoding='utf-8')
    return blocks.damage


class _Tables:
    """The tables of all topics, each made when its first rows come."""

    def __init__(
        self, files: dict[str, Path], kind: str, names: dict[str, dict[str, None]], stack: ExitStack
    ) -> None:
        self._files, self._names, self._stack = files, names, stack
        self._make = _ParquetTable if kind == 'parquet' else _CsvTable
        self._tables: dict[str, _Table] = {}
        self._waiting: dict[str, list[Columns]] = {}
        self.units: dict[str, dict[str, str]] = {}

    def add(self, topic: str, columns: Columns) -> None:
        """Keep a block of one of our types until there are enough for a row group."""
        self._waiting.setdefault(topic, []).append(columns)
        if sum(map(len, self._waiting[topic])) >= ROW_GROUP:
            self._flush(topic)

    def finish(self) -> None:
        """Write what was kept."""
        for topic in tuple(self._waiting):
            self._flush(topic)

    def _flush(self, topic: str) -> None:
        block = join_columns(self._waiting.pop(topic))
        self.write(topic, block, list(flat_columns(block, tuple(self._names[topic]))))

    def write(self, topic: str, block: Columns, columns: list[FlatColumn]) -> None:
        """Write a block at once."""
        if topic not in self._tables:
            self._tables[topic] = self._make(self._files[topic], columns, block, self._stack)
            self.units[topic] = {column.name: column.unit for column in columns}
        self._tables[topic].write(columns)


class _ParquetTable:
    """A parquet file; each column has its unit as metadata."""

    def __init__(self, path: Path, columns: list[FlatColumn], block: Columns, stack: ExitStack) -> None:
        import pyarrow as pa
        from pyarrow import parquet

        fields = [pa.field(one.name, _arrow_type(one.kind), metadata={'unit': one.unit}) for one in columns]
        self._schema = pa.schema(fields, metadata={'topic': block.topic, 'type': block.type_name})
        self._writer = stack.enter_context(parquet.ParquetWriter(path, self._schema, compression='zstd'))

    def write(self, columns: list[FlatColumn]) -> None:
        """Add a row group."""
        import pyarrow as pa

        arrays = [pa.array(one.values, field.type) for one, field in zip(columns, self._schema, strict=True)]
        self._writer.write_table(pa.Table.from_arrays(arrays, schema=self._schema))


def _arrow_type(kind: str) -> Any:
    import pyarrow as pa

    if kind.startswith('list of '):
        return pa.list_(_arrow_type(kind.removeprefix('list of ')))
    return pa.type_for_alias({'int': 'int64', 'float': 'float64', 'text': 'string'}.get(kind, kind))


class _CsvTable:
    """A CSV file with a line of names; numbers are written so that they read back as the same."""

    def __init__(self, path: Path, columns: list[FlatColumn], block: Columns, stack: ExitStack) -> None:
        file: IO[str] = stack.enter_context(path.open('w', newline='', encoding='utf-8'))
        self._writer = csv.writer(file)
        self._writer.writerow([one.name for one in columns])

    def write(self, columns: list[FlatColumn]) -> None:
        """Add lines."""
        values = [_cells(one) for one in columns]
        self._writer.writerows(zip(*values, strict=True))


def _cells(column: FlatColumn) -> Any:
    if column.kind == 'text':
        return column.values
    if column.kind.startswith('list of '):
        return [json.dumps(value.tolist()) for value in column.values]
    return column.values.tolist()
