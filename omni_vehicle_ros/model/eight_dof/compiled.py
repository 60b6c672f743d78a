"""The physics with 8 degrees of freedom compiled by numba, or None without it; see `model.compiled`.

Nothing is compiled before the first call, so that who drives in the plane does not wait for it.
"""

import functools

import numpy as np

from omni_vehicle_ros.model import compiled as plane
from omni_vehicle_ros.model.compiled import AdvanceKernel, EvaluateKernel
from omni_vehicle_ros.model.dynamics import Evaluation
from omni_vehicle_ros.model.eight_dof import dynamics, integrate, rolling, state
from omni_vehicle_ros.model.eight_dof.constants import EightDofConstants
from omni_vehicle_ros.model.eight_dof.state import EightDofState
from omni_vehicle_ros.model.packing import (
    entry,
    four,
    packed_constants,
    replace,
    request_environment,
    request_inputs,
    request_rates,
    unpacked_constants,
    write_four,
)
from omni_vehicle_ros.model.state import Vector

BRANCHES = (dynamics, integrate, rolling)
LEAVES = (state,)
STATE = 20  # entries of the state
SCALARS = len(EightDofConstants._fields) - 1

Kernels = tuple[EvaluateKernel, AdvanceKernel]


@functools.lru_cache(maxsize=8)
def packed_eight_dof(model: EightDofConstants) -> Vector:
    """Return all numbers of the constants, those of the plane last, as the kernels take them."""
    return np.hstack((model[1:], packed_constants(model.plane))).astype(np.float64)


def _unpacked(n: Vector) -> EightDofConstants:
    return EightDofConstants(
        plane=unpacked_constants(entry, n[SCALARS:], 0, n[SCALARS:]),
        roll_inertia=n[0],
        roll_yaw_inertia=n[1],
        roll_coupling=n[2],
        roll_shift=n[3],
        net_roll_stiffness=n[4],
        roll_damping=n[5],
        front_spring=n[6],
        rear_spring=n[7],
        front_damper=n[8],
        rear_damper=n[9],
        front_link=n[10],
        rear_link=n[11],
        wheel_inertia=n[12],
        wheel_radius=n[13],
        long_damping=n[14],
        longest_step=n[15],
    )


def _state(n: Vector) -> EightDofState:
    spin, along, across = four(entry, n, 8, 0), four(entry, n, 12, 0), four(entry, n, 16, 0)
    return EightDofState(n[0], n[1], n[2], n[3], n[4], n[5], n[6], n[7], spin, along, across)


def _write(numbers: Vector, now: EightDofState) -> None:
    vx, vy, r, x, y, psi, roll, roll_rate, spin, along, across = now
    write_four(replace, numbers, 0, 0, (vx, vy, r, x))
    write_four(replace, numbers, 4, 0, (y, psi, roll, roll_rate))
    write_four(replace, numbers, 8, 0, spin)
    write_four(replace, numbers, 12, 0, along)
    write_four(replace, numbers, 16, 0, across)


def compile_eight_dof() -> Kernels | tuple[None, None]:
    """Return both kernels, not compiled before their first call; None where there is no way to compile."""
    if plane.advance_kernel is None:
        return None, None
    used = plane.BRANCHES + plane.LEAVES
    return plane.compile_kernels(kernels, (_unpacked, _state, _write), BRANCHES, LEAVES, used) or (None, None)


def kernels(source: str) -> Kernels:
    """Return both kernels in plain Python.

    Parameters
    ----------
    source
        Text of the physics, for numba's cache, as in `model.compiled.kernels`.
    """
    def evaluate(request: Vector, constants: Vector, constant_speed: bool) -> Evaluation:
        source  # noqa: B018
        inputs = request_inputs(entry, request, STATE, 0)
        environment = request_environment(entry, request, STATE, 0)
        return dynamics.evaluation(_state(request), inputs, environment, _unpacked(constants), constant_speed)

    def advance(request: Vector, constants: Vector, steps: int, size: float, constant_speed: bool) -> None:
        source  # noqa: B018
        inputs = request_inputs(entry, request, STATE, 0)
        environment = request_environment(entry, request, STATE, 0)
        now, rates, model = _state(request), request_rates(entry, request, STATE, 0), _unpacked(constants)
        end = integrate.integrate(now, inputs, rates, environment, model, steps, size, constant_speed)
        _write(request, end)

    return evaluate, advance


evaluate_kernel, advance_kernel = compile_eight_dof()
