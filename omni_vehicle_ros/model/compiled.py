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
from typing import Any, TypeVar, cast

import numpy as np

from omni_vehicle_ros.model import contact, disturbances, dynamics, integrate, loads, loop, state
from omni_vehicle_ros.model.constants import Constants
from omni_vehicle_ros.model.dynamics import Environment, Evaluation, Inputs
from omni_vehicle_ros.model.state import State, Vector
from omni_vehicle_ros.model.tyres import brush, dugoff, force, friction_circle, lugre, magic_formula, slip
from omni_vehicle_ros.wheels import PerWheel

BRANCHES = (brush, dynamics, integrate, loop, lugre, magic_formula)
# Worth inlining; beyond them it doubles the time to compile.
LEAVES = (contact, disturbances, dugoff, force, friction_circle, loads, slip, state)
STATE = 10  # entries of the state

EvaluateKernel = Callable[[Vector, Vector, bool], Evaluation]
DerivativeKernel = Callable[[Vector, Vector, bool], Vector]
AdvanceKernel = Callable[[Vector, Vector, int, float, bool], Vector]
Kernels = tuple[EvaluateKernel, DerivativeKernel, AdvanceKernel]
K = TypeVar('K', bound=tuple[Callable[..., Any], ...])


@functools.lru_cache(maxsize=8)
def packed_constants(model: Constants) -> Vector:
    """Return all numbers of the constants in their order, as the kernels take them."""
    return np.hstack(model).astype(np.float64)


def packed_request(
    state: Vector, inputs: Inputs, environment: Environment, steer_rate: PerWheel | tuple[()] = ()
) -> Vector:
    """Return the numbers that change from call to call, as the kernels take them."""
    angle, force, gain = inputs
    bank, wind, friction = environment
    numbers = (*state.tolist(), *angle, *force, *gain, bank, wind, *friction, *steer_rate)
    return np.array(numbers, dtype=np.float64)


def unpacked_constants(numbers: Vector) -> Constants:
    """Return the constants that `packed_constants` has packed."""
    lines = (len(numbers) - 34) // 2
    return Constants(
        mass=numbers[0],
        yaw_inertia=numbers[1],
        gravity=numbers[2],
        wheel_x=four(numbers, 3),
        wheel_y=four(numbers, 7),
        front_load=numbers[11],
        rear_load=numbers[12],
        front_transfer=numbers[13],
        rear_transfer=numbers[14],
        roll_per_acceleration=numbers[15],
        front_roll_steer=numbers[16],
        rear_roll_steer=numbers[17],
        tyre_model=int(numbers[18]),
        cornering_stiffness=numbers[19],
        longitudinal_stiffness=numbers[20],
        adhesion_reduction=numbers[21],
        magic_shape=numbers[22],
        magic_curvature=numbers[23],
        sliding_share=numbers[24],
        stribeck_speed=numbers[25],
        full_stretch=numbers[26],
        friction_circle=numbers[27] != 0.0,
        relaxation_length=numbers[28],
        low_speed_damping=numbers[29],
        rolling_hold=numbers[30],
        air_density=numbers[31],
        side_area=numbers[32],
        airflow_angles=numbers[33 : 33 + lines],
        side_force_coefficients=numbers[33 + lines : 33 + 2 * lines],
        aerodynamic_centre=numbers[33 + 2 * lines],
    )


def four(numbers: Vector, first: int) -> PerWheel:
    """Return four numbers from one place on."""
    return numbers[first], numbers[first + 1], numbers[first + 2], numbers[first + 3]


def _state(n: Vector) -> State:
    return State(n[0], n[1], n[2], n[3], n[4], n[5], n[6], n[7], n[8], n[9])


def request_inputs(numbers: Vector, first: int) -> Inputs:
    """Return the inputs of a packed request, whose state has ``first`` entries."""
    return Inputs(four(numbers, first), four(numbers, first + 4), four(numbers, first + 8))


