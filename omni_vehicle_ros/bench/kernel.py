"""How fast the physics are: beside the same equations in C, alone, many at once, and called from Python."""

from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import NamedTuple

import numpy as np

from omni_vehicle_ros.bench.c_step import NO_COMPILER, CStep, compiled_step
from omni_vehicle_ros.bench.frame import (
    CALIBRATION,
    ROUNDS,
    Line,
    Progress,
    Result,
    Time,
    at_least,
    at_most,
    calibrate,
    interleaved,
)
from omni_vehicle_ros.bench.peers import peer_lines, peer_works
from omni_vehicle_ros.bench.start_up import start_lines, start_works
from omni_vehicle_ros.errors import RunError
from omni_vehicle_ros.model import plant
from omni_vehicle_ros.model.batch import advance_batch, packed_batch
from omni_vehicle_ros.model.compiled import kernel
from omni_vehicle_ros.model.constants import constants
from omni_vehicle_ros.model.dynamics import Environment, Inputs
from omni_vehicle_ros.model.machine_code import Kernel, Numbers
from omni_vehicle_ros.model.packing import STATE, listed_constants, packed_constants, packed_request, vector
from omni_vehicle_ros.model.state import Vector, initial_state
from omni_vehicle_ros.parameters import VehicleParameters

STEP = 0.005  # s
DRIVES, STEPS = 40, 200
"""Vehicles that drive alone, from straight on to wide slides, and their steps."""
CALLS = 4000
VEHICLES, BATCH_STEPS = 10_000, 5
TOLERANCE = 1e-9
"""Of C beside the kernel, relative or absolute."""
MODEL = constants(VehicleParameters())
ROAD = Environment(bank=0.01)
C, C_CALLS = 'C', 'C, called'
KERNEL, KERNEL_CALLS, PLANT_CALLS = 'kernel', 'kernel, called', 'plant, called'
BATCH, BATCH_THREADS, SORT_THREADS = 'batch', 'batch, two threads', 'sorts, two threads'
FREE = 1.8  # speed-up by two threads that share nothing, from which on two cores are taken to be free


class Drive(NamedTuple):
    """How a vehicle drives: state at the start, and what its wheels do; see `plant.advance`."""

    state: Vector
    inputs: Inputs
    steer_rate: tuple[float, float, float, float]

    def request(self, steps: int) -> Numbers:
        """Return all of it, as the kernels take it."""
        return packed_request(self.state, self.inputs, ROAD, False, self.steer_rate, steps, STEP)


def bench(progress: Progress = lambda done: None, *, rounds: int = ROUNDS, vehicles: int = VEHICLES) -> Result:
    """Time kernels, C, peers and the start of commands in turn.

    Parameters
    ----------
    progress
        Told the share that is done.
    rounds
        As in `interleaved`.
    vehicles
        In the batch.

    Raises
    ------
    RunError
        There are no compiled physics, or C does not find the same.
    """
    drives, c_step = make_drives(), compiled_step()
    works = our_works(drives, vehicles) | (c_works(drives, c_step) if c_step else {}) | peer_works() | start_works()
    times = interleaved(works, progress, rounds)
    per_second = times[PLANT_CALLS].cpu / (CALLS * STEP)
    lines = (*step_lines(times, vehicles), *peer_lines(times, per_second), *start_lines(times))
    return Result(lines, times[CALIBRATION], () if c_step else (NO_COMPILER,))


def make_drives() -> list[Drive]:
    """Return vehicles from walking pace to 25 m/s, from straight on to wide slides."""
    random, found = np.random.default_rng(0), []
    for speed in np.linspace(0.5, 25.0, DRIVES).tolist():
        angle, *forces = random.uniform((-0.2, *(-500.0,) * 4), (0.3, *(500.0,) * 4)).tolist()
        inputs = Inputs((angle, angle, -angle, -angle), tuple(forces))
        found.append(Drive(initial_state(speed), inputs, tuple(random.uniform(-0.02, 0.02, 4).tolist())))
    return found


