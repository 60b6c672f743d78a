"""The physics compiled by numba, or None where numba is missing or switched off (``NUMBA_DISABLE_JIT=1``).

Nothing is written twice: numba compiles the functions of the modules below as they stand, and the plain ones give the
same numbers. All arguments of a kernel are arrays or numbers, so that no input makes it compile a second time.
The first call compiles, later processes load the result from numba's cache on disk.
"""

import functools
import inspect
import itertools
import warnings
from collections.abc import Callable
from types import ModuleType

import numpy as np

from omni_vehicle_ros.model import contact, disturbances, dynamics, integrate, loads, state, tyre
from omni_vehicle_ros.model.constants import Constants
from omni_vehicle_ros.model.dynamics import Environment, Evaluation, Inputs
from omni_vehicle_ros.model.state import State, Vector
from omni_vehicle_ros.wheels import PerWheel

BRANCHES = (dynamics, integrate)
LEAVES = (contact, disturbances, loads, state, tyre)  # worth inlining; beyond them it doubles the time to compile

EvaluateKernel = Callable[[Vector, Vector, bool], Evaluation]
AdvanceKernel = Callable[[Vector, Vector, int, float, bool], Vector]


@functools.lru_cache(maxsize=8)
def packed_constants(model: Constants) -> Vector:
    """Return all numbers of the constants in their order, as the kernels take them."""
    return np.hstack(model).astype(np.float64)


def _constants(numbers: Vector) -> Constants:
    lines = (len(numbers) - 27) // 2
    return Constants(
        mass=numbers[0],
        yaw_inertia=numbers[1],
        gravity=numbers[2],
        wheel_x=_four(numbers, 3),
        wheel_y=_four(numbers, 7),
        front_load=numbers[11],
        rear_load=numbers[12],
        front_transfer=numbers[13],
        rear_transfer=numbers[14],
        roll_per_acceleration=numbers[15],
        front_roll_steer=numbers[16],
        rear_roll_steer=numbers[17],
        cornering_stiffness=numbers[18],
        adhesion_reduction=numbers[19],
        friction_circle=numbers[20] != 0.0,
        relaxation_length=numbers[21],
        low_speed_damping=numbers[22],
        rolling_hold=numbers[23],
        air_density=numbers[24],
        side_area=numbers[25],
        airflow_angles=numbers[26 : 26 + lines],
        side_force_coefficients=numbers[26 + lines : 26 + 2 * lines],
        aerodynamic_centre=numbers[26 + 2 * lines],
    )


def _four(numbers: Vector, first: int) -> PerWheel:
    return numbers[first], numbers[first + 1], numbers[first + 2], numbers[first + 3]


def _state(n: Vector) -> State:
    return State(n[0], n[1], n[2], n[3], n[4], n[5], n[6], n[7], n[8], n[9])


def _inputs(numbers: Vector) -> Inputs:
    return Inputs(_four(numbers, 10), _four(numbers, 14))


def _environment(numbers: Vector) -> Environment:
    return Environment(numbers[18], numbers[19], _four(numbers, 20))


def compile_physics() -> tuple[EvaluateKernel, AdvanceKernel] | tuple[None, None]:
    """Return both kernels, not compiled before their first call; None where there is no way to compile."""
    try:
        from numba import config, njit
        from numba.extending import register_jitable
    except ImportError:
        return None, None
    if config.DISABLE_JIT:
        return None, None
    for function in itertools.chain([_constants, _four, _state, _inputs, _environment], *map(_functions, BRANCHES)):
        register_jitable(function)
    for function in itertools.chain(*map(_functions, LEAVES)):
        register_jitable(forceinline=True)(function)
    evaluate, advance = kernels(''.join(map(inspect.getsource, BRANCHES + LEAVES)))
    # Without fastmath, for the same bits in every process. No check for division by 0, which never happens.
    compiler = njit(cache=True, error_model='numpy')
    try:
        return compiler(evaluate), compiler(advance)
    except RuntimeError as error:
        warnings.warn(f'physics run uncompiled, 30 times slower: {error}; set NUMBA_CACHE_DIR', RuntimeWarning, 2)
        return None, None


def _functions(module: ModuleType) -> list[Callable[..., object]]:
    functions = inspect.getmembers(module, inspect.isfunction)
    return [function for _, function in functions if function.__module__ == module.__name__]


def kernels(source: str) -> tuple[EvaluateKernel, AdvanceKernel]:
    """Return both kernels in plain Python.

    Parameters
    ----------
    source
        Text of the physics. numba's cache looks at this file and at the variables that a kernel encloses, so that
        no change of the physics goes unnoticed.
    """
    def evaluate(request: Vector, constants: Vector, constant_speed: bool) -> Evaluation:
        source  # noqa: B018
        now, inputs, environment = _state(request), _inputs(request), _environment(request)
        return dynamics.evaluation(now, inputs, environment, _constants(constants), constant_speed)

    def advance(request: Vector, constants: Vector, steps: int, size: float, constant_speed: bool) -> Vector:
        source  # noqa: B018
        now, inputs, environment = _state(request), _inputs(request), _environment(request)
        rates, model = _four(request, 24), _constants(constants)
        end = integrate.integrate(now, inputs, rates, environment, model, steps, size, constant_speed)
        return np.array(end)

    return evaluate, advance


evaluate_kernel, advance_kernel = compile_physics()
