"""Numbers in sentences: rounded to what the eye can take in, so that every platform says the same."""

import math

MINUS, NONE, HARD_SPACE = '\u2212', '\u2013', '\u00a0'
SMALLEST = 1e-6
"""What is smaller is said as 0: the rounding of a simulation."""

_NO_SHARE = 5e-4


def number(value: float | None, digits: int = 3) -> str:
    """Return a number with so many significant digits, without exponent or trailing zeros; a dash for None.

    Parameters
    ----------
    value
        What to say; what is not finite is said as a dash, too.
    digits
        Significant digits.
    """
    if value is None or not math.isfinite(value):
        return NONE
    if abs(value) < SMALLEST:
        return '0'
    places = digits - 1 - math.floor(math.log10(abs(value)))
    text = f'{round(value, places):.{max(places, 0)}f}'
    text = text.rstrip('0').rstrip('.') if '.' in text else text
    return text.replace('-', MINUS)


def degrees(angle: float | None, digits: int = 3) -> str:
    """Return an angle [rad] as ``1.23°``."""
    return NONE if angle is None else f'{number(math.degrees(angle), digits)}°'


def percent(share: float | None, digits: int = 2) -> str:
    """Return a share as ``12 %``, the two held together; less than 0.05 % is none."""
    if share is None:
        return NONE
    return f'{number(100.0 * share if abs(share) >= _NO_SHARE else 0.0, digits)}{HARD_SPACE}%'


def sentence(words: str) -> str:
    """Return words with a capital letter at their begin."""
    return words[:1].upper() + words[1:]


def listed(words: list[str]) -> str:
    """Return words as ``a, b and c``."""
    return f'{", ".join(words[:-1])} and {words[-1]}' if len(words) > 1 else ''.join(words)


def wheel_words(wheel: str) -> str:
    """Return ``front_left`` as ``front left``."""
    return wheel.replace('_', ' ')
