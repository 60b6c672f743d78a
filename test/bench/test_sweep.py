"""The benchmark of sweeps measures turns: as many in both ways."""

from omni_vehicle_ros.bench import sweep


def test_both_ways_take_the_same_turns():
    told = []
    result = sweep.bench(told.append, turns=4, duration=0.05, rounds=2)
    assert told[-1] == 1.0
    assert len(result.lines) == 2 and all(line.ours > 0.0 and line.limit > line.ours for line in result.lines)
    assert 'a million in' in result.text[1]
