"""How fast a sweep drives turns: from values to table, beside the batch kernel with the same steps."""

from collections.abc import Callable
from functools import partial

import numpy as np

from omni_vehicle_ros.bench.frame import CALIBRATION, ROUNDS, Line, Progress, Result, at_least, interleaved
from omni_vehicle_ros.model.batch import advance_batch, packed_batch
from omni_vehicle_ros.sweep.open_loop import OpenLoop
from omni_vehicle_ros.sweep.study import Study, read_study
from omni_vehicle_ros.sweep.turns import chunk_table, turn

TURNS = 32
"""Radii, and speeds."""
STEPS = {'1 ms steps': 0.001, '5 ms steps': 0.005}
GOALS = {'1 ms steps': at_least(0.5), '5 ms steps': at_least(0.25)}
"""A cycle of 5 ms has 20 evaluations of the equations with steps of 1 ms, and 4 with steps of 5 ms. A sweep looks at
slips, forces and loads once more, keeps what it sees, works out the steering of each turn by the control law of any
run, and writes a table: half of the bare rate, and a quarter of it, are what that may cost."""
MILLION = 1e6


def bench(
    progress: Progress = lambda done: None, *, turns: int = TURNS, duration: float = 10.0, rounds: int = ROUNDS
) -> Result:
    """Drive the turns of a small grid in both ways, and return turns per second of CPU time: of one core.

    Parameters
    ----------
    progress
        Told the share that is done.
    turns
        Radii and speeds of the grid: so many of each.
    duration
        Of a turn [s].
    rounds
        As in `interleaved`.
    """
    works: dict[str, Callable[[], object]] = {}
    for name, step in STEPS.items():
        study = read_study(
            'simple_turning', [f'radius=2:10:{turns}', f'speed=0.5:6:{turns}'],
            [f'duration={duration}', f'plant.integration_step={step}'],
        )
        one = turn(study, study.points([study.turns // 2])[0])
        works[f'sweep, {name}'] = partial(sweep_all, study)
        works[f'kernel, {name}'] = partial(advance_all, study, one)
    times = interleaved(works, progress, rounds)
    count = turns**2
    lines = [
        Line(
            f'turns of {duration:g} s, {name}', 'turns/s of one core',
            count / times[f'sweep, {name}'].cpu, count / times[f'kernel, {name}'].cpu,
            'the batch kernel alone', GOALS[name],
            f'a million in {MILLION * times[f"sweep, {name}"].cpu / count / 60.0:.3g} min of CPU time',
        )
        for name in STEPS
    ]  # fmt: skip
    return Result(tuple(lines), times[CALIBRATION], (f'{count} turns in chunks, radius 2 to 10 m, speed 0.5 to 6 m/s',))


def sweep_all(study: Study) -> int:
    """Make all parts of a table; return their size [byte]."""
    return sum(len(chunk_table(study, number)) for number in range(study.chunks))


def advance_all(study: Study, one: OpenLoop) -> None:
    """Take as many steps with as many vehicles, in the same chunks, and look at nothing."""
    inputs = np.array([*one.acting[0].steer_angle, *[0.0] * 8])[:, np.newaxis]
    road = np.array([0.0, 0.0, *one.road.friction])[:, np.newaxis]
    model = packed_batch(one.constants)
    for number in range(study.chunks):
        states = np.zeros((10, len(study.numbers(number))))
        states[0] = [speed for _, speed in study.points(study.numbers(number))]
        steps = one.cycles * one.steps
        advance_batch(states, inputs, np.zeros((4, 1)), road, model, steps, one.size, one.constant_speed)
