"""The encoding of ROS messages on the wire and in bags: CDR version 1.

Four bytes of header, then the fields one after the other, each aligned to its size, counted from the end of the
header (OMG DDSI-RTPS 2.5, chapter 10; OMG CORBA 3.3 part 2, 9.3).
"""

import struct
from collections.abc import Callable, Iterable
from itertools import groupby
from typing import Any, NamedTuple

from omni_vehicle_ros.errors import MessageError

HEADER = b'\x00\x01\x00\x00'
TRAILING_BYTES = 15
"""Bytes allowed after the end: middleware fills up to a multiple of 4; rclpy's ``serialize_message`` appends up
to 12 bytes of arbitrary content, for it reckons with padding before the elements of empty sequences."""


class Layout(NamedTuple):
    """Messages that differ in their numbers only: same strings, same array lengths.

    One call packs such a message, one recognises it (``fixed(data) == constants``), one gets its numbers.
    """

    shape: Any
    """What the strings and lengths are, in the words of the type."""
    size: int
    """Bytes, header included."""
    pack: Callable[..., bytes]
    """Make the message from runs and numbers, in the order of the wire."""
    runs: tuple[bytes, ...]
    """The bytes before, between and after the groups of numbers."""
    fixed: Callable[[bytes], tuple[Any, ...]]
    """Get the constant bytes; padding is left out, for its content is arbitrary."""
    constants: tuple[bytes, ...]
    """What they must be."""
    numbers: Callable[[bytes], tuple[Any, ...]]
    """Get the numbers."""
    pieces: tuple[bytes | int | str, ...]
    """What the message is made of: constant bytes, padding by its length, groups of numbers by their form."""

    def describes(self, data: bytes) -> bool:
        """Tell whether a message has this layout, with no more than padding after it."""
        return 0 <= len(data) - self.size <= TRAILING_BYTES and self.fixed(data) == self.constants


class LayoutBuilder:
    """Collects the fields of a message, in order."""

    def __init__(self) -> None:
        self._pieces: list[bytes | int | str] = [HEADER]
        self._size = 0

    def _add(self, piece: bytes | int | str, size: int, alignment: int = 1) -> None:
        padding = -self._size % alignment
        if padding:
            self._pieces.append(padding)
        self._pieces.append(piece)
        self._size += padding + size

    def byte(self, value: int) -> None:
        """Add one constant byte."""
        self._add(bytes((value,)), 1)

    def count(self, value: int) -> None:
        """Add a constant length of a sequence."""
        self._add(struct.pack('<I', value), 4, 4)

    def string(self, text: str) -> None:
        """Add a constant string.

        Raises
        ------
        ValueError
            The text holds a NUL or is not valid Unicode.
        """
        if '\0' in text:
            raise ValueError(f'text {text!r} holds a NUL; a ROS string ends there')
        content = text.encode() + b'\0'
        self.count(len(content))
        self._add(content, len(content))

    def strings(self, texts: Iterable[str]) -> None:
        """Add a constant sequence of strings."""
        texts = tuple(texts)
        self.count(len(texts))
        for text in texts:
            self.string(text)

    def stamp(self) -> None:
        """Add a group of numbers: seconds and nanoseconds."""
        self._add('iI', 8, 4)

    def numbers(self, form: str) -> None:
        """Add a group of numbers: float64 (``d``) with unused bytes (``x``) between them."""
        size = struct.calcsize('<' + form)
        self._add(form, size, 8 if size else 1)

    def doubles(self, count: int) -> None:
        """Add a sequence of ``count`` float64, the numbers of which are a group."""
        self.count(count)
        self.numbers(f'{count}d')

    def build(self, shape: Any = None) -> Layout:
        """Return the layout of what was added."""
        pieces = self._pieces
        whole: list[str] = []
        runs: list[bytes] = []
        for is_numbers, group in groupby(pieces, key=lambda piece: isinstance(piece, str)):
            if is_numbers:
                whole.extend(str(form) for form in group)
            else:
                run = b''.join(piece if isinstance(piece, bytes) else bytes(int(piece)) for piece in group)
                whole.append(f'{len(run)}s')
                runs.append(run)
        fixed = ''.join(f'{len(piece)}s' if isinstance(piece, bytes) else f'{_size(piece)}x' for piece in pieces)
        numbers = ''.join(piece if isinstance(piece, str) else f'{_size(piece)}x' for piece in pieces)
        return Layout(
            shape=shape,
            size=len(HEADER) + self._size,
            pack=struct.Struct('<' + ''.join(whole)).pack,
            runs=tuple(runs),
            fixed=struct.Struct('<' + fixed).unpack_from,
            constants=tuple(piece for piece in pieces if isinstance(piece, bytes)),
            numbers=struct.Struct('<' + numbers).unpack_from,
            pieces=tuple(pieces),
        )


