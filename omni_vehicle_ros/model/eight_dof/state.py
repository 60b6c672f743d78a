"""The state of the vehicle with 8 degrees of freedom."""

import math
from typing import NamedTuple

import numpy as np

from omni_vehicle_ros.model.state import MAXIMUM_SPEED, MAXIMUM_YAW_RATE, Vector
from omni_vehicle_ros.wheels import PerWheel

# Beyond these the model means nothing; the state stops there so that it stays finite.
MAXIMUM_ROLL = math.pi  # rad
MAXIMUM_SPIN = 1e4  # rad/s

STILL: PerWheel = (0.0, 0.0, 0.0, 0.0)


class EightDofState(NamedTuple):
    """The state at one time, in the order of the vector; the first six as in `State`.

    ``vx``, ``vy`` [m/s] and ``r`` [rad/s] are the twist of the centre of gravity of the whole vehicle in
    base_link, which yaws but does not roll; ``x``, ``y`` [m] and ``psi`` [rad] its pose in odom; ``roll`` [rad]
    and ``roll_rate`` [rad/s] of the sprung mass, positive to the right; ``spin`` of the wheels [rad/s]; then the
    deflections of the tyres along and across the wheel [m], which act below walking pace only.
    """

    vx: float
    vy: float
    r: float
    x: float
    y: float
    psi: float
    roll: float
    roll_rate: float
    spin: PerWheel
    long_deflection: PerWheel
    lat_deflection: PerWheel


def state_vector(state: EightDofState) -> Vector:
    """Return a state as a float64 vector, shape (20,)."""
    return np.array((*state[:8], *state.spin, *state.long_deflection, *state.lat_deflection), dtype=np.float64)


def state_view(vector: Vector) -> EightDofState:
    """Return the entries of a state vector, shape (20,), as plain floats by name."""
    vx, vy, r, x, y, psi, roll, roll_rate, *wheels = vector.tolist()
    fours = tuple(wheels[:4]), tuple(wheels[4:8]), tuple(wheels[8:])
    return EightDofState(vx, vy, r, x, y, psi, roll, roll_rate, *fours)


def initial_state(speed: float, wheel_radius: float) -> Vector:
    """Return the state of a vehicle that rolls straight on through the origin of odom, shape (20,).

    Parameters
    ----------
    speed
        Forward speed [m/s].
    wheel_radius
        Rolling radius [m].
    """
    spin = speed / wheel_radius
    return state_vector(
        EightDofState(speed, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, (spin, spin, spin, spin), STILL, STILL)
    )


def bounded(state: EightDofState) -> EightDofState:
    """Return the state with its speeds, roll and spins within their bounds."""
    spin = state.spin
    return EightDofState(
        _within(state.vx, MAXIMUM_SPEED),
        _within(state.vy, MAXIMUM_SPEED),
        _within(state.r, MAXIMUM_YAW_RATE),
        state.x,
        state.y,
        state.psi,
        _within(state.roll, MAXIMUM_ROLL),
        _within(state.roll_rate, MAXIMUM_YAW_RATE),
        (
            _within(spin[0], MAXIMUM_SPIN),
            _within(spin[1], MAXIMUM_SPIN),
            _within(spin[2], MAXIMUM_SPIN),
            _within(spin[3], MAXIMUM_SPIN),
        ),
        state.long_deflection,
        state.lat_deflection,
    )


def moved(state: EightDofState, rate: EightDofState, time: float) -> EightDofState:
    """Return the state plus ``time`` [s] times a rate."""
    return EightDofState(
        state.vx + time * rate.vx,
        state.vy + time * rate.vy,
        state.r + time * rate.r,
        state.x + time * rate.x,
        state.y + time * rate.y,
        state.psi + time * rate.psi,
        state.roll + time * rate.roll,
        state.roll_rate + time * rate.roll_rate,
        _four_moved(state.spin, rate.spin, time),
        _four_moved(state.long_deflection, rate.long_deflection, time),
        _four_moved(state.lat_deflection, rate.lat_deflection, time),
    )


def _within(value: float, limit: float) -> float:
    return max(-limit, min(limit, value))


def _four_moved(four: PerWheel, rate: PerWheel, time: float) -> PerWheel:
    return four[0] + time * rate[0], four[1] + time * rate[1], four[2] + time * rate[2], four[3] + time * rate[3]
