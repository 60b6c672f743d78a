"""What figures and claims need to have computed: runs of scenarios and whatever else takes time.

A task is a value: two figures that need the same one name equal tasks, and it is done once, in any process.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol, TypeVar

import numpy as np

from omni_vehicle_ros.analysis.metrics import compute_metrics
from omni_vehicle_ros.analysis.signals import Array, StepMetrics, step_metrics
from omni_vehicle_ros.scenarios import Scenario, load_scenario
from omni_vehicle_ros.simulation import record
from omni_vehicle_ros.workers import Done, Workers

FOLDER = 'thesis'
FLOOR = 1e-7  # rad, far below the slips that a light wind makes
T = TypeVar('T')
T_co = TypeVar('T_co', covariant=True)


class Task(Protocol[T_co]):
    """Something to compute: hashable, and small enough to be sent to another process."""

    def work(self) -> T_co:
        """Compute it."""


class Results:
    """The results of tasks, by task."""

    def __init__(self, found: Mapping[Task[Any], Any]) -> None:
        self._found = found

    def __getitem__(self, task: Task[T]) -> T:
        """Return the result of a task; KeyError if nobody said that it is needed."""
        return self._found[task]  # type: ignore[no-any-return]


def work_on(workers: Workers, tasks: Sequence[Task[Any]], done: Done = lambda: None) -> Results:
    """Do tasks, each once; ``done`` is called after each.

    Raises
    ------
    RunError
        A worker ended before its time.
    """
    return Results(workers.each({task: (task,) for task in tasks}, _work, done))


def _work(task: Task[T]) -> T:
    return task.work()


@dataclass(frozen=True)
class Recording:
    """The arrays of a run, one row a control cycle, fl, fr, rl, rr where per wheel.

    Attributes
    ----------
    scenario
        What was run.
    metrics
        As in metrics.json.
    time
        From 0 [s], shape (n,).
    vx, vy, yaw_rate, x, y
        Twist in base_link [m/s, rad/s] and position in odom [m], shape (n,).
    side_slip, steer_angle
        [rad], shape (n, 4).
    load
        Vertical loads [N], shape (n, 4).
    friction_use
        Force in the road plane over friction times load, shape (n, 4).
    """

    scenario: Scenario
    metrics: Mapping[str, Any]
    time: Array
    vx: Array
    vy: Array
    yaw_rate: Array
    x: Array
    y: Array
    side_slip: Array
    steer_angle: Array
    load: Array
    friction_use: Array

    def rows(self, begin: float, end: float) -> slice:
        """Return the rows from ``begin`` to ``end`` [s], both included."""
        first, last = np.searchsorted(self.time, (begin - 1e-9, end + 1e-9))
        return slice(int(first), int(last))

    def step(self, wheel: int, begin: float = 0.0, end: float | None = None) -> StepMetrics:
        """Return how the side slip of a wheel answers what happens at ``begin``, by what it does until ``end`` [s]."""
        rows = self.rows(begin, self.time[-1] if end is None else end)
        return step_metrics(self.time[rows], self.side_slip[rows, wheel], FLOOR)


@dataclass(frozen=True)
class Run:
    """A run of a scenario of the thesis, offline, by the same components as any run.

    Attributes
    ----------
    scenario
        Name of a file in config/scenarios/thesis.
    settings
        ``name=value``, as ``--set`` takes them.
    """

    scenario: str
    settings: tuple[str, ...] = ()

    def load(self) -> Scenario:
        """Return what is run."""
        return load_scenario(f'{FOLDER}/{self.scenario}', self.settings)

    def work(self) -> Recording:
        """Run it."""
        scenario = self.load()
        bag = record(scenario)
        odom, slip, force = bag['odom'], bag['tyres/side_slip'], bag['tyres/force']
        return Recording(
            scenario=scenario,
            metrics=compute_metrics(bag, scenario.vehicle),
            time=odom.stamp,
            vx=odom.vx,
            vy=odom.vy,
            yaw_rate=odom.yaw_rate,
            x=odom.x,
            y=odom.y,
            side_slip=slip.position,
            steer_angle=bag['joint_states'].position[:, :4],
            load=force.forces[:, :, 2],
            friction_use=slip.effort,
        )


def run(scenario: str, **values: object) -> Run:
    """Return the run of a scenario of the thesis with some of its values set."""
    return Run(scenario, tuple(f'{name}={value}' for name, value in values.items()))


def km_per_h(speed: float) -> float:
    """Return a speed [m/s] that is given in km/h, with four decimals as in the files of the scenarios."""
    return round(speed / 3.6, 4)