def _size(piece: bytes | int | str) -> int:
    if isinstance(piece, str):
        return struct.calcsize('<' + piece)
    return piece if isinstance(piece, int) else len(piece)


class Reader:
    """Reads any message field by field, of either byte order.

    Raises
    ------
    MessageError
        In every method, if the bytes don't hold what should be there.
    """

    def __init__(self, data: bytes) -> None:
        self._data = bytes(data)
        if len(data) < len(HEADER) or self._data[:2] not in (b'\0\0', b'\0\1'):
            begin = self._data[:4].hex(' ') or 'nothing'
            raise MessageError(f'begins with {begin}; known are 00 00 and 00 01 (plain CDR)')
        self.little_endian = data[1] == 1
        self._order = '<' if self.little_endian else '>'
        self._position = len(HEADER)

    def _take(self, form: str, alignment: int) -> tuple[Any, ...]:
        start = self._position + -(self._position - len(HEADER)) % alignment
        end = start + struct.calcsize('<' + form)
        if end > len(self._data):
            raise MessageError(f'ends after {len(self._data)} bytes, where {end} or more are needed')
        self._position = end
        return struct.unpack_from(self._order + form, self._data, start)

    def byte(self) -> int:
        """Read one byte."""
        return int(self._take('B', 1)[0])

    def count(self, element_size: int) -> int:
        """Read the length of a sequence whose elements take at least ``element_size`` bytes each."""
        count = int(self._take('I', 4)[0])
        if count * element_size > len(self._data) - self._position:
            raise MessageError(f'a sequence of {count} begins {len(self._data) - self._position} bytes before the end')
        return count

    def string(self) -> str:
        """Read a string."""
        length = self.count(1)
        if not length:
            return ''
        content = self._take(f'{length}s', 1)[0]
        if content.find(0) != length - 1:
            raise MessageError(f'text {content!r} must have one NUL, at its end')
        try:
            return str(content[:-1], 'utf-8')
        except UnicodeDecodeError as error:
            raise MessageError(f'text {content!r} is not UTF-8') from error

    def strings(self) -> tuple[str, ...]:
        """Read a sequence of strings."""
        return tuple(self.string() for _ in range(self.count(4)))

    def stamp(self) -> tuple[int, int]:
        """Read seconds and nanoseconds."""
        seconds, nanoseconds = self._take('iI', 4)
        return seconds, nanoseconds

    def numbers(self, form: str) -> tuple[Any, ...]:
        """Read a group of numbers, see `LayoutBuilder.numbers`."""
        return self._take(form, 8) if form else ()

    def doubles(self) -> tuple[float, ...]:
        """Read a sequence of float64."""
        count = self.count(8)
        return self.numbers(f'{count}d' if count else '')

    def finish(self) -> None:
        """Check that nothing but padding is left."""
        left = len(self._data) - self._position
        if left > TRAILING_BYTES:
            raise MessageError(f'has {left} bytes after its end; padding is {TRAILING_BYTES} at most')
