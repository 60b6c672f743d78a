"""The side-slip controller: a PID for each wheel steers its tyre to zero side slip (thesis, chapter 5)."""

import math

from omni_vehicle_ros.control.freshness import NANOSECONDS
from omni_vehicle_ros.control.health import ERROR, WARN, Health, health
from omni_vehicle_ros.parameters import SideSlipParameters
from omni_vehicle_ros.wheels import WHEELS, PerWheel, per_wheel

# After a longer gap the past says nothing about the rate of the error.
_LONGEST_GAP = 0.5


def exact_side_slip(steer_free_slip: float, gain: float) -> float:
    """Return the side slip that a proportional gain leaves, solved algebraically.

    Slip depends at once on the angle that corrects it: ``alpha = alpha0 + delta`` with ``delta = -K alpha``
    gives ``alpha = alpha0 / (1 + K)`` (thesis, chapter 5). It is what the sampled loop with an actuator tends
    to as their time constant and period go to 0.

    Parameters
    ----------
    steer_free_slip
        Side slip without the controller's trim [rad].
    gain
        Proportional gain, 0 or above.
    """
    return steer_free_slip / (1.0 + gain)


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
    """

    def __init__(
        self, gain: float, integral_gain: float, derivative_gain: float, derivative_time_constant: float, limit: float
    ) -> None:
        self._gains = gain, integral_gain, derivative_gain
        self._time_constant = derivative_time_constant
        self._limit = limit
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
        if abs(direct + integral) <= self._limit or (direct + integral) * (integral - self._integral) <= 0.0:
            self._integral = integral
        self._last = error
        return self._clip(direct + self._integral)

    def _filter(self, filtered: float, error: float, dt: float) -> float:
        decay, lead = math.exp(-dt / self._time_constant), (error - self._last) * self._time_constant / dt
        return error - lead + decay * (filtered - self._last + lead)

    def _clip(self, output: float) -> float:
        self.saturated = abs(output) > self._limit
        return min(max(output, -self._limit), self._limit)


class SideSlipController:
    """Four PIDs: ``trim_i = PID(0 - side_slip_i)``.

    Positive side slip makes a force to the left, and a larger steer angle makes more of it (thesis eq. B.11),
    so this is negative feedback. The trim fades out below ``minimum_speed``, where a slip angle means little.
    How large a gain may be: `omni_vehicle_ros.control.stability`. With the default actuator, 0.1 s and 5 ms,
    and a period of 5 ms the limit is 20.5, and the largest gain of the thesis, 5, a quarter of it.

    Parameters
    ----------
    parameters
        Gains and limits.
    """

    def __init__(self, parameters: SideSlipParameters) -> None:
        p = self._parameters = parameters
        self._pids = tuple(
            Pid(*gains, p.derivative_time_constant, p.trim_limit)
            for gains in zip(p.proportional_gains, p.integral_gains, p.derivative_gains, strict=True)
        )
        self._stamp: int | None = None
        self._dt = 0.0
        self._trims: PerWheel = (0.0, 0.0, 0.0, 0.0)
        self._bad: tuple[str, ...] = ()

    def update(self, stamp: int, side_slip: PerWheel, speeds: PerWheel) -> PerWheel:
        """Return the steering trims of the four wheels [rad].

        Parameters
        ----------
        stamp
            When the slip was measured [ns]. The same stamp again gives the same answer; a clock that
            jumped back, or a long gap, starts anew.
        side_slip
            Side-slip angles [rad].
        speeds
            Speeds of the wheels along their headings [m/s].
        """
        if stamp == self._stamp:
            return self._trims
        dt = 0.0 if self._stamp is None else (stamp - self._stamp) / NANOSECONDS
        self._dt = dt if dt <= _LONGEST_GAP else 0.0
        self._stamp = stamp
        self._bad = tuple(
            wheel for i, wheel in enumerate(WHEELS) if not (math.isfinite(side_slip[i]) and math.isfinite(speeds[i]))
        )
        self._trims = per_wheel(lambda i: self._trim(i, side_slip[i], speeds[i]))
        return self._trims

    @property
    def status(self) -> Health:
        """How the controller is doing, as of the last update."""
        notes = [(ERROR, f'side slip or speed of {wheel} is not finite: its last trim holds') for wheel in self._bad]
        limit = self._parameters.trim_limit
        for wheel, pid in zip(WHEELS, self._pids, strict=True):
            if pid.saturated:
                notes.append((WARN, f'trim of {wheel} is at trim_limit, {limit:g} rad'))
        return health(notes, 'controlling side slip')

    def _trim(self, i: int, side_slip: float, speed: float) -> float:
        if WHEELS[i] in self._bad:
            return self._trims[i]
        half = 0.5 * self._parameters.minimum_speed
        fade = min(max(abs(speed) / half - 1.0, 0.0), 1.0)
        pid = self._pids[i]
        if fade == 0.0:
            pid.reset()
            pid.saturated = False
            return 0.0
        # A side-slip angle is never past 90 deg, whatever a sensor says; a wheel that rolls backward turns away from
        # the slip by a larger steer angle, not by a smaller one.
        slip = math.copysign(min(max(side_slip, -0.5 * math.pi), 0.5 * math.pi), side_slip * speed)
        return fade * pid.update(-slip, self._dt)
