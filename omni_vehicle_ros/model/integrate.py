"""Integration over one control cycle with a fixed step.

Written in the part of Python that numba compiles, like `dynamics`.
"""

from omni_vehicle_ros.model.constants import Constants
from omni_vehicle_ros.model.dynamics import Environment, Inputs, state_rate
from omni_vehicle_ros.model.state import State, bounded
from omni_vehicle_ros.wheels import PerWheel

NODES = (0.0, 0.5, 0.5, 1.0)
"""How far ahead of the start of its step each stage looks, in steps; the first one looks at the start itself."""
WEIGHTS = (1 / 6, 1 / 3, 1 / 3, 1 / 6)


def integrate(
    state: State,
    inputs: Inputs,
    steer_rate: PerWheel,
    environment: Environment,
    constants: Constants,
    steps: int,
    size: float,
    constant_speed: bool,
) -> State:
    """Return the state after some steps of the classical Runge-Kutta method, of order 4 (Kutta 1901).

    Parameters
    ----------
    state
        State at the start.
    inputs, steer_rate
        Steer angles [rad], drive forces [N] and slip gains at the start, and the held rates of the angles [rad/s].
    environment, constants
        What acts on the vehicle, and the vehicle.
    steps, size
        How many steps, and how long each of them is [s].
    constant_speed
        Hold vx (2 degrees of freedom); drive forces are left out.
    """
    for number in range(steps):
        state = bounded(state)
        rate = end = state
        for stage in range(4):
            ahead = NODES[stage] * size
            now = moved(state, rate, ahead)
            set_points = steered(inputs, steer_rate, number * size + ahead)
            rate = state_rate(now, set_points, environment, constants, constant_speed)
            end = moved(end, rate, WEIGHTS[stage] * size)
        state = end
    return bounded(state)


def steered(inputs: Inputs, rate: PerWheel, time: float) -> Inputs:
    """Return the inputs ``time`` [s] later, at steer rates that are held [rad/s]."""
    fl, fr, rl, rr = inputs.steer_angle
    angles = fl + time * rate[0], fr + time * rate[1], rl + time * rate[2], rr + time * rate[3]
    return Inputs(angles, inputs.drive_force, inputs.slip_gain)


def moved(state: State, rate: State, time: float) -> State:
    """Return the state after some time [s] at a rate that is held."""
    return State(
        state.vx + time * rate.vx,
        state.vy + time * rate.vy,
        state.r + time * rate.r,
        state.x + time * rate.x,
        state.y + time * rate.y,
        state.psi + time * rate.psi,
        state.front_left + time * rate.front_left,
        state.front_right + time * rate.front_right,
        state.rear_left + time * rate.rear_left,
        state.rear_right + time * rate.rear_right,
    )
