"""Arrays in which the compiled physics take vehicles and requests, and how they are read again.

The physics read one vehicle from vectors, by `entry`, or several lanes from the columns of matrices, by `load`.
"""

import functools
import struct
from collections.abc import Callable, Sequence
from ctypes import c_double
from typing import Any

import numpy as np

from omni_vehicle_ros.model.constants import Constants
from omni_vehicle_ros.model.dynamics import Environment, Evaluation, Inputs
from omni_vehicle_ros.model.machine_code import Numbers
from omni_vehicle_ros.model.state import State, Vector
from omni_vehicle_ros.wheels import PerWheel

STATE = 10  # entries of the state
REQUEST = 25  # entries of a request beside the state
EVALUATION = 31  # entries of an evaluation
STILL: PerWheel = (0.0, 0.0, 0.0, 0.0)
Read = Callable[[Vector, int, int], float]
Write = Callable[[Vector, int, int, float], None]


@functools.lru_cache(maxsize=8)
def packed_constants(model: Constants) -> Numbers:
    """Return all numbers of the constants in their order, as the kernels take them."""
    return counted(listed_constants(model))


def counted(numbers: Sequence[float]) -> Numbers:
    """Return how many numbers there are, and the numbers."""
    return (c_double * (1 + len(numbers)))(len(numbers), *numbers)


def listed_constants(model: Constants) -> list[float]:
    """Return all numbers of the constants in their order."""
    fields: tuple[Any, ...] = model
    numbers: list[float] = []
    for field in fields:
        numbers.extend(field if isinstance(field, tuple) else (field,))
    return numbers


def packed_request(
    state: Vector,
    inputs: Inputs,
    environment: Environment,
    constant_speed: bool,
    steer_rate: PerWheel = STILL,
    steps: int = 0,
    size: float = 0.0,
) -> Numbers:
    """Return the numbers that change from call to call, as the kernels take them."""
    angle, force, gain = inputs
    bank, wind, friction = environment
    numbers = (
        *state.tolist(), *angle, *force, *gain, bank, wind, *friction, *steer_rate, steps, size, constant_speed
    )  # fmt: skip
    array, form = _array_and_form(len(numbers))
    # Thrice as fast as the array's own constructor.
    return array.from_buffer_copy(form.pack(*numbers))


@functools.cache
def _array_and_form(count: int) -> tuple[type[Numbers], struct.Struct]:
    return c_double * count, struct.Struct(f'{count}d')


def entry(numbers: Vector, row: int, column: int) -> float:
    """Return a number of a vector, for one vehicle alone; the column says nothing."""
    return float(numbers[row])


def replace(numbers: Vector, row: int, column: int, value: float) -> None:
    """Write a number of a vector, for one vehicle alone; the column says nothing."""
    numbers[row] = value


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


def request_cycle(numbers: Vector, first: int) -> tuple[int, float, bool]:
    """Return steps, their size [s] and whether vx is held of a packed request, whose state has ``first`` entries."""
    return int(numbers[first + 22]), numbers[first + 23], numbers[first + 24] != 0.0


def unpacked_request(read: Read, numbers: Vector, column: int) -> tuple[State, Inputs, Environment]:
    """Return what `packed_request` has packed, but for the rates."""
    return (
        request_state(read, numbers, column),
        request_inputs(read, numbers, STATE, column),
        request_environment(read, numbers, STATE, column),
    )


def write_state(write: Write, numbers: Vector, column: int, state: State) -> None:
    """Write a state, in the order of its entries, by `replace` or by `store`."""
    write(numbers, 0, column, state.vx)
    write(numbers, 1, column, state.vy)
    write(numbers, 2, column, state.r)
    write(numbers, 3, column, state.x)
    write(numbers, 4, column, state.y)
    write(numbers, 5, column, state.psi)
    tyres = state.front_left, state.front_right, state.rear_left, state.rear_right
    write_four(write, numbers, 6, column, tyres)


def write_four(write: Write, numbers: Vector, first: int, column: int, values: PerWheel) -> None:
    """Write four numbers from one place on."""
    write(numbers, first, column, values[0])
    write(numbers, first + 1, column, values[1])
    write(numbers, first + 2, column, values[2])
    write(numbers, first + 3, column, values[3])


def write_evaluation(write: Write, numbers: Vector, first: int, column: int, found: Evaluation) -> None:
    """Write an evaluation from one place on, but for ``lifted``: 27 numbers."""
    write_four(write, numbers, first, column, found.steer_angle)
    write_four(write, numbers, first + 4, column, found.side_slip)
    write_four(write, numbers, first + 8, column, found.longitudinal_force)
    write_four(write, numbers, first + 12, column, found.lateral_force)
    write_four(write, numbers, first + 16, column, found.vertical_load)
    write_four(write, numbers, first + 20, column, found.friction_use)
    write(numbers, first + 24, column, found.roll_angle)
    write(numbers, first + 25, column, found.ax)
    write(numbers, first + 26, column, found.ay)


def replace_by_evaluation(numbers: Vector, found: Evaluation) -> None:
    """Write an evaluation over a request, ``lifted`` last."""
    write_evaluation(replace, numbers, 0, 0, found)
    for wheel in range(4):
        numbers[27 + wheel] = 1.0 if found.lifted[wheel] else 0.0


def found_evaluation(request: Numbers) -> Evaluation:
    """Return the evaluation that a kernel has written over a request."""
    n = request[:EVALUATION]
    return Evaluation(
        (n[0], n[1], n[2], n[3]),
        (n[4], n[5], n[6], n[7]),
        (n[8], n[9], n[10], n[11]),
        (n[12], n[13], n[14], n[15]),
        (n[16], n[17], n[18], n[19]),
        (n[20], n[21], n[22], n[23]),
        (n[27] != 0.0, n[28] != 0.0, n[29] != 0.0, n[30] != 0.0),
        n[24],
        n[25],
        n[26],
    )


def vector(numbers: Any) -> Vector:
    """Return `Numbers` as a vector, which shares their memory."""
    return np.frombuffer(numbers)
