"""Reading MCAP files from begin to end, whole or broken (MCAP specification, https://mcap.dev/spec).

A file without its end, as a killed or full recorder leaves it, gives all messages up to where it breaks off.
"""

import re
from collections.abc import Callable, Generator, Iterator
from contextlib import closing
from pathlib import Path
from typing import TypeVar

from omni_vehicle_ros.bags.mcap.file_reader import ChannelFacts, McapFileReader, RecordedMessage
from omni_vehicle_ros.bags.mcap.records import DamageError
from omni_vehicle_ros.errors import BagError

T = TypeVar('T')


class MessageStream:
    """Iterates over the messages of MCAP files, in the order of the files, in bounded memory.

    Parameters
    ----------
    paths
        The files.

    Attributes
    ----------
    types
        The types of the topics met so far, by topic.
    facts
        What their channels say beside, by topic.
    count
        Messages given so far.
    position
        Where reading is, in all files together [byte].
    damage
        For each file that is damaged or not finished, up to where it was read and why no farther.
    """

    def __init__(self, paths: tuple[Path, ...]) -> None:
        self._paths = paths
        self.types: dict[str, str] = {}
        self.facts: dict[str, ChannelFacts] = {}
        self.count = 0
        self.position = 0
        self.damage: list[str] = []

    @property
    def complete(self) -> bool:
        """Whether all that was read so far was whole."""
        return not self.damage

    def __iter__(self) -> Iterator[RecordedMessage]:
        """Give the messages.

        Raises
        ------
        BagError
            A file can't be opened, or is no MCAP file.
        """
        for _, message in self.walk(_messages):
            yield message

    @property
    def size(self) -> int:
        """All files together [byte].

        Raises
        ------
        BagError
            A file is gone.
        """
        try:
            return sum(path.stat().st_size for path in self._paths)
        except OSError as error:
            raise BagError(f'{error.filename} can not be read: {error.strerror}') from error

    def walk(self, read: Callable[[McapFileReader], Generator[tuple[int, T], None, None]]) -> Iterator[tuple[int, T]]:
        """Give what ``read`` finds in each file, and how many messages that is; note damage and go on.

        Raises
        ------
        BagError
            A file can't be opened, or is no MCAP file.
        """
        self.count = 0
        self.damage.clear()
        done = 0
        for path in self._paths:
            before = self.count
            try:
                with path.open('rb') as file:
                    reader = McapFileReader(file, self.types, self.facts)
                    with closing(read(reader)) as items:
                        for number, item in items:
                            self.count += number
                            self.position = done + reader.position
                            yield number, item
                    done += reader.position
            except DamageError as error:
                self.damage.append(f'{path}: {error}; {self.count - before} messages before that are good')
            except OSError as error:
                raise BagError(f'{path} can not be read: {error.strerror}') from error


def read_messages(path: Path | str) -> MessageStream:
    """Return the messages of a bag, in the order of recording.

    Parameters
    ----------
    path
        A bag directory (``metadata.yaml`` isn't needed) or one MCAP file.

    Raises
    ------
    BagError
        There is no such bag.
    """
    return MessageStream(bag_files(path))


def bag_files(path: Path | str) -> tuple[Path, ...]:
    """Return the MCAP files of a bag, in the order of recording.

    Parameters
    ----------
    path
        A bag directory or one MCAP file.

    Raises
    ------
    BagError
        There is no such bag.
    """
    path = Path(path)
    if path.is_file():
        return (path,)
    if not path.is_dir():
        raise BagError(f'{path} does not exist; name a bag directory or an MCAP file')
    files = tuple(sorted(path.glob('*.mcap'), key=_natural_order))
    if not files:
        raise BagError(f'{path} holds no MCAP file, so it is no bag that can be read here')
    return files


def _natural_order(path: Path) -> list[tuple[int, str]]:
    """Order bag_2 before bag_10."""
    return [(int(part), '') if part.isdigit() else (-1, part) for part in re.split(r'([0-9]+)', path.name)]


def _messages(reader: McapFileReader) -> Generator[tuple[int, RecordedMessage], None, None]:
    for piece in reader.pieces():
        position = 0
        while position < len(piece):
            position, message = reader.record(piece, position)
            if message is not None:
                yield 1, message
