"""Many messages of one layout at once: which words of eight bytes to look at, and what they say."""

import re
import struct
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from omni_vehicle_ros.messages.cdr import Layout
from omni_vehicle_ros.messages.codec import CachedCodec
from omni_vehicle_ros.messages.codecs import CODECS

WORD = 8


class RowLayout:
    """What messages of one layout hold, and where.

    Parameters
    ----------
    codec
        Of the type of the messages.
    layout
        Of the messages.

    Attributes
    ----------
    checks
        Words that show whether a message has this layout: where they begin, which bits of them are to be looked at,
        and what these must be; each of shape (checks,).
    numbers
        Where the words begin that are the numbers of a message, first its stamps, then its float64; shape (numbers,).
    """

    def __init__(self, codec: CachedCodec, layout: Layout) -> None:
        self._value = codec.value
        self._shape = layout.shape
        constant, mask = bytearray(layout.size), bytearray(layout.size)
        stamps: list[int] = []
        doubles: list[int] = []
        position = 0
        for piece in layout.pieces:
            if isinstance(piece, str):
                position = _add_numbers(piece, position, stamps, doubles)
                continue
            length = piece if isinstance(piece, int) else len(piece)
            if isinstance(piece, bytes):
                constant[position : position + length] = piece
                mask[position : position + length] = b'\xff' * length
            position += length
        begins = [min(begin, layout.size - WORD) for begin in range(0, layout.size, WORD)]
        begins = [begin for begin in begins if any(mask[begin : begin + WORD])]
        self.checks = np.array(begins, np.int64), _words(mask, begins), _words(constant, begins)
        self.numbers = np.array([*stamps, *doubles], np.int64)
        self._stamps = len(stamps)

    def value(self, rows: NDArray[np.uint64]) -> Any:
        """Return the value of messages: in place of each number a column, shape (n,), that looks into ``rows``.

        Parameters
        ----------
        rows
            The words `numbers` of each message, shape (n, numbers).
        """
        seconds, nanoseconds = rows.view('<i4')[:, ::2], rows.view('<u4')[:, 1::2]
        times = [part[:, stamp].astype(np.int64) for stamp in range(self._stamps) for part in (seconds, nanoseconds)]
        with np.errstate(all='ignore'):
            return self._value(self._shape, Numbers(times, rows[:, self._stamps :].view('<f8').T))


class Numbers(Sequence[Any]):
    """The numbers of messages as columns: those of stamps, then float64, of which a slice is one array.

    Parameters
    ----------
    times
        Seconds and nanoseconds of each stamp, each of shape (n,).
    doubles
        Shape (numbers, n).
    """

    def __init__(self, times: list[NDArray[np.int64]], doubles: NDArray[np.float64]) -> None:
        self._times = times
        self._doubles = doubles

    def __len__(self) -> int:
        """Return how many there are."""
        return len(self._times) + len(self._doubles)

    def __getitem__(self, place: Any) -> Any:
        """Return a column, or the columns of a slice that begins behind the stamps."""
        first = len(self._times)
        if isinstance(place, slice):
            begin, end, step = place.indices(len(self))
            return self._doubles[begin - first : end - first : step]
        return self._times[place] if place < first else self._doubles[place - first]


def _words(content: bytearray, begins: list[int]) -> NDArray[np.uint64]:
    return np.array([int.from_bytes(content[begin : begin + WORD], 'little') for begin in begins], np.uint64)


def _add_numbers(form: str, position: int, stamps: list[int], doubles: list[int]) -> int:
    """Note where the stamps and the float64 of a group of numbers are; return where it ends."""
    for count, letter in re.findall(r'(\d*)([a-zA-Z])', form):
        size, repeat = struct.calcsize(f'<{letter}'), int(count or 1)
        if letter == 'd':
            doubles.extend(range(position, position + size * repeat, size))
        elif letter == 'i':
            stamps.append(position)
        position += size * repeat
    return position


def row_layout(type_name: str, data: bytes) -> RowLayout | None:
    """Return the layout of a message, for messages like it; None if its type or its bytes have no fixed one.

    Raises
    ------
    MessageError
        The bytes are not such a message.
    """
    codec = CODECS[type_name]
    if not isinstance(codec, CachedCodec):
        return None
    layout = codec.layout_of(data)
    return None if layout is None else RowLayout(codec, layout)
