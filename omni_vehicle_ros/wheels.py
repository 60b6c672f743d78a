"""The four wheels: their names and their order, the same everywhere."""

from collections.abc import Callable, Sequence
from typing import Literal, TypeVar

PerWheel = tuple[float, float, float, float]
WheelName = Literal['front_left', 'front_right', 'rear_left', 'rear_right']

WHEELS: tuple[WheelName, ...] = ('front_left', 'front_right', 'rear_left', 'rear_right')

T = TypeVar('T')


def per_wheel(function: Callable[[int], T]) -> tuple[T, T, T, T]:
    """Return ``function(i)`` for the wheels i = 0..3 (front left, front right, rear left, rear right)."""
    return function(0), function(1), function(2), function(3)


def as_four(values: Sequence[T]) -> tuple[T, T, T, T]:
    """Return four values, one a wheel, as a tuple."""
    fl, fr, rl, rr = values
    return fl, fr, rl, rr


def scaled(factor: float, numbers: PerWheel) -> PerWheel:
    """Return the product of a factor and each of four numbers."""
    fl, fr, rl, rr = numbers
    return factor * fl, factor * fr, factor * rl, factor * rr


def steer_joint(wheel: str) -> str:
    """Name the joint that turns a wheel about the vertical axis."""
    return f'{wheel}_steer'


def drive_joint(wheel: str) -> str:
    """Name the joint that spins a wheel about its axle."""
    return f'{wheel}_drive'
