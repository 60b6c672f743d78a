"""The benchmark of the graph: it counts real cycles of real nodes, and leaves nothing behind."""

import json
import signal
from pathlib import Path

import pytest

from .conftest import Lab, finish, until

pytestmark = pytest.mark.graph

MEASURE = """
import json
from functools import partial

from omni_vehicle_ros.bench import graph

chains = partial(graph.bare_chain, True), partial(graph.our_graph, graph.SEVEN, True)
print(json.dumps([graph.cycle_time(chain, 0.1, {}) for chain in chains]))
"""


def test_cycles_are_counted_and_cost_what_a_core_gives(lab: Lab) -> None:
    """One process each: its CPU time is no more than the wall time of some threads, and ours takes less of it."""
    script = lab.path / 'measure.py'
    script.write_text(MEASURE)
    out, _ = finish(lab.start(str(script)))
    bare, ours = json.loads(out)
    for wall, cpu in (bare, ours):
        assert 0.0 < cpu < 2.0 * wall < 2.0
    assert ours[1] < bare[1]
    assert not lab.left()


def test_an_interrupted_benchmark_leaves_nothing(lab: Lab) -> None:
    """Neither a process nor a file nor a segment of shared memory."""
    folder = lab.path / 'tmp'
    folder.mkdir()
    command = lab.start(
        '-m', 'omni_vehicle_ros.executables', 'cli', 'bench', 'graph', environment={'TMPDIR': str(folder)}
    )
    until(lambda: len(segments(lab)) >= 8, 'seven nodes and the watch to be up')
    used = segments(lab)
    command.send_signal(signal.SIGINT)
    _, errors = finish(command, 128 + signal.SIGINT)
    assert 'interrupted' in errors
    assert not lab.left()
    assert not list(folder.iterdir())
    assert not [path for path in used if path.exists()]


def segments(lab: Lab) -> set[Path]:
    """Return the shared memory of Fast DDS that the processes of a lab made; its ports are shared with any other."""
    found = set()
    for number in lab.left():
        try:
            maps = Path(f'/proc/{number}/maps').read_text()
        except OSError:
            continue
        names = (line.split()[-1] for line in maps.splitlines() if '/dev/shm/fastrtps_' in line)
        found |= {Path(name) for name in names if 'port' not in name}
    return found
