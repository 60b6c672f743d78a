"""Seven hosts: the nodes drive over a network as they do on one machine, and do without a host that is not there."""

import dataclasses
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import numpy as np
import pytest

from omni_vehicle_ros.bags import open_bag
from omni_vehicle_ros.bench.hosts.cases import circle, distances, passive_wheels, path
from omni_vehicle_ros.bench.hosts.network import refusal
from omni_vehicle_ros.bench.hosts.vehicle import SpreadVehicle, latest_diagnostics, spread_vehicle
from omni_vehicle_ros.interface import WHEEL_MODULES

from .test_live import diagnostics

pytestmark = pytest.mark.graph

PERIOD, TIMEOUT = 0.05, 0.5
"""So long that a busy machine keeps up: that a node is late is not what is tested here [s]."""
NEAR = 0.1
"""A module that acts three cycles late at 3 m/s has the vehicle by so much, a quarter of that aside, elsewhere [m]."""
MODULE = WHEEL_MODULES[0]


@pytest.fixture
def start(tmp_path: Path) -> Iterator[Callable[[], SpreadVehicle]]:
    """Return what starts a vehicle on seven hosts; the test ends it, at the latest with its own end."""
    why = refusal()
    if why:
        pytest.skip(why)
    scenario = circle(PERIOD, 3600.0)
    scenario = dataclasses.replace(
        scenario,
        plant=dataclasses.replace(scenario.plant, state_timeout=TIMEOUT),
        wheel_module=dataclasses.replace(scenario.wheel_module, module_timeout=TIMEOUT),
    )
    with ExitStack() as stack:
        yield lambda: stack.enter_context(spread_vehicle(tmp_path, scenario))


def off_the_path(bag: Path) -> float:
    odom = open_bag(bag)['odom']
    return float(np.max(distances(np.column_stack([odom.x, odom.y]), path(PERIOD))))


def test_seven_hosts_drive_the_circle_of_one(start: Callable[[], SpreadVehicle]) -> None:
    vehicle = start()
    vehicle.drive(6.0)
    vehicle.stop()
    assert off_the_path(vehicle.bag) < NEAR
    odom = open_bag(vehicle.bag)['odom']
    assert np.hypot(odom.x[-1], odom.y[-1]) > 5.0


def test_a_wheel_whose_cable_is_out_goes_passive_and_comes_back(start: Callable[[], SpreadVehicle]) -> None:
    vehicle = start()
    vehicle.drive(3.0)
    vehicle.hosts.cut(MODULE)
    vehicle.drive(5.0)
    vehicle.hosts.cut()
    vehicle.drive(8.0)
    vehicle.stop()
    assert 'front_left' in passive_wheels(vehicle.bag, vehicle.began)
    silence = np.diff(open_bag(vehicle.bag)['odom'].stamp)
    assert silence.max() < 1.5 * PERIOD
    said = {(name, text) for _, name, text in diagnostics(vehicle.bag)}
    assert any(name == '/icr_steering' and 'front_left wheel module is silent' in text for name, text in said)
    last = latest_diagnostics(vehicle.bag)
    assert last['/plant'] == 'driving'
    assert last[f'/{MODULE}'] == 'following its set-points'
    assert open_bag(vehicle.bag)['odom'].vx[-1] > 1.0


def test_without_a_host_the_vehicle_drives_on_and_says_so(start: Callable[[], SpreadVehicle]) -> None:
    vehicle = start()
    vehicle.drive(3.0)
    vehicle.kill(MODULE)
    vehicle.drive(7.0)
    vehicle.stop()
    last = latest_diagnostics(vehicle.bag)
    assert last['/plant'].startswith(f'no answer from {MODULE}')
    assert 'front_left wheel module is silent' in last['/icr_steering']
    bag = open_bag(vehicle.bag)
    assert bag['joint_states'].effort[-1, 4] == 0.0
    assert bag['odom'].vx[-1] > 1.0
