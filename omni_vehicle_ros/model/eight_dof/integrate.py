"""Integration over one control cycle with a fixed step, and brakes that hold.

Written in the part of Python that numba compiles, like `dynamics`.
"""

import math

from omni_vehicle_ros.model.contact import HOLDING_PACE
from omni_vehicle_ros.model.dynamics import Environment, Inputs
from omni_vehicle_ros.model.eight_dof.constants import EightDofConstants
from omni_vehicle_ros.model.eight_dof.dynamics import state_rate
from omni_vehicle_ros.model.eight_dof.state import EightDofState, bounded, moved
from omni_vehicle_ros.model.integrate import steered
from omni_vehicle_ros.wheels import PerWheel


def integrate(
    state: EightDofState,
    inputs: Inputs,
    steer_rate: PerWheel,
    environment: Environment,
    constants: EightDofConstants,
    steps: int,
    size: float,
    constant_speed: bool,
) -> EightDofState:
    """Return the state after some steps of the classical Runge-Kutta method, of order 4 (Kutta 1901).

    Parameters
    ----------
    state
        State at the start.
    inputs, steer_rate
        Steer angles [rad], torques over wheel radius [N] and slip gains at the start, and the rates of the
        angles, held [rad/s].
    environment, constants
        What acts on the vehicle, and the vehicle.
    steps, size
        How many steps, and how long each of them is [s].
    constant_speed
        Hold vx; torques are left out.
    """
    braked = braked_ways(state, inputs, constants)
    for number in range(steps):
        time, state = number * size, bounded(state)
        start = steered(inputs, steer_rate, time)
        middle = steered(inputs, steer_rate, time + 0.5 * size)
        end = steered(inputs, steer_rate, time + size)
        k1 = state_rate(state, start, environment, constants, constant_speed)
        k2 = state_rate(moved(state, k1, 0.5 * size), middle, environment, constants, constant_speed)
        k3 = state_rate(moved(state, k2, 0.5 * size), middle, environment, constants, constant_speed)
        k4 = state_rate(moved(state, k3, size), end, environment, constants, constant_speed)
        outer, inner = moved(moved(state, k1, size / 6.0), k4, size / 6.0), size / 3.0
        state = _held(moved(moved(outer, k2, inner), k3, inner), braked)
    return bounded(state)


def braked_ways(state: EightDofState, inputs: Inputs, constants: EightDofConstants) -> PerWheel:
    """Return which way each wheel is braked over the cycle: the sign of its motion, 0 for one that is driven.

    A torque against the spin of a wheel is a brake. So is one against the motion of a locked wheel over
    ground: it stays locked until the vehicle stands. On a wheel that stands, any torque is a drive.

    Parameters
    ----------
    state, inputs
        At the start of the cycle.
    constants
        The vehicle.
    """
    return (
        _braked_way(state, inputs, 0, constants),
        _braked_way(state, inputs, 1, constants),
        _braked_way(state, inputs, 2, constants),
        _braked_way(state, inputs, 3, constants),
    )


def _braked_way(state: EightDofState, inputs: Inputs, wheel: int, constants: EightDofConstants) -> float:
    motion = state.spin[wheel]
    if motion == 0.0:
        angle, plane = inputs.steer_angle[wheel], constants.plane
        along = state.vx - plane.wheel_y[wheel] * state.r
        across = state.vy + plane.wheel_x[wheel] * state.r
        speed = along * math.cos(angle) + across * math.sin(angle)
        motion = speed if abs(speed) > HOLDING_PACE else 0.0
    return math.copysign(1.0, motion) if motion * inputs.drive_force[wheel] < 0.0 else 0.0


def _held(state: EightDofState, braked: PerWheel) -> EightDofState:
    """Return the state with no wheel turned round by its brake."""
    spin = state.spin
    return EightDofState(
        state.vx,
        state.vy,
        state.r,
        state.x,
        state.y,
        state.psi,
        state.roll,
        state.roll_rate,
        (
            0.0 if spin[0] * braked[0] < 0.0 else spin[0],
            0.0 if spin[1] * braked[1] < 0.0 else spin[1],
            0.0 if spin[2] * braked[2] < 0.0 else spin[2],
            0.0 if spin[3] * braked[3] < 0.0 else spin[3],
        ),
        state.long_deflection,
        state.lat_deflection,
    )
