"""The transform odom -> base_link is the pose in ``odom``; without tf2_msgs the node says so in one line."""

import math
import subprocess
import sys
from importlib.util import find_spec

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omni_vehicle_ros.messages import Odometry
from omni_vehicle_ros.nodes.odom_transform import transform

numbers = st.floats(-1e4, 1e4)


@settings(deadline=None)
@given(st.integers(0, 2**31 * 10**9 - 1), numbers, numbers, st.floats(-math.pi, math.pi), numbers, numbers)
def test_points_of_the_vehicle_land_where_it_is(stamp, x, y, heading, ahead, left):
    found = transform(Odometry(stamp, x, y, heading, 1.0, 2.0, 3.0))
    assert (found.header.frame_id, found.child_frame_id) == ('odom', 'base_link')
    assert found.header.stamp.sec * 10**9 + found.header.stamp.nanosec == stamp
    place, turn = found.transform.translation, found.transform.rotation
    assert (turn.x, turn.y, place.z) == (0.0, 0.0, 0.0)
    rotated = complex(turn.w, turn.z) ** 2 * complex(ahead, left)
    expected = complex(x, y) + complex(ahead, left) * complex(math.cos(heading), math.sin(heading))
    assert abs(complex(place.x, place.y) + rotated - expected) < 1e-9


@pytest.mark.graph
@pytest.mark.skipif(find_spec('tf2_msgs') is not None, reason='tf2_msgs is installed')
def test_without_tf2_msgs_it_says_so():
    command = [sys.executable, '-m', 'omni_vehicle_ros.executables', 'nodes.odom_transform']
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert (done.returncode, done.stderr.splitlines()) == (
        2, ['error: tf2_msgs is not installed; it comes with ROS 2 Jazzy, not from PyPI']
    )
