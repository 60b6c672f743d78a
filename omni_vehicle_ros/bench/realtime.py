"""How punctual the graph is in real time, and what its processes take, at two control periods."""

import signal
import tempfile
from collections.abc import Mapping
from pathlib import Path
from statistics import median
from typing import Any

from omni_vehicle_ros.bench.frame import Line, Progress, Result, Time, calibrate, timed
from omni_vehicle_ros.graph import Graph
from omni_vehicle_ros.interface import NODES
from omni_vehicle_ros.scenarios.scenario import make_scenario

PERIODS = (0.005, 0.002)
DURATION = 60.0
CALIBRATIONS = 5


def bench(progress: Progress = lambda done: None, *, duration: float = DURATION) -> Result:
    """Drive in real time at each of `PERIODS`; return missed cycles, answers, jitter, CPU time and memory.

    Parameters
    ----------
    progress
        Told the share that is done.
    duration
        Of each drive [s].
    """
    lines: list[Line] = []
    calibrations: list[Time] = []
    for number, period in enumerate(PERIODS):
        share = 1.0 / len(PERIODS)
        calibrations += (timed(calibrate) for _ in range(CALIBRATIONS))
        found = drive(period, duration, lambda time: progress(share * (number + min(time / duration, 1.0))))  # noqa: B023
        lines += lines_of(period, found)
    return Result(tuple(lines), Time(*map(median, zip(*calibrations, strict=True))))


def drive(period: float, duration: float, advance: Progress) -> Mapping[str, Any]:
    """Drive in a circle in processes, recorded, at factor 1; return `Graph.real_time`."""
    scenario = make_scenario('bench', {
        'duration': duration,
        'side_slip_control': True,
        'plant': {'initial_speed': 4.0, 'control_period': period},
        'commands': [{'at': 0.0, 'icr': [0.0, 10.0], 'speed': 4.0}],
    })
    with tempfile.TemporaryDirectory() as folder:
        directory = Path(folder)
        (directory / 'scenario.yaml').write_text(scenario.as_yaml(), encoding='utf-8')
        graph = Graph(
            directory, scenario, NODES, one_process=False, pacing='realtime', namespace='/bench', publish_clock=False
        )
        graph.run(advance)
        if graph.interrupted:
            signal.raise_signal(graph.interrupted)
    return graph.real_time


def lines_of(period: float, found: Mapping[str, Any]) -> list[Line]:
    """Return what to print about a drive at one control period [s]."""
    at = f'at {period * 1e3:g} ms'
    note = 'none on a free machine' if period == PERIODS[0] else ''
    lines = [Line(f'missed cycles {at}', f'of {found["cycles"]:,}', float(found['missed']), note=note)]
    for name, words in (('answer', 'answer after the tick'), ('jitter', 'jitter of the answers')):
        spread = found[name] or {}
        lines += (Line(f'{words} {at}, {what}', 'ms', 1e3 * time) for what, time in spread.items())
    for role, share in found.get('cpu', {}).items():
        lines.append(Line(f'{role} {at}', '% of a core', 100.0 * share, note=f'{found["memory"][role] / 1e6:.0f} MB'))
    return lines
