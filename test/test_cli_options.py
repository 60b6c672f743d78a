"""What the commands share."""

import re
from pathlib import Path

from omni_vehicle_ros.cli.options import results_directory


def test_results_go_where_the_user_says_or_into_a_new_directory() -> None:
    assert results_directory(Path('here'), 'demo') == Path('here')
    assert re.fullmatch(r'runs/demo-\d{8}-\d{6}', str(results_directory(None, 'demo')))
