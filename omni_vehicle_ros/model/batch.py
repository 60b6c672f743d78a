"""Many vehicles at once, in the plane: the same physics on structures of arrays, several lanes at a time.

All arrays have a column for each vehicle; one with a single column holds for all vehicles. Each vehicle comes out as
it would alone, whatever stands beside it and however many threads there are.
"""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np

from omni_vehicle_ros.model.batch_compiled import WIDTH, drive_kernel, evaluate_kernel
from omni_vehicle_ros.model.compiled import packed_constants
from omni_vehicle_ros.model.constants import Constants
from omni_vehicle_ros.model.state import Vector

STATE, INPUTS, ENVIRONMENT, RATES = 10, 12, 6, 4
WHEELS = 4
PEAKS = 2 * WHEELS
EVALUATED = 6 * WHEELS + 3


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
    """The end of a drive, shape (10, n), and the largest sizes of side slip [rad] and friction use on the way, (4, n)."""

    states: Vector
    side_slip: Vector
    friction_use: Vector


def packed_batch(constants: Constants | list[Constants]) -> Vector:
    """Return constants as the functions of this module take them, shape (m, n).

    Parameters
    ----------
    constants
        Of all vehicles, or of each; of one tyre model, one friction circle and one table of the wind for all.
    """
    vehicles = [constants] if isinstance(constants, Constants) else constants
    return np.stack([packed_constants(vehicle) for vehicle in vehicles], axis=1)


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
    return _drive(states, inputs, rates, environment, constants, 1, steps, size, constant_speed, threads, False).states


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
    """Do as `advance_batch` for some cycles, and tell the largest slips and uses of friction.

    Parameters
    ----------
    states, inputs, rates, environment, constants, size, constant_speed, threads
        As in `advance_batch`.
    cycles, steps
        How many cycles of how many steps; slips are looked at before the first and after each.
    """
    return _drive(states, inputs, rates, environment, constants, cycles, steps, size, constant_speed, threads, True)


def evaluate_batch(
    states: Vector,
    inputs: Vector,
    environment: Vector,
    constants: Vector,
    constant_speed: bool = False,
    threads: int = 1,
) -> BatchEvaluation:
    """Return slips, forces and loads at one instant; parameters as in `advance_batch`."""
    count = states.shape[1]
    request = _request(states, inputs, environment, np.zeros((RATES, 1)))
    model, shared = _constants(constants, count)
    found = np.empty((EVALUATED, request.shape[1]))

    def work(first: int, last: int) -> None:
        evaluate_kernel(request, model, shared, constant_speed, first, last, WIDTH, found)

    _share(work, request.shape[1], threads)
    found = found[:, :count]
    per_wheel = (found[row : row + WHEELS] for row in range(0, 6 * WHEELS, WHEELS))
    return BatchEvaluation(*per_wheel, *found[6 * WHEELS :])


def _drive(
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
) -> Drive:
    count = states.shape[1]
    request = _request(states, inputs, environment, rates)
    model, shared = _constants(constants, count)
    found = np.zeros((STATE + PEAKS, request.shape[1]))

    def work(first: int, last: int) -> None:
        drive_kernel(
            request, model, shared, cycles, steps, size, constant_speed, watched, first, last, WIDTH, found
        )

    _share(work, request.shape[1], threads)
    end = found[:, :count]
    return Drive(end[:STATE], end[STATE : STATE + WHEELS], end[STATE + WHEELS :])


def _request(states: Vector, inputs: Vector, environment: Vector, rates: Vector) -> Vector:
    """Return all rows one below the other, with columns up to a whole number of blocks: those of the last vehicle."""
    count = states.shape[1]
    places = np.minimum(np.arange(-(-count // WIDTH) * WIDTH), count - 1)
    parts = (states, inputs, environment, rates)
    rows = [np.broadcast_to(part, (len(part), count))[:, places] for part in parts]
    return np.ascontiguousarray(np.vstack(rows), dtype=np.float64)


def _constants(constants: Vector, count: int) -> tuple[Vector, Vector]:
    """Return the constants with columns up to a whole number of blocks, or of one block, and those of one vehicle."""
    columns = constants.shape[1]
    places = np.minimum(np.arange(-(-columns // WIDTH) * WIDTH), columns - 1)
    return np.ascontiguousarray(constants[:, places]), np.ascontiguousarray(constants[:, 0])


def _share(work: Callable[[int, int], None], columns: int, threads: int) -> None:
    """Let each thread work on its own columns, in whole blocks."""
    blocks = columns // WIDTH
    ends = [WIDTH * (blocks * thread // threads) for thread in range(threads + 1)]
    if threads == 1:
        work(*ends)
        return
    with ThreadPoolExecutor(threads) as pool:
        for done in [pool.submit(work, *pair) for pair in zip(ends[:-1], ends[1:], strict=True)]:
            done.result()
