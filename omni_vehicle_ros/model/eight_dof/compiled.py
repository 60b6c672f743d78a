"""The compiled physics with 8 degrees of freedom; see `model.compiled`."""

import functools
import sys

from omni_vehicle_ros.model import compiled as plane
from omni_vehicle_ros.model.eight_dof import constants as eight_dof_constants
from omni_vehicle_ros.model.eight_dof import dynamics, integrate, rolling, state
from omni_vehicle_ros.model.eight_dof.constants import EightDofConstants
from omni_vehicle_ros.model.eight_dof.state import EightDofState
from omni_vehicle_ros.model.machine_code import Kernel, Numbers, Source, load_kernel
from omni_vehicle_ros.model.packing import (
    REQUEST,
    counted,
    entry,
    four,
    listed_constants,
    replace,
    replace_by_evaluation,
    request_cycle,
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


@functools.lru_cache(maxsize=8)
def packed_eight_dof(model: EightDofConstants) -> Numbers:
    """Return all numbers of the constants, those of the plane last, as the kernels take them."""
    return counted((*model[1:], *listed_constants(model.plane)))


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


@functools.cache
def kernel(name: str) -> Kernel | None:
    """Return ``'evaluate'`` or ``'advance'``; see `model.compiled.kernel`."""
    modules = *plane.MODULES, *BRANCHES, *LEAVES, eight_dof_constants, sys.modules[__name__]
    return load_kernel(f'eight_dof_{name}', plane.text_of(modules), lambda: sources()[name])


def sources() -> dict[str, Source]:
    """Return what is to be compiled, by name; see `model.compiled.sources`."""
    from numba import carray

    plane.register_physics()
    plane.register(BRANCHES, (*LEAVES, sys.modules[__name__]))

    def evaluate(request: Vector, constants: Vector) -> None:
        numbers, model = carray(request, STATE + REQUEST), carray(constants, int(constants[0]) + 1)[1:]
        inputs = request_inputs(entry, numbers, STATE, 0)
        environment = request_environment(entry, numbers, STATE, 0)
        _, _, constant_speed = request_cycle(numbers, STATE)
        found = dynamics.evaluation(_state(numbers), inputs, environment, _unpacked(model), constant_speed)
        replace_by_evaluation(numbers, found)

    def advance(request: Vector, constants: Vector) -> None:
        numbers, model = carray(request, STATE + REQUEST), carray(constants, int(constants[0]) + 1)[1:]
        inputs = request_inputs(entry, numbers, STATE, 0)
        environment = request_environment(entry, numbers, STATE, 0)
        rates = request_rates(entry, numbers, STATE, 0)
        steps, size, constant_speed = request_cycle(numbers, STATE)
        _write(numbers, integrate.integrate(
            _state(numbers), inputs, rates, environment, _unpacked(model), steps, size, constant_speed
        ))  # fmt: skip

    return {'evaluate': evaluate, 'advance': advance}
