"""Seven hosts: the nodes drive over a network as they do on one machine, and do without a host that is not there."""

import dataclasses
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from omni_vehicle_ros.bags import open_bag
from omni_vehicle_ros.bench.hosts.cases import circle, counted, distances, path
from omni_vehicle_ros.bench.hosts.network import Hosts, joined_hosts, refusal
from omni_vehicle_ros.bench.hosts.switch import Disturbance
from omni_vehicle_ros.bench.hosts.vehicle import HOSTS, SpreadVehicle, driving, statuses
from omni_vehicle_ros.interface import PLANT, WHEEL_MODULES

pytestmark = pytest.mark.graph

PERIOD, TIMEOUT = 0.05, 0.5
"""So long that a busy machine keeps up: that a node is late is not what is tested here [s]."""
NEAR = 0.1
"""A module that acts three cycles late at 3 m/s has the vehicle by so much, a quarter of that aside, elsewhere [m]."""
MODULE = WHEEL_MODULES[0]
DEAF = f'no joint_states from plant for module_timeout, {TIMEOUT:g} s: angle held, no torque'


PORT = 11811


@pytest.fixture
def hosts() -> Iterator[Hosts]:
    """Return the hosts of the seven nodes, 10.77.0.1 that of the plant."""
    why = refusal()
    if why:
        pytest.skip(why)
    with joined_hosts(HOSTS) as made:
        yield made


@pytest.fixture
def vehicle(hosts: Hosts, tmp_path: Path) -> Iterator[SpreadVehicle]:
    """Return a vehicle that drives on seven hosts."""
    scenario = circle(PERIOD, 3600.0)
    scenario = dataclasses.replace(
        scenario,
        plant=dataclasses.replace(scenario.plant, state_timeout=TIMEOUT),
        wheel_module=dataclasses.replace(scenario.wheel_module, module_timeout=TIMEOUT),
    )
    with driving(SpreadVehicle(hosts, tmp_path, scenario)) as started:
        yield started


def test_seven_hosts_drive_do_without_one_for_a_while_and_for_good(vehicle: SpreadVehicle) -> None:
    def last(name: str) -> str:
        return {status.name: status.message for _, status in statuses(vehicle.bag)}.get(name, '')

    def missed() -> bool:
        return last('/plant').startswith('no answer') and MODULE in last('/plant')

    vehicle.drive(2.0)
    vehicle.hosts.cut(MODULE)
    vehicle.until(missed, 'the plant to miss the module')
    vehicle.until(lambda: 'front_left wheel module is silent' in last('/icr_steering'), 'ICR steering to miss it')
    vehicle.hosts.cut()
    vehicle.until(lambda: not missed(), 'the plant to hear the module again')
    vehicle.until(lambda: any(DEAF in status.message for _, status in statuses(vehicle.bag)), 'what it said meanwhile')
    vehicle.until(lambda: DEAF not in last(f'/{MODULE}'), 'the module to hear the others again')
    vehicle.kill(MODULE)
    vehicle.until(missed, 'the plant to miss the host')
    vehicle.stop()
    bag = open_bag(vehicle.bag)
    odom = bag['odom']
    assert bag['joint_states'].effort[-1, 4] == 0.0
    sound = odom.stamp <= vehicle.began + 2.0
    cycles, late = counted(status for stamp, status in statuses(vehicle.bag) if 0.0 <= stamp - vehicle.began <= 2.0)
    if late < 0.1 * cycles:  # else the machine has no time for nine processes, and the path is not the network's
        assert odom.yaw_rate[-1] > 0.1
        assert np.max(distances(np.column_stack([odom.x, odom.y])[sound], path(PERIOD))) < NEAR


def test_static_peers_drive_where_no_multicast_goes_through(hosts: Hosts, tmp_path: Path) -> None:
    addresses = ';'.join(f'10.77.0.{number}' for number in range(1, len(HOSTS) + 1))
    found_without_multicast(
        hosts, tmp_path, 'ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST', f'ROS_STATIC_PEERS={addresses}'
    )


def test_clients_of_a_discovery_server_drive_where_no_multicast_goes_through(hosts: Hosts, tmp_path: Path) -> None:
    places = os.pathsep.join([f'{sys.prefix}/bin', os.environ['PATH']])
    program = shutil.which('fast-discovery-server', path=places)
    if program is None:
        pytest.skip('Fast DDS is without its discovery server here')
    words = [*hosts.prefix(PLANT), program, '-i', '0', '-l', '10.77.0.1', '-p', str(PORT)]
    with subprocess.Popen(words, stdout=subprocess.DEVNULL) as server:
        try:
            found_without_multicast(hosts, tmp_path, f'ROS_DISCOVERY_SERVER=10.77.0.1:{PORT}')
        finally:
            server.kill()


def found_without_multicast(hosts: Hosts, directory: Path, *discovery: str) -> None:
    """Have the nodes find each other, and the vehicle do what the driver says."""
    hosts.switch.disturbance = Disturbance(multicast=False)
    with driving(SpreadVehicle(hosts, directory, circle(PERIOD, 3600.0), discovery)) as vehicle:
        vehicle.drive(2.0)
    odom = open_bag(vehicle.bag)['odom']
    assert odom.vx[-1] > 0.5
    assert odom.yaw_rate[-1] > 0.01