def our_works(drives: list[Drive], vehicles: int) -> dict[str, Callable[[], object]]:
    """Return what to time of ours."""
    numbers, requests = packed_constants(MODEL), [drive.request(STEPS) for drive in drives]
    columns = np.stack([vector(requests[number % DRIVES]) for number in range(vehicles)], axis=1)
    states, inputs, environment, rates, _ = np.split(columns, (10, 22, 28, 32))
    batch = partial(advance_batch, states, inputs, rates, environment, packed_batch(MODEL), BATCH_STEPS, STEP)
    first = drives[DRIVES // 2]

    def call_plant() -> None:
        state = first.state
        for _ in range(CALLS):
            state = plant.advance(
                state, first.inputs.steer_angle, first.steer_rate, first.inputs.drive_force, ROAD, MODEL, STEP, STEP
            )

    return {
        KERNEL: lambda: drive_all(requests, numbers),
        KERNEL_CALLS: lambda: call(first.request(1), numbers),
        PLANT_CALLS: call_plant,
        BATCH: batch,
        BATCH_THREADS: partial(batch, threads=2),
        SORT_THREADS: sort_twice,
    }


def sort_twice() -> None:
    """Do the fixed piece of work of `calibrate` on two threads at once; numpy sorts without holding up the other."""
    with ThreadPoolExecutor(2) as pool:
        for done in [pool.submit(calibrate), pool.submit(calibrate)]:
            done.result()


def our_kernel() -> Kernel:
    """Return the kernel that advances one vehicle.

    Raises
    ------
    RunError
        It is not compiled.
    """
    advance = kernel('advance')
    if advance is None:
        raise RunError('the physics are not compiled: install numba, and unset NUMBA_DISABLE_JIT')
    return advance


def drive_all(requests: list[Numbers], numbers: Numbers) -> Vector:
    """Drive each vehicle in a loop inside the kernel; return where they end."""
    advance, found = our_kernel(), [type(request).from_buffer_copy(request) for request in requests]
    for request in found:
        advance(request, numbers)
    return np.array([vector(request)[:STATE] for request in found])


def call(request: Numbers, numbers: Numbers) -> None:
    """Call the kernel step by step; each goes on from the state that it left."""
    advance = our_kernel()
    for _ in range(CALLS):
        advance(request, numbers)


def c_works(drives: list[Drive], c_step: CStep) -> dict[str, Callable[[], object]]:
    """Return what to time of C, once it has found the same as the kernel.

    Raises
    ------
    RunError
        It has not.
    """
    numbers, packed = np.array(listed_constants(MODEL)), [drive.request(STEPS) for drive in drives]
    requests = [vector(request) for request in packed]
    bare = np.array([c_step.drive(request, numbers, STEPS, STEP) for request in requests])
    apart = float(np.max(np.abs(bare - drive_all(packed, packed_constants(MODEL))) / (1.0 + np.abs(bare))))
    if not apart <= TOLERANCE:
        raise RunError(f'C and the kernel differ by {apart:.1e}, more than {TOLERANCE:.0e}: step.c is out of date')

    def loop() -> None:
        for request in requests:
            c_step.drive(request, numbers, STEPS, STEP)

    def call_c() -> None:
        request = vector(drives[DRIVES // 2].request(1))
        there, model = request.ctypes.data, numbers.ctypes.data
        for _ in range(CALLS):
            c_step.advance(there, model, 1, STEP, False)

    return {C: loop, C_CALLS: call_c}


def step_lines(times: Mapping[str, Time], vehicles: int) -> list[Line]:
    """Return the lines of steps, alone, called, and in batches."""
    cpu = {name: time.cpu for name, time in times.items()}
    looped = _times(cpu.get(C), 1e6 / (DRIVES * STEPS))
    batch = vehicles * BATCH_STEPS / cpu[BATCH]
    call = 1e6 / CALLS
    return [
        Line('step in a compiled loop', 'us', 1e6 * cpu[KERNEL] / (DRIVES * STEPS), looped, 'C at -O2', at_most(1.1)),
        Line(
            'step called from Python', 'us', call * cpu[KERNEL_CALLS], looped, 'C at -O2 in a loop', at_most(1.6),
            'arrays in and out; the strict reading: what Python costs counts on our side alone',
        ),
        Line(
            'step called from Python', 'us', call * cpu[KERNEL_CALLS], _times(cpu.get(C_CALLS), call),
            'C at -O2 called by ctypes', at_most(1.6),
        ),
        Line(
            'step called by plant.advance', 'us', call * cpu[PLANT_CALLS], looped, 'C at -O2 in a loop',
            note='as nodes do: names and tuples become arrays at every call',
        ),
        Line(
            f'batch of {vehicles}, one thread', 'vehicle-steps/s', batch, None if looped is None else 1e6 / looped,
            'C at -O2', at_least(4.0),
        ),
        thread_line(times, vehicles),
    ]  # fmt: skip


def thread_line(times: Mapping[str, Time], vehicles: int) -> Line:
    """Return the line of two threads, by wall time; judged where two cores are free only."""
    one, two = (vehicles * BATCH_STEPS / times[name].wall for name in (BATCH, BATCH_THREADS))
    speed_up = 2.0 * times[CALIBRATION].wall / times[SORT_THREADS].wall
    free = speed_up >= FREE
    return Line(
        f'batch of {vehicles}, two threads', 'vehicle-steps/s of wall time', two, one, 'one thread',
        at_least(1.7) if free else None,
        f'two threads that sort are {speed_up:.2f} times as fast as one: '
        + ('two cores are free' if free else 'two cores are not free, so this line is not judged'),
    )  # fmt: skip


def _times(value: float | None, factor: float) -> float | None:
    return None if value is None else factor * value
