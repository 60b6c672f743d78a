"""Integration over one control cycle with a fixed step.

Written in the part of Python that numba compiles, like `dynamics`.
"""

from omni_vehicle_ros.model.constants import Constants
from omni_vehicle_ros.model.dynamics import Environment, Inputs, state_rate
from omni_vehicle_ros.model.state import State, bounded
from omni_vehicle_ros.wheels import PerWheel


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
    half = 0.5 * size
    for number in range(steps):
        time, state = number * size, bounded(state)
        start = steered(inputs, steer_rate, time)
        middle = steered(inputs, steer_rate, time + half)
        end = steered(inputs, steer_rate, time + size)
        k1 = state_rate(state, start, environment, constants, constant_speed)
        k2 = state_rate(_moved(state, k1, half), middle, environment, constants, constant_speed)
        k3 = state_rate(_moved(state, k2, half), middle, environment, constants, constant_speed)
        k4 = state_rate(_moved(state, k3, size), end, environment, constants, constant_speed)
        state = _moved(state, _six_fold_mean(k1, k2, k3, k4), size / 6.0)
    return bounded(state)


def steered(inputs: Inputs, rate: PerWheel, time: float) -> Inputs:
    """Return the inputs ``time`` [s] later, at steer rates that are held [rad/s]."""
    fl, fr, rl, rr = inputs.steer_angle
    angles = fl + time * rate[0], fr + time * rate[1], rl + time * rate[2], rr + time * rate[3]
    return Inputs(angles, inputs.drive_force, inputs.slip_gain)


def _moved(state: State, rate: State, time: float) -> State:
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


def _six_fold_mean(k1: State, k2: State, k3: State, k4: State) -> State:
    return State(
        k1.vx + 2.0 * (k2.vx + k3.vx) + k4.vx,
        k1.vy + 2.0 * (k2.vy + k3.vy) + k4.vy,
        k1.r + 2.0 * (k2.r + k3.r) + k4.r,
        k1.x + 2.0 * (k2.x + k3.x) + k4.x,
        k1.y + 2.0 * (k2.y + k3.y) + k4.y,
        k1.psi + 2.0 * (k2.psi + k3.psi) + k4.psi,
        k1.front_left + 2.0 * (k2.front_left + k3.front_left) + k4.front_left,
        k1.front_right + 2.0 * (k2.front_right + k3.front_right) + k4.front_right,
        k1.rear_left + 2.0 * (k2.rear_left + k3.rear_left) + k4.rear_left,
        k1.rear_right + 2.0 * (k2.rear_right + k3.rear_right) + k4.rear_right,
    )
