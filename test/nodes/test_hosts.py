"""Seven hosts: the nodes drive over a network as they do on one machine, and do without a host that is not there."""

import dataclasses
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from omni_vehicle_ros.bags import open_bag
from omni_vehicle_ros.bench.hosts.cases import circle, distances, path
from omni_vehicle_ros.bench.hosts.network import refusal
from omni_vehicle_ros.bench.hosts.vehicle import SpreadVehicle, spread_vehicle, statuses
from omni_vehicle_ros.interface import WHEEL_MODULES

pytestmark = pytest.mark.graph

PERIOD, TIMEOUT = 0.05, 0.5
"""So long that a busy machine keeps up: that a node is late is not what is tested here [s]."""
NEAR = 0.1
"""A module that acts three cycles late at 3 m/s has the vehicle by so much, a quarter of that aside, elsewhere [m]."""
MODULE = WHEEL_MODULES[0]
SILENT = f'no answer from {MODULE}: no torque, steer angle held'
DEAF = f'no joint_states from plant for module_timeout, {TIMEOUT:g} s: angle held, no torque'


@pytest.fixture
def vehicle(tmp_path: Path) -> Iterator[SpreadVehicle]:
    """Return a vehicle that drives on seven hosts."""
    why = refusal()
    if why:
        pytest.skip(why)
    scenario = circle(PERIOD, 3600.0)
    scenario = dataclasses.replace(
        scenario,
        plant=dataclasses.replace(scenario.plant, state_timeout=TIMEOUT),
        wheel_module=dataclasses.replace(scenario.wheel_module, module_timeout=TIMEOUT),
    )
    with spread_vehicle(tmp_path, scenario) as started:
        yield started


def test_seven_hosts_drive_do_without_one_for_a_while_and_for_good(vehicle: SpreadVehicle) -> None:
    def last(name: str) -> str:
        return {status.name: status.message for _, status in statuses(vehicle.bag)}.get(name, '')

    vehicle.drive(2.0)
    vehicle.hosts.cut(MODULE)
    vehicle.until(lambda: last('/plant') == SILENT, 'the plant to miss the module')
    vehicle.until(lambda: 'front_left wheel module is silent' in last('/icr_steering'), 'ICR steering to miss it')
    vehicle.hosts.cut()
    vehicle.until(lambda: last('/plant') == 'driving', 'the plant to hear the module again')
    vehicle.until(lambda: last(f'/{MODULE}') == 'following its set-points', 'the module to hear the others again')
    assert DEAF in {status.message for _, status in statuses(vehicle.bag) if status.name == f'/{MODULE}'}
    vehicle.kill(MODULE)
    vehicle.until(lambda: last('/plant') == SILENT, 'the plant to miss the host')
    vehicle.stop()
    bag = open_bag(vehicle.bag)
    odom = bag['odom']
    sound = odom.stamp <= vehicle.began + 2.0
    assert np.max(distances(np.column_stack([odom.x, odom.y])[sound], path(PERIOD))) < NEAR
    assert bag['joint_states'].effort[-1, 4] == 0.0
    assert odom.vx[-1] > 1.0
