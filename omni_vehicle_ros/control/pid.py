"""A PID law."""

import math


class Pid:
    """A PID law with a filtered derivative and conditional anti-windup.

    ``output = gain e + integral of (integral_gain e) + derivative_gain s / (time_constant s + 1) e``, exact
    for an error that runs linearly between its samples. The integral stands still while the output is beyond
    its limit and the error would drive it further.

    Parameters
    ----------
    gain, integral_gain, derivative_gain
        Gains of the three parts; the output has the unit of the error.
    derivative_time_constant
        Of the filter of the derivative [s].
    limit
        Largest output, to either side.

    Attributes
    ----------
    limit
        As above; may change from call to call.
    saturated
        Whether the last output was at its limit.
    """

    def __init__(
        self, gain: float, integral_gain: float, derivative_gain: float, derivative_time_constant: float, limit: float
    ) -> None:
        self._gains = gain, integral_gain, derivative_gain
        self._time_constant = derivative_time_constant
        self.limit = limit
        self.saturated = False
        self.reset()

    def reset(self) -> None:
        """Forget the past."""
        self._integral = 0.0
        self._filtered: float | None = None
        self._last = 0.0

    def update(self, error: float, dt: float) -> float:
        """Return the output.

        Parameters
        ----------
        error
            Target minus measurement.
        dt
            Time since the last call [s]; 0 or less starts anew.
        """
        if dt <= 0.0 or self._filtered is None:
            self.reset()
            self._filtered = self._last = error
            return self._clip(self._gains[0] * error)
        gain, integral_gain, derivative_gain = self._gains
        self._filtered = self._filter(self._filtered, error, dt)
        direct = gain * error + derivative_gain * (error - self._filtered) / self._time_constant
        integral = self._integral + integral_gain * 0.5 * (error + self._last) * dt
        if abs(direct + integral) <= self.limit or (direct + integral) * (integral - self._integral) <= 0.0:
            self._integral = integral
        self._last = error
        return self._clip(direct + self._integral)

    def _filter(self, filtered: float, error: float, dt: float) -> float:
        decay, lead = math.exp(-dt / self._time_constant), (error - self._last) * self._time_constant / dt
        return error - lead + decay * (filtered - self._last + lead)

    def _clip(self, output: float) -> float:
        self.saturated = abs(output) > self.limit
        return min(max(output, -self.limit), self.limit)
