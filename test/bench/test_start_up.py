"""Commands that drive nothing start without what driving needs."""

import subprocess
import sys

import pytest

from omni_vehicle_ros.bench.start_up import FIRST_STEP, started

RUN = """
import sys
from omni_vehicle_ros.cli import main
try:
    main()
except SystemExit as end:
    print(end.code, sorted({'numba', 'rclpy', 'scipy', 'matplotlib', 'pyarrow'} & set(sys.modules)))
"""


@pytest.mark.parametrize(
    'arguments', [('--help',), ('--version',), ('run', '--help'), ('bench', '--help'), ('scenarios',)], ids=' '.join
)
def test_no_numba_is_imported_to_help(arguments):
    found = subprocess.run([sys.executable, '-c', RUN, *arguments], capture_output=True, text=True, check=True)
    assert found.stdout.splitlines()[-1] == '0 []'


def test_the_time_of_a_start_is_that_of_its_process():
    work = "import time\nwhile time.process_time() < 0.3:\n    pass\n"
    found = started(('-c', work))
    assert 0.3 <= found.cpu <= found.wall + 0.05
    assert started(FIRST_STEP).cpu > 0.0
