"""Writing a bag: a directory with MCAP files and ``metadata.yaml``, as ``ros2 bag record`` makes it."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any, NoReturn

from omni_vehicle_ros.bags.mcap.file_writer import CHUNK_SIZE, COMPRESSIONS, McapFile
from omni_vehicle_ros.bags.metadata import (
    FileRecord,
    OfferedQos,
    TopicRecord,
    bag_information,
    offer,
    write_metadata,
)
from omni_vehicle_ros.bags.schema import Schema, schema
from omni_vehicle_ros.errors import BagError
from omni_vehicle_ros.interface import Qos

__all__ = ['CHUNK_SIZE', 'COMPRESSIONS', 'BagWriter']

METADATA_EVERY = 50
"""Flushes from one writing of ``metadata.yaml`` to the next."""


class BagWriter:
    """Writes messages, as the bytes that they are, into a new bag.

    Its files are ``NAME_0.mcap``, ``NAME_1.mcap`` and so on, where ``NAME`` is that of the directory. Each of them can
    be read alone. The next one begins with the first message after the present one has reached its size or time.

    Parameters
    ----------
    directory
        Is made, and its parents; must not exist.
    compression
        Of each chunk: ``none``, ``lz4`` or ``zstd``.
    split_size
        Size of a file from which on the next one follows [byte]; it ends up larger by a chunk and its index. 0: never.
    split_time
        Log time in a file from which on the next one follows [ns]. 0: never.

    Attributes
    ----------
    directory
        As given, absolute.
    path
        The file that is written.
    count
        Messages written so far.

    Raises
    ------
    BagError
        Here and in every method: the directory exists, or the system refuses to write, as when the disk is full. What
        was written until then stays readable; the writer writes no more.
    """

    def __init__(
        self, directory: Path | str, *, compression: str = 'zstd', split_size: int = 0, split_time: int = 0
    ) -> None:
        if compression not in COMPRESSIONS:
            raise BagError(f'compression {compression!r} is unknown; known are {", ".join(COMPRESSIONS)}')
        self.directory = Path(directory).resolve()
        self.count = 0
        self._compression = compression
        self._split_size, self._split_time = split_size, split_time
        self._splits = bool(split_size or split_time)
        self._topics: dict[str, TopicRecord] = {}
        self._definitions: dict[str, str] = {}
        self._counts: dict[str, int] = {}
        self._finished: list[FileRecord] = []
        self._flushes = 0
        self._ended = ''
        self.path = self._next_path()
        make_directory(self.directory)
        self._file = self._open()

    def add_topic(
        self, name: str, type_name: str, qos: Qos | Sequence[OfferedQos], description: Schema | None = None
    ) -> None:
        """Announce a topic by its full name; for one that is known already it does nothing.

        Parameters
        ----------
        name, type_name
            As in ROS.
        qos
            What its publishers offer; for one of the wiring table, its quality of service.
        description
            Of the type; needed only if it is none of ``messages``.

        Raises
        ------
        BagError
            The topic is known with another type, or the type is unknown.
        """
        self._check()
        if name in self._topics:
            if self._topics[name].type_name != type_name:
                raise BagError(f'topic {name} has the type {self._topics[name].type_name}, not {type_name}')
            return
        definition, type_hash = description or schema(type_name)
        offers = (offer(qos),) if isinstance(qos, Qos) else tuple(qos)
        topic = TopicRecord(name, type_name, type_hash, offers, 0)
        try:
            self._file.add_topic(topic, definition)
        except OSError as error:
            self._fail(error)
        self._topics[name] = topic
        self._definitions[name] = definition
        self._counts[name] = 0

    def write(self, name: str, data: bytes, log_time_ns: int, publish_time_ns: int | None = None) -> None:
        """Write one message.

        Parameters
        ----------
        name
            Topic that was announced.
        data
            The message, in CDR.
        log_time_ns, publish_time_ns
            When it was taken and published [ns, not negative]; the latter is the former unless given.

        Raises
        ------
        BagError
            The topic was not announced, or a time is negative.
        """
        self._check()
        count = self._counts.get(name)
        if count is None:
            raise BagError(f'topic {name} is unknown; add_topic must come first')
        published = log_time_ns if publish_time_ns is None else publish_time_ns
        if not (0 <= log_time_ns < 2**63 and 0 <= published < 2**63):
            raise BagError(f'topic {name}: the times {log_time_ns} and {published} ns must be within 0 .. 2^63 - 1')
        try:
            if self._splits and self._file_is_full(log_time_ns):
                self._split()
            self._file.write(name, data, log_time_ns, published, count)
        except OSError as error:
            self._fail(error)
        self._counts[name] = count + 1
        self.count += 1

    def flush(self) -> None:
        """Hand all that was written to the system, where it survives whatever ends this process."""
        self._check()
        try:
            self._file.flush()
            if self._flushes % METADATA_EVERY == 0:
                write_metadata(self.directory, self._information({}))
        except OSError as error:
            self._fail(error)
        self._flushes += 1

    def close(self, custom: Mapping[str, str] | None = None) -> None:
        """Finish the bag; for one that is closed or has failed already it does nothing.

        Parameters
        ----------
        custom
            Words to keep with the bag, as ``custom_data``.
        """
        if self._ended:
            return
        try:
            self._file.finish(custom or {})
            write_metadata(self.directory, self._information(custom or {}))
        except OSError as error:
            self._fail(error)
        self._ended = 'the bag is closed'

    def __enter__(self) -> 'BagWriter':
        """Return the writer."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close the bag, also after an error: what was written is good."""
        self.close()

    def _next_path(self) -> Path:
        return self.directory / f'{self.directory.name}_{len(self._finished)}.mcap'

    def _open(self) -> McapFile:
        """Begin a file, with all topics."""
        try:
            file = McapFile(self.path, self._compression)
            for name, topic in self._topics.items():
                file.add_topic(topic, self._definitions[name])
        except OSError as error:
            raise self._ending(error) from error
        return file

    def _file_is_full(self, log_time: int) -> bool:
        if self._split_size and self._file.size >= self._split_size:
            return True
        begin = self._file.begin
        return bool(self._split_time) and begin is not None and log_time - begin >= self._split_time

    def _split(self) -> None:
        self._file.finish({})
        self._finished.append(self._file.record)
        self.path = self._next_path()
        self._file = self._open()
        write_metadata(self.directory, self._information({}))

    def _information(self, custom: Mapping[str, str]) -> dict[str, Any]:
        topics = [record._replace(message_count=self._counts[name]) for name, record in self._topics.items()]
        return bag_information([*self._finished, self._file.record], topics, custom)

    def _check(self) -> None:
        if self._ended:
            raise BagError(f'{self.path}: {self._ended}')

    def _fail(self, error: OSError) -> NoReturn:
        self._file.abandon()
        raise self._ending(error) from error

    def _ending(self, error: OSError) -> BagError:
        """End the writing, and return why."""
        self._ended = f'{error.strerror or error}; what was written before stays readable'
        return BagError(f'{self.path}: {self._ended}')


def make_directory(directory: Path) -> None:
    """Make the directory of a bag.

    Raises
    ------
    BagError
        It exists, or can't be made.
    """
    try:
        directory.mkdir(parents=True)
    except FileExistsError as error:
        raise BagError(f'{directory} exists; name a directory that does not') from error
    except OSError as error:
        raise BagError(f'{directory} can not be made: {error.strerror}') from error
