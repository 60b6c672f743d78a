"""The physics compiled by numba, or None where numba is missing or switched off (``NUMBA_DISABLE_JIT=1``).

Nothing is written twice: numba compiles the functions of the modules below as they stand, and the plain ones give the
same numbers. All arguments of a kernel are arrays or numbers, so that no input makes it compile a second time.
The first call compiles, later processes load the result from numba's cache on disk.
"""

import functools
import inspect
import itertools
import struct
import warnings
from collections.abc import Callable
from types import ModuleType
from typing import Any, TypeVar, cast

import numpy as np

from omni_vehicle_ros.model import arithmetic, contact, disturbances, dynamics, integrate, lanes, loads, loop, state
from omni_vehicle_ros.model.constants import Constants
from omni_vehicle_ros.model.dynamics import Environment, Evaluation, Inputs
from omni_vehicle_ros.model.lanes import entry
from omni_vehicle_ros.model.state import State, Vector
from omni_vehicle_ros.model.tyres import brush, dugoff, force, friction_circle, lugre, magic_formula, slip
from omni_vehicle_ros.wheels import PerWheel

BRANCHES = (brush, lugre, magic_formula)
# A call that is not inlined hands over all constants, number by number.
LEAVES = (
    arithmetic, contact, disturbances, dugoff, dynamics, force, friction_circle, integrate, loads, loop, slip, state,
)
RARE = (loop.bisected,)
"""Not worth inlining all the same."""
STATE = 10  # entries of the state

EvaluateKernel = Callable[[Vector, Vector, bool], Evaluation]
DerivativeKernel = Callable[[Vector, Vector, bool], Vector]
AdvanceKernel = Callable[[Vector, Vector, int, float, bool], Vector]
Kernels = tuple[EvaluateKernel, DerivativeKernel, AdvanceKernel]
Read = Callable[[Vector, int, int], float]
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
    # Twice as fast as np.array; a bytearray, since numba takes an array that can't be written for another type.
    return np.frombuffer(bytearray(struct.pack(f'{len(numbers)}d', *numbers)))


def unpacked_constants(read: Read, numbers: Vector, column: int, shared: Vector) -> Constants:
    """Return the constants that `packed_constants` has packed.

    Parameters
    ----------
    read, numbers, column
        What to read by, `entry` or `load`, from where, and from which column on.
    shared
        The packed constants of one vehicle: kinds and tables are alike in all lanes.
    """
    lines = (len(shared) - 34) // 2
    return Constants(
        mass=read(numbers, 0, column),
        yaw_inertia=read(numbers, 1, column),
        gravity=read(numbers, 2, column),
        wheel_x=four(read, numbers, 3, column),
        wheel_y=four(read, numbers, 7, column),
        front_load=read(numbers, 11, column),
        rear_load=read(numbers, 12, column),
        front_transfer=read(numbers, 13, column),
        rear_transfer=read(numbers, 14, column),
        roll_per_acceleration=read(numbers, 15, column),
        front_roll_steer=read(numbers, 16, column),
        rear_roll_steer=read(numbers, 17, column),
        tyre_model=int(shared[18]),
        cornering_stiffness=read(numbers, 19, column),
        longitudinal_stiffness=read(numbers, 20, column),
        adhesion_reduction=read(numbers, 21, column),
        magic_shape=read(numbers, 22, column),
        magic_curvature=read(numbers, 23, column),
        sliding_share=read(numbers, 24, column),
        stribeck_speed=read(numbers, 25, column),
        full_stretch=read(numbers, 26, column),
        friction_circle=shared[27] != 0.0,
        relaxation_length=read(numbers, 28, column),
        low_speed_damping=read(numbers, 29, column),
        rolling_hold=read(numbers, 30, column),
        air_density=read(numbers, 31, column),
        side_area=read(numbers, 32, column),
        airflow_angles=shared[33 : 33 + lines],
        side_force_coefficients=shared[33 + lines : 33 + 2 * lines],
        aerodynamic_centre=read(numbers, 33 + 2 * lines, column),
    )


