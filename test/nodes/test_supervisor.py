"""What a node hears from who has started it."""

import os
import subprocess
import sys

from omni_vehicle_ros.ending import PARENT

NODE = """
from omni_vehicle_ros.nodes.supervisor import Supervisor

heard = []
supervisor = Supervisor(lambda role: heard.append(('died', role)), lambda role: heard.append(('without', role)))
supervisor.listen()
supervisor.say_ready('plant')
for _ in range({times}):
    while len(heard) < 3:
        supervisor.listen()
    supervisor.listen()
print(heard)
"""


def node(times: int, **environment: str) -> 'subprocess.Popen[bytes]':
    return subprocess.Popen(
        [sys.executable, '-c', NODE.format(times=times)], bufsize=0, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
        env={**{name: value for name, value in os.environ.items() if name != PARENT}, **environment},
    )


def test_whole_lines_are_heard_whatever_pieces_they_come_in() -> None:
    """Also after the end of who has started it."""
    with node(3, **{PARENT: str(os.getpid())}) as process:
        assert process.stdin is not None and process.stdout is not None
        assert process.stdout.readline() == b'ready plant\n'
        for piece in (b'died front_left/wheel_mod', b'ule\nwithout ', b'front_left/wheel_module\ndied driver\n'):
            process.stdin.write(piece)
        process.stdin.close()
        heard = [('died', 'front_left/wheel_module'), ('without', 'front_left/wheel_module'), ('died', 'driver')]
        assert process.stdout.read().decode() == f'{heard}\n'


def test_a_node_that_was_started_by_hand_neither_reads_nor_speaks() -> None:
    with node(0) as process:
        assert process.stdout is not None
        assert process.stdout.read() == b'[]\n'
