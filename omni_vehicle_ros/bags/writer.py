"""Writing a bag: a directory with an MCAP file and ``metadata.yaml``, as ``ros2 bag record`` makes it."""

from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import IO, NoReturn, cast

from mcap.writer import CompressionType, Writer

from omni_vehicle_ros import __version__
from omni_vehicle_ros.bags.metadata import TopicRecord, as_yaml, bag_information, qos_profiles, write_metadata
from omni_vehicle_ros.bags.schema import ENCODING, schema
from omni_vehicle_ros.errors import BagError
from omni_vehicle_ros.interface import Qos

CHUNK_SIZE = 65536
"""A chunk is written when it is full or at a flush: what is lost at a kill is less than one."""

METADATA_EVERY = 50
"""Flushes from one writing of ``metadata.yaml`` to the next."""

COMPRESSIONS = {'none': CompressionType.NONE, 'lz4': CompressionType.LZ4, 'zstd': CompressionType.ZSTD}


class BagWriter:
    """Writes messages, as the bytes that they are, into a new bag.

    Parameters
    ----------
    directory
        Is made, and its parents; must not exist.
    compression
        Of each chunk: ``none``, ``lz4`` or ``zstd``.

    Raises
    ------
    BagError
        Here and in every method: the directory exists, or the system refuses to write, as when the disk is full. What
        was written until then stays readable; the writer writes no more.
    """

    def __init__(self, directory: Path | str, *, compression: str = 'zstd') -> None:
        if compression not in COMPRESSIONS:
            raise BagError(f'compression {compression!r} is unknown; known are {", ".join(COMPRESSIONS)}')
        self.directory = Path(directory).resolve()
        self.path = self.directory / f'{self.directory.name}_0.mcap'
        self._file = _new_file(self.directory, self.path)
        self._writer = Writer(self._file, chunk_size=CHUNK_SIZE, compression=COMPRESSIONS[compression])
        self._schemas: dict[str, int] = {}
        self._channels: dict[str, int] = {}
        self._topics: dict[str, TopicRecord] = {}
        self._counts: dict[str, int] = {}
        self._first: int | None = None
        self._last = 0
        self._flushes = 0
        self._ended = ''
        try:
            self._writer.start(profile='ros2', library=f'omni_vehicle_ros {__version__}')
        except OSError as error:
            self._fail(error)

    def add_topic(self, name: str, type_name: str, qos: Qos) -> None:
        """Announce a topic by its full name; for one that is known already it does nothing.

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
        definition, type_hash = schema(type_name)
        try:
            if type_name not in self._schemas:
                self._schemas[type_name] = self._writer.register_schema(type_name, ENCODING, definition.encode())
            self._channels[name] = self._writer.register_channel(
                name, 'cdr', self._schemas[type_name],
                {'offered_qos_profiles': as_yaml(qos_profiles(qos)), 'topic_type_hash': type_hash},
            )
        except OSError as error:
            self._fail(error)
        self._topics[name] = TopicRecord(name, type_name, type_hash, qos, 0)
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
        channel = self._channels.get(name)
        if channel is None:
            raise BagError(f'topic {name} is unknown; add_topic must come first')
        published = log_time_ns if publish_time_ns is None else publish_time_ns
        if not (0 <= log_time_ns < 2**63 and 0 <= published < 2**63):
            raise BagError(f'topic {name}: the times {log_time_ns} and {published} ns must be within 0 .. 2^63 - 1')
        count = self._counts[name]
        try:
            self._writer.add_message(channel, log_time_ns, data, published, count)
        except OSError as error:
            self._fail(error)
        self._counts[name] = count + 1
        self._first = log_time_ns if self._first is None else min(self._first, log_time_ns)
        self._last = max(self._last, log_time_ns)

    def flush(self) -> None:
        """Hand all that was written to the system, where it survives whatever ends this process."""
        self._check()
        try:
            self._writer.flush()
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
        information = self._information(custom or {})
        try:
            self._writer.add_metadata('rosbag2', {'serialized_metadata': as_yaml(information)})
            self._writer.finish()
            self._file.close()
            write_metadata(self.directory, information)
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

    def _information(self, custom: Mapping[str, str]) -> dict[str, object]:
        topics = [record._replace(message_count=self._counts[name]) for name, record in self._topics.items()]
        return bag_information(self.path.name, topics, (self._first or 0, self._last), custom)

    def _check(self) -> None:
        if self._ended:
            raise BagError(f'{self.path}: {self._ended}')

    def _fail(self, error: OSError) -> NoReturn:
        self._ended = f'{error.strerror or error}; what was written before stays readable'
        with suppress(OSError):
            self._file.close()
        raise BagError(f'{self.path}: {self._ended}') from error


class _WholeWrites:
    """A file without a buffer in this process, which either takes all of what is written or raises.

    A buffer would hide an error of the system until later, and be lost when the process is killed.
    """

    def __init__(self, path: Path) -> None:
        self._file = open(path, 'xb', buffering=0)  # noqa: SIM115  (closed by close)
        self._position = 0

    def write(self, data: bytes) -> int:
        rest = memoryview(data)
        while rest:
            rest = rest[self._file.write(rest) :]
        self._position += len(data)
        return len(data)

    def tell(self) -> int:
        return self._position

    def flush(self) -> None:
        pass

    def close(self) -> None:
        self._file.close()


def _new_file(directory: Path, path: Path) -> IO[bytes]:
    try:
        directory.mkdir(parents=True)
        return cast('IO[bytes]', _WholeWrites(path))
    except FileExistsError as error:
        raise BagError(f'{directory} exists; name a directory that does not') from error
    except OSError as error:
        raise BagError(f'{directory} can not be made: {error.strerror}') from error