def four(read: Read, numbers: Vector, first: int, column: int) -> PerWheel:
    """Return four numbers from one place on."""
    return (
        read(numbers, first, column),
        read(numbers, first + 1, column),
        read(numbers, first + 2, column),
        read(numbers, first + 3, column),
    )


def request_state(read: Read, numbers: Vector, column: int) -> State:
    """Return the state of a packed request."""
    return State(
        read(numbers, 0, column),
        read(numbers, 1, column),
        read(numbers, 2, column),
        read(numbers, 3, column),
        read(numbers, 4, column),
        read(numbers, 5, column),
        read(numbers, 6, column),
        read(numbers, 7, column),
        read(numbers, 8, column),
        read(numbers, 9, column),
    )


def request_inputs(read: Read, numbers: Vector, first: int, column: int) -> Inputs:
    """Return the inputs of a packed request, whose state has ``first`` entries."""
    return Inputs(
        four(read, numbers, first, column),
        four(read, numbers, first + 4, column),
        four(read, numbers, first + 8, column),
    )


def request_environment(read: Read, numbers: Vector, first: int, column: int) -> Environment:
    """Return the environment of a packed request, whose state has ``first`` entries."""
    friction = four(read, numbers, first + 14, column)
    return Environment(read(numbers, first + 12, column), read(numbers, first + 13, column), friction)


def request_rates(read: Read, numbers: Vector, first: int, column: int) -> PerWheel:
    """Return the steer rates of a packed request, whose state has ``first`` entries [rad/s]."""
    return four(read, numbers, first + 18, column)


def unpacked_request(read: Read, numbers: Vector, column: int) -> tuple[State, Inputs, Environment]:
    """Return what `packed_request` has packed, but for the rates."""
    return (
        request_state(read, numbers, column),
        request_inputs(read, numbers, STATE, column),
        request_environment(read, numbers, STATE, column),
    )


UNPACKERS = (
    entry, unpacked_constants, four, request_state, request_inputs, request_environment, request_rates, unpacked_request,
)


def compile_physics() -> Kernels | tuple[None, None, None]:
    """Return the kernels, not compiled before their first call; None where there is no way to compile."""
    return compile_kernels(kernels, UNPACKERS, BRANCHES, LEAVES) or (None, None, None)


def compile_kernels(
    make: Callable[[str], K],
    unpackers: tuple[Callable[..., object], ...],
    branches: tuple[ModuleType, ...],
    leaves: tuple[ModuleType, ...],
    used: tuple[ModuleType, ...] = (),
    nogil: bool = False,
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
    nogil
        Whether other threads run on meanwhile: worth it for long work only.
    """
    try:
        from numba import config, njit
        from numba.extending import register_jitable

        from omni_vehicle_ros.model import compiled_lanes
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
        register_jitable(forceinline=function not in RARE, _nrt=False)(function)
    plain = make(''.join(map(inspect.getsource, (lanes, compiled_lanes, *branches, *leaves, *used))))
    # Without fastmath, for the same bits in every process. No check for division by 0, which never happens.
    compiler = njit(cache=True, error_model='numpy', nogil=nogil)
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
        now, inputs, environment = unpacked_request(entry, request, 0)
        return dynamics.evaluation(now, inputs, environment, unpacked_constants(entry, constants, 0, constants), constant_speed)

    def derivative(request: Vector, constants: Vector, constant_speed: bool) -> Vector:
        source  # noqa: B018
        now, inputs, environment = unpacked_request(entry, request, 0)
        return np.array(dynamics.state_rate(now, inputs, environment, unpacked_constants(entry, constants, 0, constants), constant_speed))

    def advance(request: Vector, constants: Vector, steps: int, size: float, constant_speed: bool) -> Vector:
        source  # noqa: B018
        now, inputs, environment = unpacked_request(entry, request, 0)
        rates, model = request_rates(entry, request, STATE, 0), unpacked_constants(entry, constants, 0, constants)
        end = integrate.integrate(now, inputs, rates, environment, model, steps, size, constant_speed)
        return np.array(end)

    return evaluate, derivative, advance


evaluate_kernel, derivative_kernel, advance_kernel = compile_physics()
