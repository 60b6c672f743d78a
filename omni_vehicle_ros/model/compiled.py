"""The compiled physics in the plane, or None where numba is missing or switched off (``NUMBA_DISABLE_JIT=1``).

Nothing is written twice: numba compiles the functions of the modules below as they stand, and the plain ones give the
same numbers. All arguments of a kernel are arrays of numbers, so that no input makes it compile a second time.
What is asked for first is compiled, and kept on disk for later processes; see `machine_code`.
"""

import functools
import inspect
import itertools
import sys
import warnings
from collections.abc import Callable, Iterable
from pathlib import Path
from types import ModuleType
from typing import Any, TypeVar, cast

from omni_vehicle_ros.model import (
    arithmetic,
    constants,
    contact,
    disturbances,
    dynamics,
    integrate,
    lanes,
    loads,
    loop,
    machine_code,
    packing,
    state,
)
from omni_vehicle_ros.model.machine_code import Kernel, Source, can_compile, load_kernel
from omni_vehicle_ros.model.packing import (
    REQUEST,
    STATE,
    entry,
    replace,
    replace_by_evaluation,
    request_cycle,
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
    arithmetic, contact, disturbances, dugoff, dynamics, force, friction_circle, integrate, loads, loop, packing,
    slip, state,
)  # fmt: skip
RARE = (loop.bisected,)
"""Not worth inlining all the same."""
COUNTED = (unpacked_constants,)
"""Gives an array back, to which it must count the reference."""
MODULES = (lanes, constants, *BRANCHES, *LEAVES, machine_code, sys.modules[__name__])
LANES_FILE = Path(__file__).with_name('compiled_lanes.py')  # which only who compiles can import
K = TypeVar('K', bound=tuple[Callable[..., Any], ...])


@functools.cache
def kernel(name: str) -> Kernel | None:
    """Return a kernel, which is compiled now if it never was; None where there is no way to compile.

    Parameters
    ----------
    name
        ``'evaluate'``: a request is replaced by the evaluation, see `packing.found_evaluation`;
        ``'derivative'``, ``'advance'``: the state in it by its rate, or by that at the end.
    """
    return load_kernel(f'yaw_plane_{name}', text_of(MODULES), lambda: sources()[name])


def text_of(modules: Iterable[ModuleType]) -> str:
    """Return the text of all that a kernel of some modules depends on."""
    return LANES_FILE.read_text(encoding='utf-8') + ''.join(map(inspect.getsource, modules))


def sources() -> dict[str, Source]:
    """Return what is to be compiled, by name."""
    from numba import carray

    register_physics()

    def evaluate(request: Vector, constants: Vector) -> None:
        numbers, model = carray(request, STATE + REQUEST), carray(constants, int(constants[0]) + 1)[1:]
        now, inputs, environment = unpacked_request(entry, numbers, 0)
        vehicle = unpacked_constants(entry, model, 0, model)
        _, _, constant_speed = request_cycle(numbers, STATE)
        replace_by_evaluation(numbers, dynamics.evaluation(now, inputs, environment, vehicle, constant_speed))

    def derivative(request: Vector, constants: Vector) -> None:
        numbers, model = carray(request, STATE + REQUEST), carray(constants, int(constants[0]) + 1)[1:]
        now, inputs, environment = unpacked_request(entry, numbers, 0)
        vehicle = unpacked_constants(entry, model, 0, model)
        _, _, constant_speed = request_cycle(numbers, STATE)
        write_state(replace, numbers, 0, dynamics.state_rate(now, inputs, environment, vehicle, constant_speed))

    def advance(request: Vector, constants: Vector) -> None:
        numbers, model = carray(request, STATE + REQUEST), carray(constants, int(constants[0]) + 1)[1:]
        now, inputs, environment = unpacked_request(entry, numbers, 0)
        rates, vehicle = request_rates(entry, numbers, STATE, 0), unpacked_constants(entry, model, 0, model)
        steps, size, constant_speed = request_cycle(numbers, STATE)
        end = integrate.integrate(now, inputs, rates, environment, vehicle, steps, size, constant_speed)
        write_state(replace, numbers, 0, end)

    return {'evaluate': evaluate, 'derivative': derivative, 'advance': advance}


@functools.cache
def register_physics() -> None:
    """Tell numba of the physics in the plane, for one vehicle and for lanes."""
    from omni_vehicle_ros.model import compiled_lanes  # noqa: F401

    register(BRANCHES, LEAVES)


def register(branches: Iterable[ModuleType], leaves: Iterable[ModuleType]) -> None:
    """Tell numba of the functions of modules; leaves are worth inlining."""
    from numba.extending import register_jitable

    # No physics makes arrays; counting references to those of the wind, at every call, takes half of the time.
    for function in itertools.chain(*map(_functions, branches)):
        register_jitable(_nrt=False)(function)
    for function in itertools.chain(*map(_functions, leaves)):
        register_jitable(forceinline=function not in RARE, _nrt=function in COUNTED)(function)


def compile_lanes(make: Callable[[str], K], helpers: tuple[Callable[..., object], ...]) -> K | None:
    """Return kernels for lanes, not compiled before their first call; None where there is no way to compile.

    Other threads run on meanwhile.

    Parameters
    ----------
    make
        Returns them in plain Python, from the text of the physics: numba's cache looks at their own file and at the
        variables that they enclose, so that no change of the physics goes unnoticed.
    helpers
        Functions of theirs that are no physics.
    """
    if not can_compile():
        return None
    from numba import njit
    from numba.extending import register_jitable

    register_physics()
    for function in helpers:
        register_jitable(function)
    plain = make(text_of(MODULES))
    # Options as in `machine_code`.
    compiler = njit(cache=True, error_model='numpy', nogil=True)
    try:
        return cast(K, tuple(map(compiler, plain)))
    except RuntimeError as error:
        warnings.warn(f'physics run uncompiled, 30 times slower: {error}; set NUMBA_CACHE_DIR', RuntimeWarning, 2)
        return None


def _functions(module: ModuleType) -> list[Callable[..., object]]:
    functions = inspect.getmembers(module, inspect.isfunction)
    return [function for _, function in functions if function.__module__ == module.__name__]
