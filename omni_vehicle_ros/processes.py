"""Starts nodes as processes, and leaves none behind."""

import os
import selectors
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import IO

from omni_vehicle_ros.cores import CORE
from omni_vehicle_ros.ending import PARENT, hold_signals, release_signals
from omni_vehicle_ros.network import network_environment
from omni_vehicle_ros.shared_memory import remove, segments_of

BOOT = (
    'import sys; sys.path[:] = filter(None, sys.path); '
    'from omni_vehicle_ros.executables import main; main(sys.argv.pop(1))'
)
"""What Python runs: never a module that happens to lie in the current directory."""

STOP_LIMIT = 8.0

TICKS = os.sysconf('SC_CLK_TCK')
PAGE = os.sysconf('SC_PAGE_SIZE')


class Processes:
    """Processes by the role of what runs in them.

    Parameters
    ----------
    logs
        Directory for what they say on standard error, a file for each; must exist.
    """

    def __init__(self, logs: Path) -> None:
        self._logs = logs
        self._processes: dict[str, subprocess.Popen[bytes]] = {}
        self._selector = selectors.DefaultSelector()
        self._begun: dict[str, bytes] = {}
        self._segments: dict[int, set[str]] = {}

    def spawn(
        self, role: str, module: str, arguments: list[str], *, core: int | None = None, prefix: Sequence[str] = ()
    ) -> None:
        """Start the ``main`` of a module, in a session of its own: a Ctrl-C in the terminal is for us to pass on.

        It inherits held signals, and lets them through when it can handle them. In lock step it stays on ``core``.
        ``prefix`` are words before the command, of a program that becomes it. It takes the place of one of this role
        that has ended, and goes on with its log.
        """
        hold_signals()
        try:
            if role in self._processes:
                self._forget(self._processes[role])
            with self._log(role).open('ab') as log:
                process = subprocess.Popen(
                    [*prefix, sys.executable, '-c', BOOT, module, *arguments],
                    stdin=subprocess.PIPE,
                    stdout=subprocess.PIPE,
                    stderr=log,
                    env=node_environment(core),
                    start_new_session=True,
                    bufsize=0,
                )
            self._processes[role] = process
            assert process.stdout is not None
            os.set_blocking(process.stdout.fileno(), False)
            self._selector.register(process.stdout, selectors.EVENT_READ, role)
        finally:
            release_signals()

    def _forget(self, ended: 'subprocess.Popen[bytes]') -> None:
        """Listen no more to a process that has ended."""
        if ended.stdout is not None and ended.stdout in self._selector.get_map():
            self._selector.unregister(ended.stdout)
        _close(ended)

    def lines(self, timeout: float) -> list[str]:
        """Return the whole lines that were printed; wait for some for up to ``timeout`` [s]."""
        lines: list[str] = []
        for key, _ in self._selector.select(timeout):
            stream: IO[bytes] = key.fileobj  # type: ignore[assignment]
            data = stream.read()
            *whole, begun = (self._begun.pop(key.data, b'') + (data or b'')).split(b'\n')
            lines += [line.decode(errors='replace') for line in whole]
            if data:
                self._begun[key.data] = begun
            else:
                self._selector.unregister(stream)
        return lines

    def tell(self, *words: str) -> None:
        """Say a line to all, on their standard input."""
        line = f'{" ".join(words)}\n'.encode()
        for process in self._processes.values():
            assert process.stdin is not None
            with suppress(BrokenPipeError):
                process.stdin.write(line)

    def note_segments(self) -> None:
        """Note which shared memory belongs to each process, so that one that is killed leaves none."""
        for process in self._processes.values():
            if not self._segments.get(process.pid):
                self._segments[process.pid] = segments_of(process.pid)

    def ended(self) -> dict[str, int]:
        """Return the exit codes of those that have ended, by role."""
        codes = {role: process.poll() for role, process in self._processes.items()}
        return {role: code for role, code in codes.items() if code is not None}

    def last_words(self, role: str) -> str:
        """Return how a process ended: its code, and the last line of what it said, if it said something."""
        lines = self._log(role).read_text(errors='replace').splitlines()
        said = [line for line in lines if line.strip()]
        words = f': {said[-1].removeprefix("error: ")}' if said else ''
        return f'{role} ended with code {self._processes[role].returncode}{words}'

    def numbers(self) -> dict[str, int]:
        """Return the numbers by which the system knows the processes."""
        return {role: process.pid for role, process in self._processes.items()}

    def cpu_times(self) -> dict[str, float]:
        """Return the CPU time of each process until now, all its threads taken together [s]."""
        found = {}
        for role, process in self._processes.items():
            fields = _read(process.pid, 'stat').rpartition(')')[2].split()
            found[role] = sum(map(int, fields[11:13])) / TICKS if fields else 0.0
        return found

    def resident_sizes(self) -> dict[str, int]:
        """Return how much memory each process holds now [byte]."""
        sizes = {role: _read(process.pid, 'statm').split() for role, process in self._processes.items()}
        return {role: int(fields[1]) * PAGE if fields else 0 for role, fields in sizes.items()}

    def stop(self, last: str = '') -> list[str]:
        """Ask all to end, ``last`` when the others have; kill what does not. Return what they printed meanwhile."""
        others = [role for role in self._processes if role != last]
        for group in (others, [role for role in self._processes if role == last]):
            for role in group:
                if self._processes[role].poll() is None:
                    self._processes[role].send_signal(signal.SIGINT)
                    self._processes[role].send_signal(signal.SIGCONT)  # one that is frozen could not end
            until = time.monotonic() + STOP_LIMIT
            for role in group:
                _await(self._processes[role], until)
        for segments in self._segments.values():
            remove(segments)
        lines = self.lines(0.0)
        for process in self._processes.values():
            _close(process)
        self._selector.close()
        return lines

    def _log(self, role: str) -> Path:
        return self._logs / f'{role.replace("/", "_")}.log'


def _close(process: 'subprocess.Popen[bytes]') -> None:
    for stream in (process.stdin, process.stdout):
        if stream is not None:
            stream.close()


def _await(process: 'subprocess.Popen[bytes]', until: float) -> None:
    try:
        process.wait(max(until - time.monotonic(), 0.1))
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


def _read(number: int, name: str) -> str:
    """Return what the system says of a process; nothing if it has ended."""
    try:
        return Path(f'/proc/{number}/{name}').read_text(encoding='ascii', errors='replace')
    except OSError:
        return ''


def node_environment(core: int | None = None) -> dict[str, str]:
    """Return the environment of a node that ends with this process, and that may have a core to stay on."""
    place = {} if core is None else {CORE: str(core)}
    return {**network_environment(), PARENT: str(os.getpid()), **place}
