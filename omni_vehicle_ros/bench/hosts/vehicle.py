"""A vehicle whose seven nodes are on seven hosts, with its driver and its recorder on the host of the plant."""

import contextlib
import json
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

from omni_vehicle_ros.bags import read_messages
from omni_vehicle_ros.bench.hosts.network import Hosts, joined_hosts
from omni_vehicle_ros.errors import BagError, RunError
from omni_vehicle_ros.graph import node_parameters
from omni_vehicle_ros.interface import DRIVER, NODES, PLANT, RECORDER
from omni_vehicle_ros.messages import Diagnostics, Status, decode
from omni_vehicle_ros.parameters import PacingParameters
from omni_vehicle_ros.processes import Processes
from omni_vehicle_ros.results import write_scenario
from omni_vehicle_ros.scenarios import Scenario

HOSTS = tuple(role for role in NODES if role not in (DRIVER, RECORDER))
MULTICAST = ('ROS_AUTOMATIC_DISCOVERY_RANGE=SUBNET',)
"""What has nodes find each other in a network that lets multicast through."""
ENVIRONMENT = 'env', 'FASTDDS_BUILTIN_TRANSPORTS=UDPv4'
"""Of all nodes. Namespaces share /dev/shm, which hosts do not: without shared memory there is only the network."""
LIMIT = 120.0
LOOK_PERIOD = 0.3


class SpreadVehicle:
    """The nodes of a vehicle in real time, each on the host of its name; see `spread_vehicle`.

    Parameters
    ----------
    hosts
        One for each of `HOSTS`.
    directory
        Gets bag, logs and parameters.
    scenario
        What is driven.
    discovery
        How the nodes find each other: variables of their environment, each ``NAME=value``.

    Attributes
    ----------
    hosts
        What they run on.
    bag
        What they said.
    began
        Simulated time at which the driver began [s].
    """

    def __init__(
        self, hosts: Hosts, directory: Path, scenario: Scenario, discovery: Sequence[str] = MULTICAST
    ) -> None:
        self.hosts, self.bag = hosts, directory / 'bag'
        self._environment = *ENVIRONMENT, *discovery
        self.began = 0.0
        self._now = 0.0
        self._parameters = directory / 'parameters.yaml'
        self._processes = Processes(directory / 'log')
        self._killed: set[str] = set()
        self._stopped = False
        self._punctual: dict[str, Any] = {}
        (directory / 'log').mkdir()
        write_scenario(directory, scenario)
        settings = PacingParameters(pacing='realtime', participants=NODES)
        self._parameters.write_text(node_parameters(scenario, directory.resolve(), settings), encoding='utf-8')

    def start(self) -> None:
        """Start all nodes, the driver when the others drive, and wait for it.

        Raises
        ------
        RunError
            They do not find each other.
        """
        for role in (*HOSTS[1:], RECORDER, PLANT):
            self._spawn(role)
        self.until(self._drives, 'all nodes')
        self._spawn(DRIVER)
        self.until(lambda: self._now > 0.0, 'the driver')
        self.began = self._now

    def _spawn(self, role: str) -> None:
        wheel, _, executable = role.rpartition('/')
        remap = ['-r', f'__ns:=/{wheel}'] if wheel else []
        host = role if role in HOSTS else PLANT
        self._processes.spawn(
            role, f'nodes.{executable}', ['--ros-args', '--params-file', str(self._parameters), *remap],
            prefix=[*self.hosts.prefix(host), *self._environment],
        )

    def _drives(self) -> bool:
        """Whether every node has said that it is there, and the plant that it has all its wheels."""
        said = {status.name: status.message for _, status in statuses(self.bag)}
        return said.get('/plant', '') == 'driving' and all(f'/{role}' in said for role in (*HOSTS, RECORDER))

    def until(self, condition: Callable[[], bool], what: str) -> None:
        """Wait for something that the nodes bring about.

        Raises
        ------
        RunError
            It does not come about in `LIMIT`, or a node ends.
        """
        end = time.monotonic() + LIMIT
        while not condition():
            self._read(LOOK_PERIOD)
            if time.monotonic() > end:
                raise RunError(f'waited {LIMIT:g} s in vain for {what} of the vehicle on several hosts')

    def drive(self, duration: float) -> None:
        """Wait until the driver has driven for that long [s], since it began."""
        while self._now < self.began + duration:
            self._read(LOOK_PERIOD)

    def kill(self, host: str) -> None:
        """Have a host lose its power."""
        self.hosts.kill(host)
        self._killed.add(host)

    def _read(self, timeout: float) -> None:
        self._take(self._processes.lines(timeout))
        for role in self._processes.ended().keys() - self._killed:
            raise RunError(self._processes.last_words(role))

    def _take(self, lines: list[str]) -> None:
        for line in lines:
            word, _, rest = line.partition(' ')
            if word == 'time':
                self._now = float(rest)
            elif word == 'punctual':
                self._punctual = json.loads(rest)

    def stop(self) -> dict[str, Any]:
        """End all nodes; return what the plant found, see `Punctuality.figures`. A second call does nothing more."""
        if not self._stopped:
            self._stopped = True
            self._take(self._processes.stop(last=RECORDER))
        return self._punctual


@contextlib.contextmanager
def spread_vehicle(directory: Path, scenario: Scenario) -> Iterator[SpreadVehicle]:
    """Have a vehicle drive on seven hosts for a ``with`` block; bag and logs are in ``directory``."""
    with joined_hosts(HOSTS) as hosts, driving(SpreadVehicle(hosts, directory, scenario)) as vehicle:
        yield vehicle


@contextlib.contextmanager
def driving(vehicle: SpreadVehicle) -> Iterator[SpreadVehicle]:
    """Start a vehicle, and stop it whatever happens."""
    try:
        vehicle.start()
        yield vehicle
    finally:
        vehicle.stop()


def statuses(bag: Path) -> Iterator[tuple[float, Status]]:
    """Yield what the nodes said of themselves, and when [s]; the bag may still be written."""
    with contextlib.suppress(BagError):
        for message in read_messages(bag):
            if message.topic == '/diagnostics':
                said: Diagnostics = decode(message.type_name, message.data)
                yield from ((1e-9 * said.stamp, status) for status in said.statuses)
