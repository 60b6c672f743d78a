"""Hosts on one machine: network namespaces of Linux, each with a TAP device that a `Switch` in this process joins."""

import contextlib
import fcntl
import os
import shutil
import signal
import struct
import subprocess
from collections.abc import Iterator, Sequence
from itertools import count
from pathlib import Path

from omni_vehicle_ros.bench.hosts.switch import Switch
from omni_vehicle_ros.errors import RunError

PREFIX = 'omni_hosts'
"""Names of namespaces are this, the process that made them, and two numbers."""
TUN = Path('/dev/net/tun')
SET_INTERFACE = 0x400454CA
"""TUNSETIFF of linux/if_tun.h."""
TAP, NO_PACKET_INFORMATION = 0x0002, 0x1000
SUBNET = '10.77.0'

_numbers = count()


class Hosts:
    """Hosts by name, joined by a switch; see `joined_hosts`.

    Attributes
    ----------
    switch
        Between them.
    """

    def __init__(self, spaces: dict[str, str], ports: dict[str, int], switch: Switch) -> None:
        self.switch = switch
        self._spaces, self._ports = spaces, ports

    def prefix(self, host: str) -> list[str]:
        """Return the words before a command that make it run on a host; the process stays the same."""
        return ['ip', 'netns', 'exec', self._spaces[host]]

    def cut(self, *hosts: str) -> None:
        """Pull the cables of these hosts, and plug in those of all others."""
        self.switch.cut = frozenset(self._ports[host] for host in hosts)

    def kill(self, host: str) -> None:
        """Have a host lose its power: cable and processes at once."""
        self.switch.cut |= {self._ports[host]}
        _kill_processes(self._spaces[host])


@contextlib.contextmanager
def joined_hosts(names: Sequence[str]) -> Iterator[Hosts]:
    """Make hosts 10.77.0.1, 10.77.0.2, ... and remove them with all that runs on them, whatever happens.

    What a killed process has left behind is removed first.

    Raises
    ------
    RunError
        Network namespaces can't be made here; says why.
    """
    why = refusal()
    if why:
        raise RunError(why)
    remove_stale()
    turn = next(_numbers)
    spaces = {name: f'{PREFIX}_{os.getpid()}_{turn}_{number}' for number, name in enumerate(names)}
    with contextlib.ExitStack() as stack:
        ports = {}
        for number, (name, space) in enumerate(spaces.items(), 1):
            _ip('netns', 'add', space)
            stack.callback(_remove, space)
            ports[name] = _plug(space, f'{SUBNET}.{number}/24', f'omni{os.getpid()}_{number}')
            stack.callback(os.close, ports[name])
        switch = Switch(tuple(ports.values()))
        switch.start()
        stack.callback(switch.close)
        yield Hosts(spaces, ports, switch)


def refusal() -> str:
    """Return why hosts can't be made here, or nothing if they can."""
    if os.geteuid() != 0:
        return 'network namespaces need root'
    if shutil.which('ip') is None:
        return 'network namespaces need ip: install iproute2'
    if not os.access(TUN, os.R_OK | os.W_OK):
        return f'TAP devices need {TUN}: load the kernel module tun'
    space = f'{PREFIX}_{os.getpid()}_trial'
    try:
        _ip('netns', 'add', space)
        try:
            os.close(_plug(space, f'{SUBNET}.1/24', f'omni{os.getpid()}_t'))
        finally:
            _remove(space)
    except (RunError, OSError) as error:
        return f'no network namespaces with TAP devices here: {error}'
    return ''


def remove_stale() -> None:
    """Remove the hosts of processes that are gone."""
    for line in _ip('netns', 'list').splitlines():
        space = line.split()[0]
        if space.startswith(f'{PREFIX}_') and not Path('/proc', space.split('_')[2]).exists():
            _remove(space)


def _plug(space: str, address: str, device: str) -> int:
    """Make a TAP device, put it into a namespace as eth0, and return its end for the switch.

    The device lives as long as that end is open.
    """
    port = os.open(TUN, os.O_RDWR | os.O_NONBLOCK | os.O_CLOEXEC)
    try:
        fcntl.ioctl(port, SET_INTERFACE, struct.pack('16sH22x', device.encode(), TAP | NO_PACKET_INFORMATION))
        _ip('link', 'set', device, 'netns', space, 'name', 'eth0')
        _ip('-n', space, 'address', 'add', address, 'dev', 'eth0')
        for name in ('lo', 'eth0'):
            _ip('-n', space, 'link', 'set', name, 'up')
    except BaseException:
        os.close(port)
        raise
    return port


def _remove(space: str) -> None:
    """End what runs in a namespace, and remove it."""
    with contextlib.suppress(RunError):
        _kill_processes(space)
    with contextlib.suppress(RunError):
        _ip('netns', 'delete', space)


def _kill_processes(space: str) -> None:
    for number in _ip('netns', 'pids', space).split():
        with contextlib.suppress(ProcessLookupError):
            os.kill(int(number), signal.SIGKILL)


def _ip(*words: str) -> str:
    done = subprocess.run(['ip', *words], capture_output=True, text=True, check=False)
    if done.returncode:
        raise RunError(f'ip {" ".join(words)}: {done.stderr.strip() or done.returncode}')
    return done.stdout
