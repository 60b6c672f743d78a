"""The kernels of `batch`; in plain Python, with one lane, where numba is missing or switched off."""

from collections.abc import Callable

from omni_vehicle_ros.model import dynamics, integrate
from omni_vehicle_ros.model.compiled import (
    BRANCHES,
    LEAVES,
    STATE,
    advance_kernel,
    compile_kernels,
    request_rates,
    unpacked_constants,
    unpacked_request,
)
from omni_vehicle_ros.model.dynamics import Evaluation
from omni_vehicle_ros.model.lanes import load, store
from omni_vehicle_ros.model.state import State, Vector
from omni_vehicle_ros.wheels import PerWheel

DriveKernel = Callable[[Vector, Vector, Vector, int, int, float, bool, bool, int, int, int, Vector], None]
EvaluateKernel = Callable[[Vector, Vector, Vector, bool, int, int, int, Vector], None]
Kernels = tuple[DriveKernel, EvaluateKernel]


def store_four(numbers: Vector, first: int, column: int, values: PerWheel) -> None:
    """Write four lanes, one below the other."""
    store(numbers, first, column, values[0])
    store(numbers, first + 1, column, values[1])
    store(numbers, first + 2, column, values[2])
    store(numbers, first + 3, column, values[3])


def store_state(numbers: Vector, column: int, state: State) -> None:
    """Write a state, in the order of its entries."""
    store(numbers, 0, column, state.vx)
    store(numbers, 1, column, state.vy)
    store(numbers, 2, column, state.r)
    store(numbers, 3, column, state.x)
    store(numbers, 4, column, state.y)
    store(numbers, 5, column, state.psi)
    tyres = state.front_left, state.front_right, state.rear_left, state.rear_right
    store_four(numbers, 6, column, tyres)


def store_evaluation(numbers: Vector, column: int, found: Evaluation) -> None:
    """Write an evaluation, in the order of `batch.BatchEvaluation`."""
    store_four(numbers, 0, column, found.steer_angle)
    store_four(numbers, 4, column, found.side_slip)
    store_four(numbers, 8, column, found.longitudinal_force)
    store_four(numbers, 12, column, found.lateral_force)
    store_four(numbers, 16, column, found.vertical_load)
    store_four(numbers, 20, column, found.friction_use)
    store(numbers, 24, column, found.roll_angle)
    store(numbers, 25, column, found.ax)
    store(numbers, 26, column, found.ay)


def keep_larger(numbers: Vector, column: int, found: Evaluation) -> None:
    """Keep the largest sizes of side slips and friction uses, below the rows of a state."""
    for wheel in range(4):
        row = STATE + wheel
        store(numbers, row, column, max(load(numbers, row, column), abs(found.side_slip[wheel])))
        store(numbers, row + 4, column, max(load(numbers, row + 4, column), found.friction_use[wheel]))


def kernels(source: str) -> Kernels:
    """Return the kernels in plain Python.

    Parameters
    ----------
    source
        Text of the physics, for numba's cache, as in `model.compiled.kernels`.
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
            if watched:
                keep_larger(found, column, dynamics.evaluation(now, inputs, road, model, constant_speed))
            for _ in range(cycles):
                now = integrate.integrate(now, inputs, rates, road, model, steps, size, constant_speed)
                inputs = integrate.steered(inputs, rates, steps * size)
                if watched:
                    keep_larger(found, column, dynamics.evaluation(now, inputs, road, model, constant_speed))
            store_state(found, column, now)

    def evaluate(
        request: Vector,
        constants: Vector,
        shared: Vector,
        constant_speed: bool,
        first: int,
        last: int,
        width: int,
        found: Vector,
    ) -> None:
        source  # noqa: B018
        varied = constants.shape[1] > width
        for column in range(first, last, width):
            now, inputs, road = unpacked_request(load, request, column)
            model = unpacked_constants(load, constants, column if varied else 0, shared)
            store_evaluation(found, column, dynamics.evaluation(now, inputs, road, model, constant_speed))

    return drive, evaluate


def compile_batch() -> tuple[int, Kernels]:
    """Return the number of lanes and the kernels, not compiled before their first call."""
    helpers = store_four, store_state, store_evaluation, keep_larger
    found = None
    if advance_kernel is not None:
        found = compile_kernels(kernels, helpers, (), (), BRANCHES + LEAVES, nogil=True)
    if found is None:
        return 1, kernels('')
    from omni_vehicle_ros.model.compiled_lanes import WIDTH

    return WIDTH, found


WIDTH, (drive_kernel, evaluate_kernel) = compile_batch()
