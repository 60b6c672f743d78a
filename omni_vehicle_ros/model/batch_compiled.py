"""The kernels of `batch`; in plain Python, with one lane, where numba is missing or switched off."""

from collections.abc import Callable

from omni_vehicle_ros.model import dynamics, integrate
from omni_vehicle_ros.model.compiled import compile_lanes
from omni_vehicle_ros.model.dynamics import Evaluation
from omni_vehicle_ros.model.lanes import load, store
from omni_vehicle_ros.model.packing import (
    STATE,
    request_rates,
    unpacked_constants,
    unpacked_request,
    write_evaluation,
    write_state,
)
from omni_vehicle_ros.model.state import Vector
from omni_vehicle_ros.wheels import PerWheel

DriveKernel = Callable[[Vector, Vector, Vector, int, int, float, bool, bool, int, int, int, Vector], None]


def store_evaluation(numbers: Vector, column: int, found: Evaluation) -> None:
    """Write an evaluation below a state, in the order of `batch.Drive`, and keep the largest slips and uses."""
    write_evaluation(store, numbers, STATE, column, found)
    keep_larger(numbers, STATE + 27, column, found.side_slip)
    keep_larger(numbers, STATE + 31, column, found.friction_use)


def keep_larger(numbers: Vector, first: int, column: int, values: PerWheel) -> None:
    """Write the sizes of four lanes where they are larger than what is there."""
    for wheel in range(4):
        row = first + wheel
        store(numbers, row, column, max(load(numbers, row, column), abs(values[wheel])))


def kernels(source: str) -> tuple[DriveKernel]:
    """Return the kernel in plain Python.

    Parameters
    ----------
    source
        Text of the physics, for numba's cache, as in `model.compiled.compile_lanes`.
    """

    def drive(
        request: Vector,
        constants: Vector,
        shared: Vector,
        cycles: int,
        steps: int,
        size: float,
        constant_speed: bool,
        watched: bool,
        first: int,
        last: int,
        width: int,
        found: Vector,
    ) -> None:
        source  # noqa: B018
        varied = constants.shape[1] > width
        for column in range(first, last, width):
            now, inputs, road = unpacked_request(load, request, column)
            rates = request_rates(load, request, STATE, column)
            model = unpacked_constants(load, constants, column if varied else 0, shared)
            for cycle in range(cycles + 1):
                if cycle > 0:
                    now = integrate.integrate(now, inputs, rates, road, model, steps, size, constant_speed)
                    inputs = integrate.steered(inputs, rates, steps * size)
                if watched:
                    store_evaluation(found, column, dynamics.evaluation(now, inputs, road, model, constant_speed))
            write_state(store, found, column, now)

    return (drive,)


def compile_batch() -> tuple[int, DriveKernel]:
    """Return the number of lanes and the kernels, not compiled before their first call."""
    found = compile_lanes(kernels, (store_evaluation, keep_larger))
    if found is None:
        return 1, kernels('')[0]
    from omni_vehicle_ros.model.compiled_lanes import WIDTH

    return WIDTH, found[0]


WIDTH, drive_kernel = compile_batch()
