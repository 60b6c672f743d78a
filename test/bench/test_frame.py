"""Figures beside their bare limits: ratios, goals, medians, words."""

import json
import math

import pytest

from omni_vehicle_ros.bench.frame import CALIBRATION, Line, Result, Time, at_least, at_most, interleaved


@pytest.mark.parametrize(
    ('goal', 'ours', 'met'),
    [(at_most(1.1), 1.1, True), (at_most(1.1), 1.2, False), (at_least(4.0), 4.0, True), (at_least(4.0), 3.9, False)],
)
def test_a_goal_holds_for_the_ratio(goal, ours, met):
    line = Line('step', 'us', 10.0 * ours, 10.0, 'C', goal)
    assert (line.ratio, line.met) == (ours, met)
    assert ('met' in line.text) is met and ('MISSED' in line.text) is not met


def test_what_could_not_be_measured_is_neither_met_nor_missed():
    line = Line('step', 'us', 1.0, None, 'C', at_most(1.1), 'no C compiler')
    assert (line.ratio, line.met) == (None, None)
    assert line.text == 'step: 1 us, C not measured, goal at most 1.1 (no C compiler)'


def test_works_take_turns_and_the_first_round_does_not_count():
    turns, told = [], []
    times = iter([Time(100.0, 100.0), Time(1.0, 5.0), Time(3.0, 2.0), Time(2.0, 9.0)])

    def one():
        turns.append('one')
        return next(times)

    found = interleaved({'one': one, 'two': lambda: turns.append('two')}, told.append, rounds=3)
    assert turns == ['one', 'two'] * 4
    assert found['one'] == Time(wall=2.0, cpu=5.0)
    assert found[CALIBRATION].cpu > 0.0
    assert told == sorted(told) and told[-1] == 1.0


def test_a_result_is_json():
    result = Result((Line('step', 'us', 3.0, 2.0, 'C', at_most(1.6)),), Time(0.2, 0.1), ('a note',))
    (line,) = json.loads(json.dumps(result.as_json()))['lines']
    assert math.isclose(line['ratio'], 1.5) and line['met'] is True and line['goal'] == 'at most 1.6'
    assert result.text[0] == 'a note' and result.text[-1].endswith('wall/CPU 2.00')
