"""How large the gain of the side-slip controller may be.

Side slip depends at once on the steer angle that corrects it, so the sampled loop is no faster than its
actuator. With a gain K, a cycle dt and a time constant tau, keep (1 + K) dt / tau well below 1. The limit
itself is exact here for a wheel whose own velocity doesn't change: a vehicle that takes its time to answer.
"""

import cmath
import math
from collections.abc import Callable

_GRID = 64
_HALVINGS = 60


def side_slip_gain_limit(time_constant: float, delay: float, period: float) -> float:
    """Return the proportional gain at which the sampled slip loop begins to oscillate without end.

    In each cycle the slip is measured, the trim ``-K alpha`` is set and held, and the actuator follows it
    after its delay. With delay = (q + f) period, 0 <= f < 1, that is exactly ``x[k+1] = a x[k] + b1 u[k-q] +
    b0 u[k-q-1]``, ``u = -K x``, with ``a = exp(-period / tau)``, ``b1 = 1 - exp(-(1 - f) period / tau)`` and
    ``b0 = 1 - a - b1``. The limit is the inverse of the loop's amplitude where its phase first reaches -180
    deg (Nyquist). Without delay it is ``(1 + a) / (1 - a)``; with an ideal actuator (tau -> 0), 1.

    Parameters
    ----------
    time_constant
        Of the steering actuator [s], above 0.
    delay
        Of the steering actuator [s]; every cycle of latency between measurement and actuator adds a period.
    period
        Control period [s], above 0.
    """
    cycles = math.floor(delay / period + 1e-9)
    rest = max(delay / period - cycles, 0.0)
    decay = math.exp(-period / time_constant)
    new = 1.0 - math.exp(-(1.0 - rest) * period / time_constant)
    old = 1.0 - decay - new

    def phase(frequency: float) -> float:
        z = cmath.exp(1j * frequency)
        return cmath.phase(new * z + old) - (cycles + 1) * frequency - cmath.phase(z - decay)

    z = cmath.exp(1j * _first_crossing(phase))
    return abs(z - decay) / abs(new * z + old)


def _first_crossing(phase: Callable[[float], float]) -> float:
    """Return the lowest frequency, as angle per cycle, at which a phase falls to -pi; pi if there only."""
    grid = [math.pi * i / _GRID for i in range(1, _GRID)]
    high = next((frequency for frequency in grid if phase(frequency) <= -math.pi), math.pi)
    low = high - math.pi / _GRID
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if phase(middle) <= -math.pi else (middle, high)
    return high
