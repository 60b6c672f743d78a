"""Hosts are made and removed, also those of a process that was killed."""

import os
import signal
import subprocess
import sys
import textwrap

import pytest

from omni_vehicle_ros.bench.hosts.network import joined_hosts, refusal, remove_stale
from omni_vehicle_ros.errors import RunError

NAMES = ('one', 'two')

HOLDER = textwrap.dedent("""
    import subprocess, sys, time
    from omni_vehicle_ros.bench.hosts.network import joined_hosts

    with joined_hosts(('one', 'two')) as hosts:
        subprocess.Popen([*hosts.prefix('one'), 'sleep', '100'], stdout=subprocess.DEVNULL)
        print('up', flush=True)
        sys.stdin.read()
""")


@pytest.fixture(autouse=True)
def _allowed() -> None:
    why = refusal()
    if why:
        pytest.skip(why)


def spaces(process: int) -> list[str]:
    listed = subprocess.run(['ip', 'netns', 'list'], capture_output=True, text=True, check=True).stdout
    names = [line.split()[0] for line in listed.splitlines()]
    return [name for name in names if name.startswith(f'omni_hosts_{process}_')]


def test_hosts_reach_each_other_until_a_cable_is_cut() -> None:
    def reached() -> bool:
        words = 'import socket; socket.create_connection(("10.77.0.2", 9), 0.5)'
        done = subprocess.run(
            [*hosts.prefix('one'), sys.executable, '-I', '-S', '-c', words], capture_output=True, text=True, check=False
        )
        return 'refused' in done.stderr  # by the other host, which is there

    with joined_hosts(NAMES) as hosts:
        assert len(spaces(os.getpid())) == 2
        assert reached()
        hosts.cut('two')
        assert not reached()
        hosts.cut()
        assert reached()
    assert spaces(os.getpid()) == []


def test_what_fails_in_between_leaves_nothing() -> None:
    with pytest.raises(ZeroDivisionError), joined_hosts(NAMES) as hosts:
        process = subprocess.Popen([*hosts.prefix('two'), 'sleep', '100'])
        raise ZeroDivisionError
    assert process.wait(10.0) == -signal.SIGKILL
    assert spaces(os.getpid()) == []


def test_hosts_of_a_killed_process_are_removed_by_the_next() -> None:
    holder = subprocess.Popen([sys.executable, '-c', HOLDER], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    assert holder.stdout is not None
    assert holder.stdout.readline() == 'up\n'
    holder.kill()
    holder.communicate()
    assert len(spaces(holder.pid)) == 2
    remove_stale()
    assert spaces(holder.pid) == []


def test_who_may_not_make_hosts_is_told_why(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, 'geteuid', lambda: 1000)
    with pytest.raises(RunError, match='network namespaces need root'), joined_hosts(NAMES):
        pass
