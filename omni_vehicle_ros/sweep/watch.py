"""The loop of a sweep over control cycles: drives as `model.batch` does, and keeps what turns are judged by.

What is kept lies in rows below those of `model.batch`: extremes over the whole turn, and for the last second the
smallest, the largest and the sum of each signal. In plain Python, with one lane, where numba is missing.
"""

from collections.abc import Callable

from omni_vehicle_ros.model import dynamics, integrate
from omni_vehicle_ros.model.arithmetic import cos_sin, norm, positive
from omni_vehicle_ros.model.batch import WATCHED
from omni_vehicle_ros.model.batch_compiled import store_evaluation
from omni_vehicle_ros.model.compiled import compile_lanes
from omni_vehicle_ros.model.constants import Constants
from omni_vehicle_ros.model.dynamics import Environment, Evaluation
from omni_vehicle_ros.model.lanes import load, select, store
from omni_vehicle_ros.model.packing import STATE, request_rates, unpacked_constants, unpacked_request, write_state
from omni_vehicle_ros.model.state import State, Vector
from omni_vehicle_ros.model.tyres.force import side_force
from omni_vehicle_ros.model.tyres.friction_circle import lateral_capacity

LEAST_LOAD = WATCHED
"""First of four rows: smallest vertical loads [N]."""
LARGEST_AY, LARGEST_SLIDE, LARGEST_DEPARTURE = WATCHED + 4, WATCHED + 5, WATCHED + 6
"""Rows: largest sizes of lateral acceleration [m/s2], of the mean side slip of the wheels [rad], and of what a tyre
lacks of the side force that its cornering stiffness alone would make, as a share of that."""
SIGNALS = ('vx', 'vy', 'yaw_rate', 'speed', 'ay', 'slip_fl', 'slip_fr', 'slip_rl', 'slip_rr')
WINDOW = WATCHED + 7
"""First of three rows a signal: its smallest and its largest value in the last second, and the sum of all."""
ROWS = WINDOW + 3 * len(SIGNALS)

WatchKernel = Callable[[Vector, Vector, Vector, int, int, float, bool, bool, int, int, int, Vector], None]


def keep_extremes(
    found: Vector, column: int, state: State, road: Environment, now: Evaluation, model: Constants
) -> None:
    """Keep what is smaller or larger than ever before in the turn."""
    total = 0.0
    for wheel in range(4):
        row, weight = LEAST_LOAD + wheel, now.vertical_load[wheel]
        store(found, row, column, min(load(found, row, column), weight))
        total = total + abs(now.side_slip[wheel])
        lacking = departure(state, road, now, model, wheel)
        store(found, LARGEST_DEPARTURE, column, max(load(found, LARGEST_DEPARTURE, column), lacking))
    store(found, LARGEST_AY, column, max(load(found, LARGEST_AY, column), abs(now.ay)))
    store(found, LARGEST_SLIDE, column, max(load(found, LARGEST_SLIDE, column), 0.25 * total))


def departure(state: State, road: Environment, now: Evaluation, model: Constants, wheel: int) -> float:
    """Return what a tyre lacks of the side force C tan(alpha), as a share of it; see `model.tyres.region`."""
    along = state.vx - model.wheel_y[wheel] * state.r
    across = state.vy + model.wheel_x[wheel] * state.r
    cos, sin = cos_sin(abs(now.side_slip[wheel]))
    capacity = road.friction[wheel] * now.vertical_load[wheel]
    if model.friction_circle:
        capacity = lateral_capacity(capacity, now.longitudinal_force[wheel])
    force = side_force(sin, cos, norm(along, across) * sin, capacity, model)
    return select(sin > 0.0, 1.0 - force * cos / positive(model.cornering_stiffness * sin), 0.0)


def keep_signal(found: Vector, column: int, number: int, value: float) -> None:
    """Add a value of a signal to what is kept of the last second."""
    row = WINDOW + 3 * number
    store(found, row, column, min(load(found, row, column), value))
    store(found, row + 1, column, max(load(found, row + 1, column), value))
    store(found, row + 2, column, load(found, row + 2, column) + value)


def keep_signals(found: Vector, column: int, state: State, now: Evaluation) -> None:
    """Add the values of all `SIGNALS`."""
    keep_signal(found, column, 0, state.vx)
    keep_signal(found, column, 1, state.vy)
    keep_signal(found, column, 2, state.r)
    keep_signal(found, column, 3, norm(state.vx, state.vy))
    keep_signal(found, column, 4, now.ay)
    for wheel in range(4):
        keep_signal(found, column, 5 + wheel, now.side_slip[wheel])


def kernels(source: str) -> tuple[WatchKernel]:
    """Return the kernel in plain Python; ``source`` as in `model.compiled.compile_lanes`."""

    def watch(
        request: Vector,
        constants: Vector,
        shared: Vector,
        cycles: int,
        steps: int,
        size: float,
        constant_speed: bool,
        at_the_end: bool,
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
            for _ in range(cycles):
                now = integrate.integrate(now, inputs, rates, road, model, steps, size, constant_speed)
                seen = dynamics.evaluation(now, inputs, road, model, constant_speed)
                store_evaluation(found, column, seen)
                keep_extremes(found, column, now, road, seen, model)
                if at_the_end:
                    keep_signals(found, column, now, seen)
            write_state(store, found, column, now)

    return (watch,)


def compile_watch() -> WatchKernel:
    """Return the kernel, not compiled before its first call."""
    helpers = keep_extremes, departure, keep_signal, keep_signals
    found = compile_lanes(kernels, helpers)
    return kernels('')[0] if found is None else found[0]


watch_kernel = compile_watch()

