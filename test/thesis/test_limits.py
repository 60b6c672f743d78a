"""Where steady turns end: in words, and in the figures that have a gap there."""

from typing import Any

import numpy as np
import pytest

from omni_vehicle_ros.analysis.style import house_style
from omni_vehicle_ros.model.steady_turn import Limit, steady_turns
from omni_vehicle_ros.parameters import VehicleParameters
from omni_vehicle_ros.thesis.limits import RADII, TASKS, LimitPaths, LimitTurns, rows
from omni_vehicle_ros.thesis.registry import FIGURES
from omni_vehicle_ros.thesis.steady import SlipMap, SlipMapTask
from omni_vehicle_ros.thesis.tasks import Results, Task, run


def test_paths_are_those_of_the_turns_at_these_speeds() -> None:
    tight, wide = LimitPaths(run('turning_map'), (5.0, 9.0), 40.0).work()
    branches = [steady_turns(VehicleParameters(), radius) for radius in (5.0, 9.0)]
    speeds = tight.limit.speed, wide.limit.grip_speed, wide.limit.slide_speed
    found = tight.at_limit, wide.at_most_grip, wide.at_slide
    for branch, speed, radius in zip((branches[0], branches[1], branches[1]), speeds, found, strict=True):
        assert speed is not None
        turn = branch.turn(speed)
        assert turn is not None
        assert radius == pytest.approx(turn.path_radius, rel=1e-3)  # at a fold it goes with the root of the speed
    assert (tight.at_most_grip, tight.at_slide, wide.at_limit) == (None, None, None)


def test_a_turn_that_only_runs_wide_is_not_lost() -> None:
    lost = LimitTurns(Limit(5.0, 'fold', None, None), 6.0, None, None)
    wide = LimitTurns(Limit(None, None, 10.0, 20.0), None, 15.0, 42.0)
    first, *_, last = rows(Results({task: (lost,) * (len(RADII) - 1) + (wide,) for task in TASKS}))
    assert first.radius == '2 m'
    assert first.limits[0] == '18 km/h (path 6 m): the steady turn that slow driving leads to ends'
    assert last.limits[0] == (
        'none up to 144 km/h; from 36 km/h (path 15 m) on it only runs wide; from 72 km/h (path 42 m) on both tyres of '
        'an axle slide'
    )


@pytest.mark.parametrize('gaps', [(3, 2), (2, 3), (4, 4), (0, 0)])
def test_the_shade_past_the_limit_ends_where_the_first_line_begins(gaps: tuple[int, int]) -> None:
    found: dict[Task[Any], SlipMap] = {}
    for task, gap in zip(FIGURES['4.42'].needs, gaps, strict=True):
        assert isinstance(task, SlipMapTask)
        radius = np.array(task.radii)
        slip = np.tile((0.1 / radius)[:, np.newaxis, np.newaxis], (1, len(task.speeds), 4))
        slip[:gap] = np.nan
        found[task] = SlipMap(radius, np.array(task.speeds), slip, radius, np.empty((0, 0)), np.empty((0, 0, 4)))
    with house_style():
        picture = FIGURES['4.42'].draw(Results(found))
    shades = picture.figure.axes[0].patches
    ends = [shade.get_extents().transformed(picture.figure.axes[0].transData.inverted()).x1 for shade in shades]
    radii, *columns = picture.table.values()
    begin = min(float(radii[np.isfinite(column)][0]) for column in columns)
    assert ends == ([pytest.approx(begin)] if min(gaps) else [])
