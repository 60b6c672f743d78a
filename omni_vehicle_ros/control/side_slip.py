"""The side-slip controller: a PID for each wheel steers its tyre to zero side slip (thesis, chapter 5)."""

import math

from omni_vehicle_ros.control.health import ERROR, WARN, Health, health
from omni_vehicle_ros.control.pid import Pid
from omni_vehicle_ros.control.trim import NO_TRIMS, Cycles, Sensed, Trims, fade
from omni_vehicle_ros.parameters import SideSlipParameters
from omni_vehicle_ros.wheels import WHEELS, per_wheel


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


class SideSlipController:
    """Four PIDs: ``trim_i = PID(0 - side_slip_i)``.

    Positive side slip makes a force to the left, and a larger steer angle makes more of it (thesis eq. B.11),
    so this is negative feedback. The trim fades out below ``minimum_speed``, where a slip angle means little.
    How large a gain may be: `omni_vehicle_ros.control.loop_check`. With the default actuator, 0.1 s and 5 ms,
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
        self._cycles = Cycles()
        self._trims = NO_TRIMS
        self._bad: tuple[str, ...] = ()

    def update(self, stamp: int, sensed: Sensed) -> Trims:
        """Return the trims of a cycle, which have no torque; see `Controller.update`.

        Of what is sensed it needs side slips and wheel speeds only; a wheel with no number keeps its last
        trim.
        """
        dt = self._cycles.next(stamp)
        if dt is None:
            return self._trims
        slip, speed = sensed.side_slip, sensed.wheel_speed
        self._bad = () if all(map(math.isfinite, slip + speed)) else tuple(
            wheel for i, wheel in enumerate(WHEELS) if not (math.isfinite(slip[i]) and math.isfinite(speed[i]))
        )
        self._trims = Trims(per_wheel(lambda i: self._trim(i, slip[i], speed[i], dt)))
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

    def _trim(self, i: int, side_slip: float, speed: float, dt: float) -> float:
        if WHEELS[i] in self._bad:
            return self._trims.steer_angle[i]
        share = fade(speed, self._parameters.minimum_speed)
        pid = self._pids[i]
        if share == 0.0:
            pid.reset()
            pid.saturated = False
            return 0.0
        # A side-slip angle is never past 90 deg, whatever a sensor says; a wheel that rolls backward turns away from
        # the slip by a larger steer angle, not by a smaller one.
        slip = math.copysign(min(max(side_slip, -0.5 * math.pi), 0.5 * math.pi), side_slip * speed)
        return share * pid.update(-slip, dt)
