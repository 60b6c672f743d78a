"""How controllers are judged: the commanded path is exact, and a distance to it is the shortest one."""

import math
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omni_vehicle_ros.bags.memory import MemoryWriter
from omni_vehicle_ros.interface import TOPICS
from omni_vehicle_ros.messages import Odometry, Twist, encode
from omni_vehicle_ros.scenarios import load_scenario
from omni_vehicle_ros.thesis.manoeuvres import CONTROLLERS, MANOEUVRES, commanded_path, distances

ROWS = {row.name: row for row in TOPICS}


def commanded(vx: float, vy: float, yaw_rate: float, cycles: int, period: float = 0.005):
    """Return a bag that holds one commanded twist for some cycles."""
    writer = MemoryWriter()
    for topic in ('odom', 'commanded_twist'):
        writer.add_topic(f'/{topic}', ROWS[topic].type, ROWS[topic].qos)
    for cycle in range(cycles + 1):
        stamp = round(cycle * period * 1e9)
        writer.write('/commanded_twist', encode(ROWS['commanded_twist'].type, Twist(stamp, vx, vy, yaw_rate)), stamp)
        odom = Odometry(stamp, 2.0, -1.0, 0.7, 0.0, 0.0, 0.0)
        writer.write('/odom', encode(ROWS['odom'].type, odom), stamp)
    return writer.bag('test')


@given(
    vx=st.floats(0.5, 20.0), vy=st.floats(-5.0, 5.0), yaw_rate=st.floats(-2.0, 2.0).filter(lambda r: abs(r) > 0.01)
)
@settings(max_examples=30, deadline=None)
def test_a_held_twist_draws_a_circle(vx: float, vy: float, yaw_rate: float) -> None:
    """All corners but the last lie on the circle about the centre of rotation; the last is straight ahead."""
    path = commanded_path(commanded(vx, vy, yaw_rate, 200))
    cos, sin = math.cos(0.7), math.sin(0.7)
    along, across = -vy / yaw_rate, vx / yaw_rate
    centre = np.array([2.0 + along * cos - across * sin, -1.0 + along * sin + across * cos])
    radius = math.hypot(vx, vy) / abs(yaw_rate)
    assert np.hypot(*(path[:-1] - centre).T) == pytest.approx(radius, rel=1e-9)
    swept = path[-2] - centre
    angle = math.atan2(swept[1], swept[0]) - math.atan2(*(path[0] - centre)[::-1])
    assert math.remainder(angle - yaw_rate, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-9)
    assert np.hypot(*(path[-1] - path[-2])) == pytest.approx(10.0)


def test_a_straight_command_draws_a_straight_line() -> None:
    """Without yaw rate the path is the line ahead."""
    path = commanded_path(commanded(4.0, 0.0, 0.0, 100))
    expected = np.array([2.0, -1.0]) + 2.0 * np.array([math.cos(0.7), math.sin(0.7)])
    assert path[-2] == pytest.approx(expected, abs=1e-12)


@given(st.lists(st.tuples(st.floats(-9.0, 9.0), st.floats(-9.0, 9.0)), min_size=2, max_size=6), st.floats(-9.0, 9.0))
@settings(max_examples=50, deadline=None)
def test_a_distance_is_the_shortest_one(corners: list[tuple[float, float]], x: float) -> None:
    """No place among many on the path is nearer than the distance, and one is nearly as near."""
    path, point = np.array(corners), np.array([[x, 0.5]])
    distance = float(distances(point, path)[0])
    shares = np.linspace(0.0, 1.0, 401)[:, np.newaxis]
    places = np.concatenate([a + shares * (b - a) for a, b in pairwise(path)])
    nearest = float(np.min(np.hypot(*(places - point).T)))
    assert distance <= nearest + 1e-9
    assert nearest - distance < 26.0 / 400.0


def test_every_trial_loads() -> None:
    """Names and settings of manoeuvres and controllers are those of scenarios and parameters."""
    for manoeuvre in MANOEUVRES:
        for controller in CONTROLLERS:
            assert load_scenario(manoeuvre.scenario, controller.settings).duration >= manoeuvre.end
    assert Path(MANOEUVRES[0].scenario).parts[0] == 'manoeuvres'
