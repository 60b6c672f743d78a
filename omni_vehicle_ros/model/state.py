"""The state of the vehicle: a numpy vector for the integrator, a NamedTuple for everyone else."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

Vector = npt.NDArray[np.float64]

# Beyond these the model means nothing; the state stops there so that it stays finite.
MAXIMUM_SPEED = 1e3  # m/s
MAXIMUM_YAW_RATE = 200.0  # rad/s


class State(NamedTuple):
    """The state at one time, in the order of the vector.

    ``vx``, ``vy`` [m/s] and ``r`` [rad/s] are the twist of the centre of gravity in base_link; ``x``, ``y`` [m]
    and ``psi`` [rad] its pose in odom, psi not wrapped; then the lateral deflection of each tyre [m], which acts
    below walking pace only.
    """

    vx: float
    vy: float
    r: float
    x: float
    y: float
    psi: float
    front_left: float
    front_right: float
    rear_left: float
    rear_right: float


def state_vector(state: State) -> Vector:
    """Return a state as a float64 vector, shape (10,)."""
    return np.array(state, dtype=np.float64)


def state_view(vector: Vector) -> State:
    """Return the entries of a state vector, shape (10,), as plain floats by name."""
    return State._make(vector.tolist())


def initial_state(speed: float = 0.0) -> Vector:
    """Return the state of a vehicle that rolls straight on through the origin of odom, shape (10,).

    Parameters
    ----------
    speed
        Forward speed [m/s].
    """
    return state_vector(State(speed, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0))


def bounded(state: State) -> State:
    """Return the state with its speeds within `MAXIMUM_SPEED` and `MAXIMUM_YAW_RATE`."""
    return State(
        max(-MAXIMUM_SPEED, min(MAXIMUM_SPEED, state.vx)),
        max(-MAXIMUM_SPEED, min(MAXIMUM_SPEED, state.vy)),
        max(-MAXIMUM_YAW_RATE, min(MAXIMUM_YAW_RATE, state.r)),
        state.x,
        state.y,
        state.psi,
        state.front_left,
        state.front_right,
        state.rear_left,
        state.rear_right,
    )
