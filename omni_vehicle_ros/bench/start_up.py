"""How long commands take to start: another process each time, with its Python and its imports."""

import resource
import subprocess
import sys
import time
from collections.abc import Callable, Mapping
from functools import partial

from omni_vehicle_ros.bench.frame import Line, Time, at_most

HELP = '-m', 'omni_vehicle_ros.executables', 'cli', '--help'
DRIVE = """
from omni_vehicle_ros.model.body_model import body_model
from omni_vehicle_ros.model.dynamics import Environment, Inputs
from omni_vehicle_ros.parameters import VehicleParameters

body, still = body_model(VehicleParameters()), (0.0,) * 4
body.advance(body.initial_state(5.0), Inputs(still), still, Environment(), 0.005, 0.005)
"""
FIRST_STEP = '-c', DRIVE
STARTS = (('start-up: --help', HELP, 1.0), ('start-up: to the first step, cache warm', FIRST_STEP, 1.5))
"""Name, arguments of Python, seconds allowed."""


def start_works() -> dict[str, Callable[[], Time]]:
    """Return what to time."""
    return {name: partial(started, arguments) for name, arguments, _ in STARTS}


def started(arguments: tuple[str, ...]) -> Time:
    """Run Python to its end and return the time that it took, its own CPU time and that of its children."""
    wall, before = time.perf_counter(), resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([sys.executable, *arguments], stdout=subprocess.DEVNULL, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return Time(time.perf_counter() - wall, cpu)


def start_lines(times: Mapping[str, Time]) -> list[Line]:
    """Return a line for each start."""
    return [
        Line(name, 's of CPU', times[name].cpu, allowed, 'allowed', at_most(1.0), f'{times[name].wall:.2f} s wall')
        for name, _, allowed in STARTS
    ]
