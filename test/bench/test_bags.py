"""The benchmark measures what it says: the same messages in every way."""

import pytest

from omni_vehicle_ros.bench import bags


def test_all_ways_read_the_same_messages(tmp_path):
    count = bags.write_bag(tmp_path / 'bag', 30)
    path = tmp_path / 'bag' / 'bag_0.mcap'
    assert bags.read_columns(path) == bags.decode_messages(path) == count
    assert bags.decompress(path) > 100 * count


def test_a_result_has_rates_and_their_ratios():
    told = []
    result = bags.bench(told.append, cycles=40, rounds=2)
    assert told == [0, 1, 2]
    found = result.as_json()
    assert found['columns_per_decoder'] == pytest.approx(found['columns']['rate'] / found['decoder']['rate'])
    assert min(found[way][rate] for way in ('columns', 'decoder', 'decompress') for rate in ('rate', 'wall_rate')) > 0.0
    assert len(result.lines) == 6
