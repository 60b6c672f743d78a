"""What is made of the bag of a drive."""

import numpy as np
import pytest

from omni_vehicle_ros.bench.hosts.cases import complaints, counted, distances
from omni_vehicle_ros.messages import Status


def test_only_what_was_counted_between_the_first_and_the_last_word_counts() -> None:
    counts = (('/plant', 100, 40), ('/other', 900, 900), ('/plant', 150, 41), ('/plant', 300, 43))
    said = [Status(0, name, '', (('cycles', str(all_)), ('missed', str(missed)))) for name, all_, missed in counts]
    assert counted(said) == (200, 3)


def test_what_is_wrong_is_named_once_with_its_wheel_if_it_is_but_one() -> None:
    said = [
        Status(0, '/plant', 'driving'),
        Status(2, '/plant', 'no answer from rear_left/wheel_module: no torque, steer angle held'),
        Status(1, '/front_left/wheel_module', 'front_left/trim comes twice'),
        Status(2, '/front_right/wheel_module', 'no command for module_timeout, 0.1 s; front_right/trim comes twice'),
    ]
    assert complaints(said) == (
        'plant: no answer from rear_left/wheel_module',
        '<wheel>/wheel_module: <wheel>/trim comes twice',
        'front_right/wheel_module: no command for module_timeout',
    )
    late = [
        Status(1, '/plant: punctuality', f'{missed} of 201 cycles of 5 ms were missed in the last second')
        for missed in (17, 3)
    ]
    assert complaints(late) == ('plant: punctuality: cycles of 5 ms were missed in the last second',)
    assert complaints([Status(2, '/plant', 'no answer from rear_left/state, rear_right/state: no torque')]) == (
        'plant: no answer from <wheel>/state',
    )


def test_distances_are_those_to_the_nearest_point() -> None:
    """Of a circle sampled at 1 mm, points inside and outside are as far as their radius says."""
    angle = np.arange(0.0, 2.0 * np.pi, 1e-4)
    circle = 10.0 * np.column_stack([np.cos(angle), np.sin(angle)])
    found = distances(np.array([[9.5, 0.0], [0.0, 11.0], [-10.0, 0.0]]), circle)
    assert found == pytest.approx([0.5, 1.0, 0.0], abs=1e-3)
