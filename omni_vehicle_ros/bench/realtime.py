"""How punctual the graph is in real time, and what its processes take: at two control periods, in two modes."""

import signal
import tempfile
import threading
import time
from collections.abc import Mapping
from pathlib import Path
from statistics import median
from typing import Any

from omni_vehicle_ros.bench.frame import Line, Progress, Result, Time, calibrate, timed
from omni_vehicle_ros.graph import Graph
from omni_vehicle_ros.interface import NODES
from omni_vehicle_ros.results import write_scenario
from omni_vehicle_ros.scenarios.scenario import make_scenario

PERIODS = (0.005, 0.002)
DURATION = 60.0
CALIBRATIONS = 5


def bench(progress: Progress = lambda done: None, *, duration: float = DURATION) -> Result:
    """Drive in real time at each of `PERIODS`, in processes and in one process, beside a thread that only sleeps.

    Returns missed cycles, answers, jitter, CPU time and memory.

    Parameters
    ----------
    progress
        Told the share that is done.
    duration
        Of each drive [s].
    """
    lines: list[Line] = []
    calibrations: list[Time] = []
    drives = [(period, one_process) for period in PERIODS for one_process in (False, True)]
    for number, (period, one_process) in enumerate(drives):
        share = 1.0 / len(drives)
        calibrations += (timed(calibrate) for _ in range(CALIBRATIONS))
        with Sleeper(period) as sleeper:
            found = drive(
                period, duration, lambda time: progress(share * (number + min(time / duration, 1.0))),  # noqa: B023
                one_process=one_process,
            )
        lines += lines_of(period, found, sleeper, one_process=one_process)
    return Result(tuple(lines), Time(*map(median, zip(*calibrations, strict=True))))


class Sleeper:
    """A thread that does nothing but sleep from tick to tick, in a ``with`` block: what the machine itself makes late.

    Parameters
    ----------
    period
        Time from one tick to the next [s].

    Attributes
    ----------
    ticks, late
        Counted so far, and those of them that came more than half a period late.
    """

    def __init__(self, period: float) -> None:
        self.ticks = self.late = 0
        self._period = period
        self._thread = threading.Thread(target=self._sleep)
        self._over = False

    def _sleep(self) -> None:
        due = time.monotonic() + self._period
        while not self._over:
            time.sleep(max(due - time.monotonic(), 0.0))
            self.ticks += 1
            self.late += time.monotonic() - due > 0.5 * self._period
            due += self._period

    def __enter__(self) -> 'Sleeper':
        """Begin."""
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        """Come to an end with the next tick."""
        self._over = True
        self._thread.join()


def drive(period: float, duration: float, advance: Progress, *, one_process: bool) -> Mapping[str, Any]:
    """Drive in a circle, recorded, at factor 1; return `Graph.real_time`."""
    scenario = make_scenario('bench', {
        'duration': duration,
        'side_slip_control': True,
        'plant': {'initial_speed': 4.0, 'control_period': period},
        'commands': [{'at': 0.0, 'icr': [0.0, 10.0], 'speed': 4.0}],
    })
    with tempfile.TemporaryDirectory() as folder:
        directory = Path(folder)
        write_scenario(directory, scenario)
        graph = Graph(
            directory, scenario, NODES, one_process=one_process, pacing='realtime', namespace='/bench',
            publish_clock=False,
        )  # fmt: skip
        graph.run(advance)
        if graph.interrupted:
            signal.raise_signal(graph.interrupted)
    return graph.real_time


def lines_of(period: float, found: Mapping[str, Any], sleeper: Sleeper, *, one_process: bool) -> list[Line]:
    """Return what to print about a drive at one control period [s]."""
    at = f'at {period * 1e3:g} ms {"in one process" if one_process else "in processes"}'
    goal = 'goal: none on a free machine; ' if period == PERIODS[0] else ''
    note = f'{goal}a thread that only sleeps was late {sleeper.late:,} times in {sleeper.ticks:,}'
    lines = [Line(f'missed cycles {at}', f'of {found["cycles"]:,}', float(found['missed']), note=note)]
    for name, words in (('answer', 'answer after the tick'), ('jitter', 'jitter of the answers')):
        spread = found[name] or {}
        lines += (Line(f'{words} {at}, {what}', 'ms', 1e3 * time) for what, time in spread.items())
    for role, share in found.get('cpu', {}).items():
        lines.append(Line(f'{role} {at}', '% of a core', 100.0 * share, note=f'{found["memory"][role] / 1e6:.0f} MB'))
    return lines
