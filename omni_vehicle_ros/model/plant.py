"""The vehicle over one control cycle: the actuators move as told, everything else holds."""

from omni_vehicle_ros.model.compiled import kernel
from omni_vehicle_ros.model.constants import Constants
from omni_vehicle_ros.model.dynamics import NO_GAIN, Environment, Inputs
from omni_vehicle_ros.model.integrate import integrate
from omni_vehicle_ros.model.packing import STATE, packed_constants, packed_request, vector
from omni_vehicle_ros.model.state import Vector, state_vector, state_view
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
    slip_gain: PerWheel = NO_GAIN,
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
    slip_gain
        Proportional gains by which the wheels are steered to zero side slip without any lag, `steer_angle` being
        their set-points then; see `Inputs`.

    Returns
    -------
    ndarray
        State at the end, shape (10,); finite whenever the input is.
    """
    steps = max(1, round(duration / step))
    size = float(duration) / steps
    inputs = Inputs(steer_angle, drive_force, slip_gain)
    run = kernel('advance')
    if run is None:
        now = state_view(state)
        return state_vector(
            integrate(now, inputs, steer_rate, environment, constants, steps, size, constant_speed)
        )
    request = packed_request(state, inputs, environment, constant_speed, steer_rate, steps, size)
    run(request, packed_constants(constants))
    return vector(request)[:STATE]
