"""What all codecs share: the layouts that were met are kept.

A message like one before costs a look-up and one call of ``struct``; a message unlike any before is read field by
field.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Any

from omni_vehicle_ros.messages.cdr import Layout, LayoutBuilder, Reader

SECOND = 1_000_000_000
KEPT_LAYOUTS = 64
"""Layouts kept for each type and direction, so that ever new names don't fill the memory."""

KEPT_SIZE = 4096
"""Messages that are longer are read field by field each time [byte]: no node of a vehicle says such ones."""


class Codec(ABC):
    """Turns the values of one type into bytes and back."""

    def __init__(self, value_type: type[Any]) -> None:
        self.value_type = value_type

    @abstractmethod
    def encode(self, value: Any) -> bytes:
        """Return the message."""

    @abstractmethod
    def decode(self, data: bytes) -> Any:
        """Return the value, or raise MessageError."""


class CachedCodec(Codec):
    """Codec of a type whose messages mostly differ in their numbers only."""

    def __init__(self, value_type: type[Any]) -> None:
        super().__init__(value_type)
        self._by_shape: dict[Any, Layout] = {}
        self._by_length: dict[int, list[Layout]] = {}
        self._known = 0

    @abstractmethod
    def describe(self, builder: LayoutBuilder, shape: Any) -> None:
        """Add the fields of a message of this shape."""

    @abstractmethod
    def read(self, reader: Reader) -> tuple[Any, tuple[Any, ...]]:
        """Return the shape and the numbers of any message."""

    @abstractmethod
    def value(self, shape: Any, numbers: Any) -> Any:
        """Return the value that shape and numbers make; of columns of numbers, a value of columns."""

    def layout(self, shape: Any) -> Layout:
        """Return the layout of messages of this shape."""
        layout = self._by_shape.get(shape)
        if layout is None:
            builder = LayoutBuilder()
            self.describe(builder, shape)
            layout = builder.build(shape)
            if len(self._by_shape) >= KEPT_LAYOUTS:
                self._by_shape.clear()
            self._by_shape[shape] = layout
        return layout

    def decode(self, data: bytes) -> Any:
        """Return the value, or raise MessageError."""
        for layout in self._by_length.get(len(data), ()):
            if layout.fixed(data) == layout.constants:
                return self.value(layout.shape, layout.numbers(data))
        return self._decode_first(data)

    def _decode_first(self, data: bytes) -> Any:
        layout, shape, numbers = self._read(data)
        if layout is not None:
            if self._known >= KEPT_LAYOUTS:
                self._by_length.clear()
                self._known = 0
            self._by_length.setdefault(len(data), []).append(layout)
            self._known += 1
        return self.value(shape, numbers)

    def layout_of(self, data: bytes) -> Layout | None:
        """Return the layout of a message; None if none describes it, as for big-endian ones.

        Raises
        ------
        MessageError
            The bytes are not such a message.
        """
        return self._read(data)[0]

    def _read(self, data: bytes) -> tuple[Layout | None, Any, tuple[Any, ...]]:
        reader = Reader(data)
        shape, numbers = self.read(reader)
        reader.finish()
        layout = self.layout(shape) if reader.little_endian and len(data) <= KEPT_SIZE else None
        return layout if layout is not None and layout.describes(data) else None, shape, numbers


class StampedCodec(CachedCodec):
    """Codec of a stamp, then strings, then always the same numbers.

    Parameters
    ----------
    value_type
        Has the fields stamp, numbers, strings, in this order.
    form
        The numbers on the wire: ``d``, and ``x`` for each unused byte.
    strings
        How many there are.
    to_wire, from_wire
        Convert the numbers of the value to those of the wire and back.
    """

    def __init__(
        self,
        value_type: type[Any],
        form: str,
        strings: int = 1,
        to_wire: Callable[..., tuple[float, ...]] | None = None,
        from_wire: Callable[..., tuple[float, ...]] | None = None,
    ) -> None:
        super().__init__(value_type)
        self._form = form
        self._strings = strings
        self._end = len(value_type._fields) - strings
        self._to_wire = to_wire
        self._from_wire = from_wire
        self._make = value_type._make

    def encode(self, value: Any) -> bytes:
        """Return the message."""
        layout = self.layout(value[self._end:])
        numbers = value[1:self._end]
        if self._to_wire is not None:
            numbers = self._to_wire(*numbers)
        seconds, nanoseconds = divmod(value[0], SECOND)
        return layout.pack(layout.runs[0], seconds, nanoseconds, *layout.runs[1:], *numbers)

    def describe(self, builder: LayoutBuilder, shape: Any) -> None:
        """Add the fields of a message with these strings."""
        builder.stamp()
        for text in shape:
            builder.string(text)
        builder.numbers(self._form)

    def read(self, reader: Reader) -> tuple[Any, tuple[Any, ...]]:
        """Return the strings and the numbers."""
        stamp = reader.stamp()
        return tuple(reader.string() for _ in range(self._strings)), stamp + reader.numbers(self._form)

    def value(self, shape: Any, numbers: Any) -> Any:
        """Return the value."""
        stamp = numbers[0] * SECOND + numbers[1]
        if self._from_wire is not None:
            return self._make((stamp, *self._from_wire(*numbers[2:]), *shape))
        return self._make((stamp, *numbers[2:], *shape))