def request_environment(numbers: Vector, first: int) -> Environment:
    """Return the environment of a packed request, whose state has ``first`` entries."""
    return Environment(numbers[first + 12], numbers[first + 13], four(numbers, first + 14))


def request_rates(numbers: Vector, first: int) -> PerWheel:
    """Return the steer rates of a packed request, whose state has ``first`` entries [rad/s]."""
    return four(numbers, first + 18)


def compile_physics() -> Kernels | tuple[None, None, None]:
    """Return the kernels, not compiled before their first call; None where there is no way to compile."""
    unpackers = unpacked_constants, four, _state, request_inputs, request_environment, request_rates
    return compile_kernels(kernels, unpackers, BRANCHES, LEAVES) or (None, None, None)


def compile_kernels(
    make: Callable[[str], K],
    unpackers: tuple[Callable[..., object], ...],
    branches: tuple[ModuleType, ...],
    leaves: tuple[ModuleType, ...],
    used: tuple[ModuleType, ...] = (),
) -> K | None:
    """Return some kernels, not compiled before their first call; None where there is no way to compile.

    Parameters
    ----------
    make
        `kernels` or its like.
    unpackers
        Functions that turn arrays into arguments.
    branches, leaves
        Modules of the physics; leaves are worth inlining.
    used
        Further modules, which `compile_physics` has seen to already.
    """
    try:
        from numba import config, njit
        from numba.extending import register_jitable
    except ImportError:
        return None
    if config.DISABLE_JIT:
        return None
    for function in unpackers:
        register_jitable(function)
    # No physics makes arrays; counting references to those of the wind, at every call, takes half of the time.
    for function in itertools.chain(*map(_functions, branches)):
        register_jitable(_nrt=False)(function)
    for function in itertools.chain(*map(_functions, leaves)):
        register_jitable(forceinline=True, _nrt=False)(function)
    plain = make(''.join(map(inspect.getsource, (*branches, *leaves, *used))))
    # Without fastmath, for the same bits in every process. No check for division by 0, which never happens.
    compiler = njit(cache=True, error_model='numpy')
    try:
        return cast(K, tuple(map(compiler, plain)))
    except RuntimeError as error:
        warnings.warn(f'physics run uncompiled, 30 times slower: {error}; set NUMBA_CACHE_DIR', RuntimeWarning, 2)
        return None


def _functions(module: ModuleType) -> list[Callable[..., object]]:
    functions = inspect.getmembers(module, inspect.isfunction)
    return [function for _, function in functions if function.__module__ == module.__name__]


def kernels(source: str) -> Kernels:
    """Return the kernels in plain Python.

    Parameters
    ----------
    source
        Text of the physics. numba's cache looks at this file and at the variables that a kernel encloses, so that
        no change of the physics goes unnoticed.
    """
    def evaluate(request: Vector, constants: Vector, constant_speed: bool) -> Evaluation:
        source  # noqa: B018
        now, inputs, environment = _state(request), request_inputs(request, STATE), request_environment(request, STATE)
        return dynamics.evaluation(now, inputs, environment, unpacked_constants(constants), constant_speed)

    def derivative(request: Vector, constants: Vector, constant_speed: bool) -> Vector:
        source  # noqa: B018
        now, inputs, environment = _state(request), request_inputs(request, STATE), request_environment(request, STATE)
        return np.array(dynamics.state_rate(now, inputs, environment, unpacked_constants(constants), constant_speed))

    def advance(request: Vector, constants: Vector, steps: int, size: float, constant_speed: bool) -> Vector:
        source  # noqa: B018
        now, inputs, environment = _state(request), request_inputs(request, STATE), request_environment(request, STATE)
        rates, model = request_rates(request, STATE), unpacked_constants(constants)
        end = integrate.integrate(now, inputs, rates, environment, model, steps, size, constant_speed)
        return np.array(end)

    return evaluate, derivative, advance


evaluate_kernel, derivative_kernel, advance_kernel = compile_physics()
