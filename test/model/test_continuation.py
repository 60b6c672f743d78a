"""Following a curve, on curves that are known."""

import math
from itertools import islice

import numpy as np
import pytest

from omni_vehicle_ros.model.continuation import CORNER, Curve

PLANE = np.ones(2)


def circle(place):
    return np.array([place @ place - 1.0])


def s_curve(place):
    """Two folds, at y = -+1 / sqrt(3)."""
    parameter, y = place
    return np.array([parameter - y**3 + y])


def test_a_circle_is_followed_round_both_folds_and_closes():
    curve = Curve(circle, PLANE)
    start = curve.at(np.array([0.0, -0.9]))
    angles = np.unwrap([math.atan2(point.place[1], point.place[0]) for point in islice(curve.follow(start, 0.05), 200)])
    points = [start, *islice(curve.follow(start, 0.05), 200)]
    assert all(abs(np.hypot(*point.place) - 1.0) <= 1e-10 for point in points)
    assert np.all(np.diff(angles) > 0.0)
    assert angles[-1] - angles[0] > 2.0 * math.pi
    for point in points:
        assert point.tangent @ point.place == pytest.approx(0.0, abs=1e-6)
        assert point.tangent @ point.tangent == pytest.approx(1.0)


def test_a_fold_is_found_where_the_parameter_turns_back():
    curve = Curve(s_curve, PLANE)
    before = curve.at(np.array([-1.0, -1.3]))
    for after in curve.follow(before, 0.1):
        if after.tangent[0] <= 0.0:
            break
        before = after
    inside, outside = curve.border(before, after, lambda point: point.tangent[0] > 0.0)
    fold = -1.0 / math.sqrt(3.0)
    for point in (inside, outside):
        assert point.place[1] == pytest.approx(fold, abs=1e-6)
        assert point.place[0] == pytest.approx(fold**3 - fold, abs=1e-12)
    assert inside.tangent[0] > 0.0 >= outside.tangent[0]


def test_a_trace_holds_every_fold_and_finds_every_crossing():
    """y**3 - y = level has three roots between the folds, one beyond them; at 0 they are -1, 0 and 1."""
    curve = Curve(s_curve, PLANE)
    points = curve.trace(curve.at(np.array([-1.0, -1.3])), 0.1, lambda point: point.place[0] < 1.0)
    fold = 2.0 / 3.0 ** 1.5
    rises = np.sign([point.tangent[0] for point in points])
    turns = np.flatnonzero(np.diff(rises))
    assert [points[i].place[0] for i in turns] == pytest.approx([fold, -fold], abs=1e-9)
    for level in (-0.8, -0.3, 0.0, 0.99 * fold, 0.7):
        expected = [root.real for root in np.roots([1.0, 0.0, -1.0, -level]) if abs(root.imag) < 1e-9]
        found = [point.place[1] for point in curve.crossings(points, level)]
        assert found == sorted(found)
        assert found == pytest.approx(sorted(expected), abs=1e-9)


def test_next_to_a_fold_both_crossings_are_found():
    curve = Curve(s_curve, PLANE)
    points = curve.trace(curve.at(np.array([-1.0, -1.3])), 0.1, lambda point: point.place[0] < 1.0)
    for distance in (1e-4, 1e-6):
        found = [point.place[1] for point in curve.crossings(points, 2.0 / 3.0 ** 1.5 - distance)]
        # Near the fold level = top - sqrt(3) (y - fold)**2.
        assert found[1] - found[0] == pytest.approx(2.0 * math.sqrt(distance / math.sqrt(3.0)), rel=0.01)


def test_a_corner_is_passed():
    curve = Curve(lambda place: np.array([place[1] - 0.4 * abs(place[0])]), PLANE)
    points = list(islice(curve.follow(curve.at(np.array([-0.305, 0.1])), 0.1), 60))
    assert points[-1].place[0] > 0.1
    # Beside the corner a difference quotient sees both of its sides, and Newton's method is not as good.
    assert all(abs(point.place[1] - 0.4 * abs(point.place[0])) < 1e-7 for point in points)
    assert min(abs(point.place[0]) for point in points) < CORNER


def test_an_unknown_without_weight_does_not_shorten_the_steps():
    """The last unknown only follows the others, however wildly."""

    def equations(place):
        parameter, y, follower = place
        return np.array([y - parameter, follower - math.sin(30.0 * parameter)])

    def count(weights):
        curve = Curve(equations, np.array(weights))
        for number, point in enumerate(curve.follow(curve.at(np.zeros(3)), 0.2)):
            assert point.place[2] == pytest.approx(math.sin(30.0 * point.place[0]), abs=1e-9)
            if point.place[0] > 2.0:
                return number
        return None

    assert count((1.0, 1.0, 0.0)) < 25 < 60 < count((1.0, 1.0, 1.0))


def test_where_there_is_no_solution_there_is_none():
    curve = Curve(lambda place: np.array([place[1] ** 2 + place[0]]), PLANE)
    assert curve.at(np.array([0.5, 0.3])) is None
    assert curve.at(np.array([-0.25, 0.3])).place == pytest.approx([-0.25, 0.5])
    assert curve.at(np.array([-0.25, 0.0])) is None  # level there: no direction to go
