"""The benchmark measures what it says: the same messages in every way."""

import pytest

from omni_vehicle_ros.bench import bags


def test_all_ways_read_the_same_messages(tmp_path):
    count = bags.write_bag(tmp_path / 'bag', 30)
    path = tmp_path / 'bag' / 'bag_0.mcap'
    assert bags.read_columns(path) == bags.decode_messages(path) == count
    assert bags.decompress(path) > 100 * count


def test_both_lines_are_of_one_measurement():
    told = []
    result = bags.bench(told.append, cycles=40, rounds=2)
    assert told == [0.0, 1 / 3, 2 / 3, 1.0]
    rate, cost = result.lines
    assert rate.ours * cost.ours == pytest.approx(1e6)
    assert min(figure for line in result.lines for figure in (line.ours, line.limit)) > 0.0


def test_without_the_other_decoder_its_line_says_so(monkeypatch):
    monkeypatch.setattr(bags, 'find_spec', lambda name: None)
    rate, cost = bags.bench(cycles=40, rounds=1).lines
    assert (rate.limit, rate.met) == (None, None) and 'not installed' in rate.note
    assert cost.met is not None
