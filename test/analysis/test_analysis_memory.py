"""Memory does not grow with the bag; the same was shown with 2 GB, by `large_bag.py`."""

import importlib.util
from pathlib import Path

import pytest

_spec = importlib.util.spec_from_file_location('large_bag', Path(__file__).parent / 'large_bag.py')
assert _spec is not None and _spec.loader is not None
large_bag = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(large_bag)


@pytest.mark.slow
def test_four_times_the_bag_takes_no_more_memory(tmp_path: Path) -> None:
    used = []
    for size in (30e6, 120e6):
        directory = tmp_path / f'{size:.0f}'
        large_bag.write_large_bag(directory, round(size))
        used.append(large_bag.analysed(directory, tmp_path / f'out{size:.0f}'))
    assert used[1] - used[0] < 12
