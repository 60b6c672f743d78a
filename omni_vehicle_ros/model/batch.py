"""Many vehicles at once, in the plane: the same physics on structures of arrays, several lanes at a time.

All arrays have a column for each vehicle; one with a single column holds for all vehicles. Each vehicle comes out as
it would alone, whatever stands beside it and however many threads there are.
"""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from omni_vehicle_ros.model.batch_compiled import WIDTH, drive_kernel
from omni_vehicle_ros.model.constants import Constants
from omni_vehicle_ros.model.packing import STATE, listed_constants
from omni_vehicle_ros.model.state import Vector

RATES, WHEELS = 4, 4
WATCHED = STATE + 6 * WHEELS + 3 + 2 * WHEELS
"""Rows: state, evaluation, largest slips and uses."""


class BatchEvaluation(NamedTuple):
    """What follows from states at one instant, as in `Evaluation`; shapes (4, n), and (n,) of the last three."""

    steer_angle: Vector
    side_slip: Vector
    longitudinal_force: Vector
    lateral_force: Vector
    vertical_load: Vector
    friction_use: Vector
    roll_angle: Vector
    ax: Vector
    ay: Vector


class Drive(NamedTuple):
    """What vehicles have come to.

    Attributes
    ----------
    states
        At the end, shape (10, n).
    evaluation
        At the end.
    largest_slip, largest_use
        Largest sizes of side slip [rad] and of friction use on the way, shape (4, n).
    """

    states: Vector
    evaluation: BatchEvaluation
    largest_slip: Vector
    largest_use: Vector


def packed_batch(constants: Constants | list[Constants]) -> Vector:
    """Return constants as the functions of this module take them, shape (m, n).

    Parameters
    ----------
    constants
        Of all vehicles, or of each; of one tyre model, one friction circle and one table of the wind for all.
    """
    vehicles = [constants] if isinstance(constants, Constants) else constants
    return np.array([listed_constants(vehicle) for vehicle in vehicles], dtype=np.float64).T.copy()


def advance_batch(
    states: Vector,
    inputs: Vector,
    rates: Vector,
    environment: Vector,
    constants: Vector,
    steps: int,
    size: float,
    constant_speed: bool = False,
    threads: int = 1,
) -> Vector:
    """Return the states after some steps, shape (10, n).

    Parameters
    ----------
    states
        Of each vehicle, in the order of `State`, shape (10, n).
    inputs
        Steer angles at the start [rad], drive forces [N] and slip gains, shape (12, n) or (12, 1); see `Inputs`.
    rates
        Steer rates, held over all steps [rad/s], shape (4, n) or (4, 1).
    environment
        Bank [rad], wind [m/s] and friction under each wheel, shape (6, n) or (6, 1).
    constants
        From `packed_batch`, shape (m, n) or (m, 1).
    steps, size
        How many steps of the Runge-Kutta method, and how long each of them is [s].
    constant_speed
        Hold vx (2 degrees of freedom); drive forces are left out.
    threads
        How many share the vehicles.
    """
    found = _driven(states, inputs, rates, environment, constants, 1, steps, size, constant_speed, threads, False)
    return found[:STATE]


def drive_batch(
    states: Vector,
    inputs: Vector,
    rates: Vector,
    environment: Vector,
    constants: Vector,
    cycles: int,
    steps: int,
    size: float,
    constant_speed: bool = False,
    threads: int = 1,
) -> Drive:
    """Do as `advance_batch` for some cycles, and say what the wheels do.

    Parameters
    ----------
    states, inputs, rates, environment, constants, size, constant_speed, threads
        As in `advance_batch`.
    cycles, steps
        How many cycles of how many steps; slips are looked at before the first and after each. None: how the vehicles
        begin.
    """
    found = _driven(states, inputs, rates, environment, constants, cycles, steps, size, constant_speed, threads, True)
    per_wheel = [found[row : row + WHEELS] for row in range(STATE, STATE + 6 * WHEELS, WHEELS)]
    single = found[STATE + 6 * WHEELS : -2 * WHEELS]
    evaluation = BatchEvaluation(*per_wheel, *single)
    return Drive(found[:STATE], evaluation, found[-2 * WHEELS : -WHEELS], found[-WHEELS:])


def evaluate_batch(
    states: Vector,
    inputs: Vector,
    environment: Vector,
    constants: Vector,
    constant_speed: bool = False,
    threads: int = 1,
) -> BatchEvaluation:
    """Return slips, forces and loads at one instant; parameters as in `advance_batch`."""
    still = np.zeros((RATES, 1))
    return drive_batch(states, inputs, still, environment, constants, 0, 1, 0.0, constant_speed, threads).evaluation


def _driven(
    states: Vector,
    inputs: Vector,
    rates: Vector,
    environment: Vector,
    constants: Vector,
    cycles: int,
    steps: int,
    size: float,
    constant_speed: bool,
    threads: int,
    watched: bool,
) -> Vector:
    count = states.shape[1]
    request = _request(states, inputs, environment, rates)
    model, shared = _constants(constants)
    found = np.zeros((WATCHED if watched else STATE, request.shape[1]))

    def work(first: int, last: int) -> None:
        drive_kernel(
            request, model, shared, cycles, steps, size, constant_speed, watched, first, last, WIDTH, found
        )

    _share(work, request.shape[1], threads)
    return found[:, :count]


def _request(*parts: Vector) -> Vector:
    """Return all rows one below the other, in whole blocks of columns."""
    count = parts[0].shape[1]
    request = np.empty((sum(map(len, parts)), -(-count // WIDTH) * WIDTH))
    np.concatenate([np.broadcast_to(part, (len(part), count)) for part in parts], out=request[:, :count])
    return _filled(request, count)


def _constants(constants: Vector) -> tuple[Vector, Vector]:
    """Return constants in whole blocks of columns, and those of one vehicle, which tell what all have in common."""
    rows, count = constants.shape
    model = np.empty((rows, -(-count // WIDTH) * WIDTH))
    model[:, :count] = constants
    return _filled(model, count), model[:, 0].copy()


def _filled(columns: Vector, count: int) -> Vector:
    """Let the last vehicle drive in all lanes that are left over."""
    columns[:, count:] = columns[:, count - 1 : count]
    return columns


def _share(work: Callable[[int, int], None], columns: int, threads: int) -> None:
    """Let each thread work on its own columns, in whole blocks."""
    blocks = columns // WIDTH
    ends = [WIDTH * (blocks * thread // threads) for thread in range(threads + 1)]
    if threads == 1:
        work(*ends)
        return
    with ThreadPoolExecutor(threads) as pool:
        for done in [pool.submit(work, *pair) for pair in pairwise(ends)]:
            done.result()
