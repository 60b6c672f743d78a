"""The physics compiled by numba, or None where numba is missing or switched off (``NUMBA_DISABLE_JIT=1``).

Nothing is written twice: numba compiles the functions of the modules below as they stand, and the plain ones give the
same numbers. All arguments of a kernel are arrays or numbers, so that no input makes it compile a second time.
The first call compiles, later processes load the result from numba's cache on disk.
"""

import inspect
import itertools
import warnings
from collections.abc import Callable
from types import ModuleType
from typing import Any, TypeVar, cast

import numpy as np

from omni_vehicle_ros.model import (
    arithmetic,
    contact,
    disturbances,
    dynamics,
    integrate,
    lanes,
    loads,
    loop,
    packing,
    state,
)
from omni_vehicle_ros.model.dynamics import Evaluation
from omni_vehicle_ros.model.packing import (
    STATE,
    entry,
    replace,
    request_rates,
    unpacked_constants,
    unpacked_request,
    write_state,
)
from omni_vehicle_ros.model.state import Vector
from omni_vehicle_ros.model.tyres import brush, dugoff, force, friction_circle, lugre, magic_formula, slip

BRANCHES = (brush, lugre, magic_formula)
# A call that is not inlined hands over all constants, number by number.
LEAVES = (
    arithmetic, contact, disturbances, dugoff, dynamics, force, friction_circle, integrate, loads, loop, slip, state,
)
RARE = (loop.bisected,)
"""Not worth inlining all the same."""

EvaluateKernel = Callable[[Vector, Vector, bool], Evaluation]
DerivativeKernel = Callable[[Vector, Vector, bool], Vector]
AdvanceKernel = Callable[[Vector, Vector, int, float, bool], None]
"""Replaces the state in a request by that at the end: no array is made, which would cost half a step."""
Kernels = tuple[EvaluateKernel, DerivativeKernel, AdvanceKernel]
K = TypeVar('K', bound=tuple[Callable[..., Any], ...])


def compile_physics() -> Kernels | tuple[None, None, None]:
    """Return the kernels, not compiled before their first call; None where there is no way to compile."""
    return compile_kernels(kernels, tuple(_functions(packing)), BRANCHES, LEAVES) or (None, None, None)


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
        Functions that turn arrays into arguments, and count references to those.
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
    plain = make(''.join(map(inspect.getsource, (lanes, packing, compiled_lanes, *branches, *leaves, *used))))
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
        model = unpacked_constants(entry, constants, 0, constants)
        return dynamics.evaluation(now, inputs, environment, model, constant_speed)

    def derivative(request: Vector, constants: Vector, constant_speed: bool) -> Vector:
        source  # noqa: B018
        now, inputs, environment = unpacked_request(entry, request, 0)
        model = unpacked_constants(entry, constants, 0, constants)
        return np.array(dynamics.state_rate(now, inputs, environment, model, constant_speed))

    def advance(request: Vector, constants: Vector, steps: int, size: float, constant_speed: bool) -> None:
        source  # noqa: B018
        now, inputs, environment = unpacked_request(entry, request, 0)
        rates, model = request_rates(entry, request, STATE, 0), unpacked_constants(entry, constants, 0, constants)
        end = integrate.integrate(now, inputs, rates, environment, model, steps, size, constant_speed)
        write_state(replace, request, 0, end)

    return evaluate, derivative, advance


evaluate_kernel, derivative_kernel, advance_kernel = compile_physics()
