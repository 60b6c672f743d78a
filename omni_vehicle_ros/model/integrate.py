"""Integration with a fixed step."""

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

Vector = npt.NDArray[np.float64]


def rk4(rate: Callable[[float, Vector], Vector], time: float, state: Vector, step: float) -> Vector:
    """Advance by one step of the classical Runge-Kutta method, of order 4 (Kutta 1901).

    Parameters
    ----------
    rate
        The derivative as a function of time [s] and state.
    time
        Time at the start of the step [s].
    state
        State at the start, shape (n,); left as it is.
    step
        Length of the step [s].

    Returns
    -------
    ndarray
        State at ``time + step``, shape (n,).
    """
    half = 0.5 * step
    k1 = rate(time, state)
    k2 = rate(time + half, state + half * k1)
    k3 = rate(time + half, state + half * k2)
    k4 = rate(time + step, state + step * k3)
    result: Vector = state + (step / 6.0) * (k1 + 2.0 * (k2 + k3) + k4)
    return result
