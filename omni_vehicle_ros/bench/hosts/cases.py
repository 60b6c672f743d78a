"""What a network may do to a vehicle on several hosts, and what comes of it."""

import tempfile
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from scipy.spatial import KDTree

from omni_vehicle_ros.analysis.signals import Array
from omni_vehicle_ros.bags import open_bag, read_messages
from omni_vehicle_ros.bench.hosts.switch import Disturbance
from omni_vehicle_ros.bench.hosts.vehicle import SpreadVehicle, latest_diagnostics, spread_vehicle
from omni_vehicle_ros.interface import ICR_STEERING, SIDE_SLIP_CONTROLLER, WHEEL_MODULES
from omni_vehicle_ros.messages import Diagnostics, decode
from omni_vehicle_ros.scenarios.scenario import Scenario, make_scenario
from omni_vehicle_ros.simulation import simulate
from omni_vehicle_ros.wheels import WHEELS

RADIUS, SPEED = 10.0, 3.0
EVENT, DOWN, DURATION = 3.0, 2.0, 8.0
"""When a cable is pulled or a host dies, for how long a pulled cable is out, and when a drive ends [s]."""
GAINS = [2.0, 2.0, 0.0, 0.0]
"""Of side-slip control: stable at all periods that are driven."""
JITTER = 0.2
RESOLUTION = 0.001
"""Distance of the points of the path that others are held against [m]."""
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
    punctual
        See `Punctuality.figures`.
    deviation
        Largest distance from the path of an undisturbed drive [m].
    passive
        Wheels that the plant has called passive.
    speed
        At the end [m/s].
    said
        What ICR steering said last.
    """

    punctual: dict[str, Any]
    deviation: float
    passive: tuple[str, ...]
    speed: float
    said: str


def unplug(vehicle: SpreadVehicle) -> None:
    """Pull the cable of the front left wheel module, and plug it in again after `DOWN`."""
    vehicle.hosts.cut(WHEEL_MODULES[0])
    vehicle.drive(EVENT + DOWN)
    vehicle.hosts.cut()


CASES = (
    Case('nothing'),
    *(Case(f'{100 * loss:g} % of the frames lost', Disturbance(loss)) for loss in (0.01, 0.05, 0.1, 0.3)),
    *(
        Case(f'{delay:g} ms under way, ± {100 * JITTER:g} %', Disturbance(0.0, 1e-3 * delay, JITTER))
        for delay in (1, 5, 10, 20)
    ),
    Case(f'cable of the front left module out for {DOWN:g} s', event=unplug),
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
        'side_slip': {'proportional_gains': GAINS},
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
            vehicle.hosts.switch.disturbance = case.disturbance
            vehicle.drive(EVENT)
            case.event(vehicle)
            vehicle.drive(DURATION)
            vehicle.hosts.switch.disturbance = Disturbance()
            punctual = vehicle.stop()
        return outcome(vehicle, punctual, period)


def outcome(vehicle: SpreadVehicle, punctual: dict[str, Any], period: float) -> Outcome:
    """Return what came of a drive that has ended."""
    odom = open_bag(vehicle.bag)['odom']
    return Outcome(
        punctual,
        float(np.max(distances(np.column_stack([odom.x, odom.y]), path(period)))),
        passive_wheels(vehicle.bag, vehicle.began),
        float(np.hypot(odom.vx[-1], odom.vy[-1])),
        latest_diagnostics(vehicle.bag).get(f'/{ICR_STEERING}', ''),
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


def passive_wheels(bag: Path, began: float) -> tuple[str, ...]:
    """Return the wheels that the plant has called passive, from a simulated time on [s]."""
    found: set[str] = set()
    for message in read_messages(bag):
        if message.topic == '/diagnostics':
            said: Diagnostics = decode(message.type_name, message.data)
            for status in said.statuses:
                if status.name == '/plant' and 'no answer' in status.message and said.stamp > 1e9 * (began + 0.5):
                    found.update(wheel for wheel in WHEELS if f'{wheel}/wheel_module' in status.message)
    return tuple(wheel for wheel in WHEELS if wheel in found)
