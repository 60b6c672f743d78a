"""Actuators of a wheel: time delay, time constant, rate limit and range, each cycle solved exactly."""

import math

from omni_vehicle_ros.control.freshness import NANOSECONDS
from omni_vehicle_ros.parameters import WheelModuleParameters


def lag_step(value: float, target: float, duration: float, time_constant: float, rate_limit: float) -> float:
    """Return where a first-order lag with a limited rate is after ``duration``, exactly.

    Parameters
    ----------
    value, target
        Where it is and where it is told to be.
    duration, time_constant
        [s], the second one above 0.
    rate_limit
        Largest rate, in units of ``value`` per second, above 0.
    """
    error = target - value
    threshold = rate_limit * time_constant
    if abs(error) > threshold:
        slewing = (abs(error) - threshold) / rate_limit
        if duration <= slewing:
            return value + math.copysign(rate_limit * duration, error)
        error, duration = math.copysign(threshold, error), duration - slewing
    return target - error * math.exp(-duration / time_constant)


class SteerActuator:
    """The steering of one wheel.

    Parameters
    ----------
    parameters
        Delay, time constant, rate limit and range.
    angle
        Where the wheel points at first [rad].

    Notes
    -----
    A set-point counts from the instant that it is given until the next one is; the delay shifts this
    staircase in time, by any number of cycles and fractions. Between its steps the lag is solved in closed
    form, so the angle doesn't depend on the control period.
    """

    def __init__(self, parameters: WheelModuleParameters, angle: float = 0.0) -> None:
        self._parameters = parameters
        self._delay = round(parameters.steer_delay * NANOSECONDS)
        self._angle = angle
        self._now: int | None = None
        self._foreseen: tuple[int, float] | None = None
        # From when on each set-point acts [ns]; the first one does already.
        self._staircase: list[tuple[int, float]] = []
        self._rate_limit = parameters.steer_rate_limit

    def rest_at(self, angle: float) -> None:
        """Begin anew at an angle [rad], as if no set-point had ever been given."""
        self._angle, self._now, self._foreseen = angle, None, None

    def slow_to(self, share: float) -> None:
        """Move from now on at most at this share of the rate limit."""
        self._rate_limit = share * self._parameters.steer_rate_limit

    @property
    def angle(self) -> float:
        """Steer angle at the time of the last update [rad]."""
        return self._angle

    def reach(self, now: int) -> float:
        """Go on to ``now`` [ns] with the set-points given so far, and return the steer angle there [rad]."""
        if self._now is None or now < self._now:
            self._staircase = [(now, self._angle)]
        elif self._foreseen is not None and self._foreseen[0] == now:
            self._angle = self._foreseen[1]
        elif now > self._now and not self._parameters.ideal_actuators:
            self._angle = self._follow(self._now, now)
        self._now = now
        return self._angle

    def update(self, now: int, set_point: float, period: float) -> tuple[float, float]:
        """Take a set-point.

        Parameters
        ----------
        now
            The present [ns]; a clock that jumped back starts the delay anew from the present angle.
        set_point
            Where the wheel should point [rad]; beyond the range it is clipped.
        period
            Time to the next cycle [s].

        Returns
        -------
        tuple of float
            Steer angle at the begin of the coming cycle [rad], and mean steer rate over it [rad/s].
        """
        limit = self._parameters.steer_limit
        if abs(set_point) > limit:
            set_point = math.copysign(limit, set_point)
        self.reach(now)
        if self._parameters.ideal_actuators:
            self._angle = set_point
            return set_point, 0.0
        self._remember(now, set_point)
        end = now + round(period * NANOSECONDS)
        ahead = self._follow(now, end)
        self._foreseen = end, ahead
        return self._angle, (ahead - self._angle) / period

    def _remember(self, now: int, set_point: float) -> None:
        steps, start = self._staircase, now + self._delay
        if steps[-1][0] == start:
            steps.pop()
        steps.append((start, set_point))
        while len(steps) > 1 and steps[1][0] <= now:
            del steps[0]

    def _follow(self, begin: int, end: int) -> float:
        angle, set_point = self._angle, self._staircase[0][1]
        tau, rate_limit = self._parameters.steer_time_constant, self._rate_limit
        for start, following in self._staircase:
            if start >= end:
                break
            if start > begin:
                angle = lag_step(angle, set_point, (start - begin) / NANOSECONDS, tau, rate_limit)
                begin = start
            set_point = following
        return lag_step(angle, set_point, (end - begin) / NANOSECONDS, tau, rate_limit)


class DriveActuator:
    """The drive and brake of one wheel: a first-order lag of the torque, within a limit.

    Parameters
    ----------
    parameters
        Time constant and limit.
    """

    def __init__(self, parameters: WheelModuleParameters) -> None:
        self._parameters = parameters
        self._torque = 0.0
        self._time_constant = parameters.drive_time_constant

    def rest_at(self, torque: float) -> None:
        """Begin anew at a torque [N m]."""
        self._torque = torque

    def slow_to(self, share: float) -> None:
        """Follow from now on at this share of the speed: with a time constant that is so much longer."""
        self._time_constant = self._parameters.drive_time_constant / share

    def update(self, set_point: float, period: float) -> float:
        """Take a set-point.

        Parameters
        ----------
        set_point
            Torque [N m]; beyond the limit it is clipped.
        period
            Time to the next cycle [s].

        Returns
        -------
        float
            Mean torque over the cycle [N m], so that the angular momentum is the exact one.
        """
        limit = self._parameters.drive_torque_limit
        if abs(set_point) > limit:
            set_point = math.copysign(limit, set_point)
        if self._parameters.ideal_actuators:
            return set_point
        ratio = period / self._time_constant
        excess, decay = self._torque - set_point, math.exp(-ratio)
        self._torque = set_point + excess * decay
        return set_point + excess * (1.0 - decay) / ratio
