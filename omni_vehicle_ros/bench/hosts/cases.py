"""What a network may do to a vehicle on several hosts, and what comes of it."""

import re
import tempfile
from collections import defaultdict
from collections.abc import Callable, Iterable
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from scipy.spatial import KDTree

from omni_vehicle_ros.analysis.signals import Array
from omni_vehicle_ros.bags import open_bag
from omni_vehicle_ros.bench.hosts.switch import Disturbance
from omni_vehicle_ros.bench.hosts.vehicle import SpreadVehicle, spread_vehicle, statuses
from omni_vehicle_ros.control.health import OK
from omni_vehicle_ros.interface import ICR_STEERING, PLANT, SIDE_SLIP_CONTROLLER, WHEEL_MODULES
from omni_vehicle_ros.messages import Status
from omni_vehicle_ros.scenarios.scenario import Scenario, make_scenario
from omni_vehicle_ros.simulation import simulate
from omni_vehicle_ros.wheels import WHEELS

RADIUS, SPEED = 10.0, 3.0
SETTLED, EVENT, DOWN, DURATION = 1.5, 4.0, 2.0, 12.0
"""From when on is counted what the start had no part in; when a cable is pulled or a host dies, for how long a pulled
cable is out, and when a drive ends [s]."""
GAINS = [2.0, 2.0, 0.0, 0.0]
"""Of side-slip control: stable at all periods that are driven."""
JITTER = 0.2
RESOLUTION = 0.001
"""Distance of the points of the path that others are held against [m]."""
NUMBERS = re.compile(r': |, (?=[-\d]|at )')
"""Where in a diagnostic values and consequences begin."""
COUNT = re.compile(r'^\d+ of \d+ ')
"""How a diagnostic that counts begins."""
LAP = 30.0
"""More than the vehicle takes to come round [s]."""

Act = Callable[[SpreadVehicle], None]


class Case(NamedTuple):
    """One drive: its name, what the network does from its begin on, and what happens at `EVENT`."""

    name: str
    disturbance: Disturbance = Disturbance()
    event: Act = lambda vehicle: None


class Outcome(NamedTuple):
    """What came of a drive.

    Attributes
    ----------
    cycles, missed
        From `SETTLED` to the end: how many there were, and in how many not all four modules answered in time.
    answer
        Median of the time from a tick to the answer of a module [s]; NaN if there was none.
    deviation
        Largest distance from the path of an undisturbed drive [m].
    speed
        At the end [m/s].
    said
        What the nodes said that is wrong, from `SETTLED` on; see `complaints`.
    frames, load
        Frames a second that the switch forwarded, and the share of a core that it took.
    """

    cycles: int
    missed: int
    answer: float
    deviation: float
    speed: float
    said: tuple[str, ...]
    frames: float
    load: float


def unplug(host: str) -> Act:
    """Return what pulls the cable of a host, and plugs it in again after `DOWN`."""

    def event(vehicle: SpreadVehicle) -> None:
        vehicle.hosts.cut(host)
        vehicle.drive(EVENT + DOWN)
        vehicle.hosts.cut()

    return event


CASES = (
    Case('nothing'),
    *(Case(f'{100 * loss:g} % of the frames lost', Disturbance(loss)) for loss in (0.01, 0.05, 0.1, 0.3)),
    *(
        Case(f'{delay:g} ms under way, ± {100 * JITTER:g} %', Disturbance(0.0, 1e-3 * delay, JITTER))
        for delay in (1, 5, 10, 20)
    ),
    Case(f'cable of the front left module out for {DOWN:g} s', event=unplug(WHEEL_MODULES[0])),
    Case(f'cable of the plant out for {DOWN:g} s', event=unplug(PLANT)),
    Case('host of the front left module gone', event=lambda vehicle: vehicle.kill(WHEEL_MODULES[0])),
    Case('host of `side_slip_controller` gone', event=lambda vehicle: vehicle.kill(SIDE_SLIP_CONTROLLER)),
    Case('host of `icr_steering` gone', event=lambda vehicle: vehicle.kill(ICR_STEERING)),
)


