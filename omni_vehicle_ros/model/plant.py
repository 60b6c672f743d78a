"""The vehicle over one control cycle: the actuators move as told, everything else holds."""

from omni_vehicle_ros.model.body import Environment, Inputs, derivative
from omni_vehicle_ros.model.constants import Constants
from omni_vehicle_ros.model.integrate import Vector, rk4
from omni_vehicle_ros.model.state import bounded
from omni_vehicle_ros.wheels import PerWheel


def advance(
    state: Vector,
    steer_angle: PerWheel,
    steer_rate: PerWheel,
    drive_force: PerWheel,
    environment: Environment,
    constants: Constants,
    duration: float,
    step: float,
    constant_speed: bool = False,
) -> Vector:
    """Return the state after one control cycle.

    Parameters
    ----------
    state
        State at the start, shape (10,); left as it is.
    steer_angle, steer_rate
        Steer angles at the start [rad] and their rates, held over the cycle [rad/s]; fl, fr, rl, rr.
    drive_force
        Traction (+) or brake (-) along each wheel [N].
    environment, constants
        What acts on the vehicle, and the vehicle.
    duration
        Length of the cycle [s].
    step
        Integration step [s]; the nearest that divides the cycle without rest is taken.
    constant_speed
        Hold vx (2 degrees of freedom); drive forces are left out.

    Returns
    -------
    ndarray
        State at the end, shape (10,); finite whenever the input is.
    """
    steps = max(1, round(duration / step))
    fl, fr, rl, rr = steer_angle
    fl_rate, fr_rate, rl_rate, rr_rate = steer_rate

    def rate(time: float, now: Vector) -> Vector:
        angles = fl + time * fl_rate, fr + time * fr_rate, rl + time * rl_rate, rr + time * rr_rate
        return derivative(now, Inputs(angles, drive_force), environment, constants, constant_speed)

    size = duration / steps
    for number in range(steps):
        state = bounded(rk4(rate, number * size, bounded(state), size))
    return state
