"""Arithmetic that works in all lanes at once; see `lanes`."""

import math

from omni_vehicle_ros.model.lanes import anywhere, select

HALF_PI = (1.57079632673412561417, 6.07710050630396597660e-11, 2.02226624879595063154e-21)
"""pi / 2 in three parts, the first two with 33 bits, so that a multiple of theirs is exact (fdlibm)."""
NEAREST = 6755399441055744.0  # 1.5 * 2**52: a sum with it has no room for a fraction
QUARTER_TURNS, EIGHTH_TURN = 2.0 / math.pi, 0.25 * math.pi
LARGEST_ANGLE = 1e6  # rad, above which the three parts of pi / 2 lose digits


def positive(number: float) -> float:
    """Return a number, or 1 where it is not above 0: a divisor whose quotient is not used there, or is 0 anyway."""
    return select(number > 0.0, number, 1.0)


def norm(x: float, y: float) -> float:
    """Return the length of a vector, whatever its size, as math.hypot does."""
    longer, shorter = max(abs(x), abs(y)), min(abs(x), abs(y))
    share = shorter / positive(longer)
    return longer * math.sqrt(1.0 + share * share)


def cos_sin(angle: float) -> tuple[float, float]:
    """Return cosine and sine of an angle [rad], each within one unit in the last place.

    The polynomials of fdlibm (Sun Microsystems 1993) after a reduction to +-pi/4: unlike a library's, such a function
    works in all lanes at once, and costs less than a call.

    Parameters
    ----------
    angle
        Any; above `LARGEST_ANGLE` the library's functions are taken.
    """
    if not anywhere(abs(angle) > EIGHTH_TURN):
        return _cos_sin(angle)
    turns = (angle * QUARTER_TURNS + NEAREST) - NEAREST
    rest = ((angle - turns * HALF_PI[0]) - turns * HALF_PI[1]) - turns * HALF_PI[2]
    cos, sin = _cos_sin(rest)
    quarter = turns - 4.0 * ((0.25 * turns + NEAREST) - NEAREST)  # -2 .. 2
    odd = abs(quarter) == 1.0
    cos, sin = select(odd, sin, cos), select(odd, cos, sin)
    cos = select((quarter > 0.5) | (quarter < -1.5), -cos, cos)
    sin = select((quarter > 1.5) | (quarter < -0.5), -sin, sin)
    far = abs(angle) > LARGEST_ANGLE
    if anywhere(far):
        cos, sin = select(far, math.cos(angle), cos), select(far, math.sin(angle), sin)
    return cos, sin


def _cos_sin(x: float) -> tuple[float, float]:
    """Return cosine and sine within +-pi/4."""
    z = x * x
    sin = x + x * z * (
        -1.66666666666666324348e-01 + z * (8.33333333332248946124e-03 + z * (-1.98412698298579493134e-04
        + z * (2.75573137070700676789e-06 + z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10))))
    )  # fmt: skip
    tail = z * z * (
        4.16666666666666019037e-02 + z * (-1.38888888888741095749e-03 + z * (2.48015872894767294178e-05
        + z * (-2.75573143513906633035e-07 + z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11))))
    )  # fmt: skip
    half = 0.5 * z
    whole = 1.0 - half
    return whole + (((1.0 - whole) - half) + tail), sin