def circle(period: float, duration: float) -> Scenario:
    """Return a drive from standstill into a circle and round it, at a control period [s]."""
    return make_scenario('hosts', {
        'duration': duration,
        'side_slip_control': True,
        'command_period': 0.1,
        'steering': {'fault_reaction': False},
        'side_slip': {'proportional_gains': GAINS, 'fault_reaction': False},
        'plant': {'control_period': period},
        'commands': [{'at': 0.0, 'icr': [0.0, RADIUS], 'speed': SPEED}],
    })


def drive(case: Case, period: float) -> Outcome:
    """Drive in real time at a control period [s] and return what came of it.

    Raises
    ------
    RunError
        There can't be several hosts here, or the nodes do not find each other.
    """
    with tempfile.TemporaryDirectory() as folder:
        with spread_vehicle(Path(folder), circle(period, 3600.0)) as vehicle:
            before = vehicle.hosts.switch.forwarded
            vehicle.hosts.switch.disturbance = case.disturbance
            vehicle.drive(EVENT)
            case.event(vehicle)
            vehicle.drive(DURATION)
            frames = (vehicle.hosts.switch.forwarded - before) / DURATION
            vehicle.hosts.switch.disturbance = Disturbance()
            punctual = vehicle.stop()
        return outcome(vehicle, punctual, period, frames)


def outcome(vehicle: SpreadVehicle, punctual: dict[str, Any], period: float, frames: float) -> Outcome:
    """Return what came of a drive that has ended, of which the switch forwarded so many frames a second."""
    odom = open_bag(vehicle.bag)['odom']
    driven = odom.stamp <= vehicle.began + DURATION
    x, y = odom.x[driven], odom.y[driven]
    said = [
        status for stamp, status in statuses(vehicle.bag)
        if vehicle.began + SETTLED <= stamp <= vehicle.began + DURATION
    ]
    answer = punctual['answer']
    return Outcome(
        *counted(said),
        answer['p50'] if answer else float('nan'),
        float(np.max(distances(np.column_stack([x, y]), path(period)))),
        float(np.hypot(odom.vx[driven][-1], odom.vy[driven][-1])),
        complaints(said),
        frames,
        vehicle.hosts.switch.load,
    )


def counted(said: Iterable[Status]) -> tuple[int, int]:
    """Return how many cycles the plant counted from the first to the last of its statuses, and missed ones."""
    counts = [dict(status.values) for status in said if status.name == f'/{PLANT}' and status.values]
    first, last = counts[0], counts[-1]
    return int(last['cycles']) - int(first['cycles']), int(last['missed']) - int(first['missed'])


def complaints(said: Iterable[Status]) -> tuple[str, ...]:
    """Return who said what that is wrong, each once and without its numbers, in the order of their first times.

    What concerned several wheels is said of ``<wheel>``.
    """
    found: defaultdict[str, set[str]] = defaultdict(set)
    for status in said:
        for note in status.message.split('; ') if status.level > OK else ():
            text = f'{status.name[1:]}: {COUNT.sub("", NUMBERS.split(note)[0])}'
            wheels = [wheel for wheel in WHEELS if wheel in text]
            for wheel in wheels:
                text = text.replace(wheel, '<wheel>')
            text = re.sub(r'(<wheel>[^ ,]*)(, <wheel>[^ ,]*)+', r'\1', text)
            found[text].update(wheels)
    return tuple(
        text.replace('<wheel>', next(iter(wheels))) if len(wheels) == 1 else text for text, wheels in found.items()
    )


@lru_cache
def path(period: float) -> Array:
    """Return the path of an undisturbed drive, once round the circle; of one host, and in lock step; n x 2 [m]."""
    with tempfile.TemporaryDirectory() as folder:
        bag = Path(folder) / 'bag'
        simulate(circle(period, LAP), bag)
        odom = open_bag(bag)['odom']
        x, y = np.array(odom.x), np.array(odom.y)
    along = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(x), np.diff(y)))])
    places = np.arange(0.0, along[-1], RESOLUTION)
    return np.column_stack([np.interp(places, along, x), np.interp(places, along, y)])


def distances(points: Array, line: Array) -> Array:
    """Return how far each of n points is from the nearest one of a line; n x 2 and m x 2 [m]."""
    return np.asarray(KDTree(line).query(points)[0])
