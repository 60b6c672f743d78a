"""A node that ``ros2 run`` starts goes by the profile of Fast DDS that comes with the package."""

import socket
import time

import pytest

from omni_vehicle_ros.network import PROFILE, QOS_FROM_PROFILE

from .conftest import LIMIT, Lab

pytestmark = pytest.mark.graph

NUMBER = 20
"""A participant that may be there; a node in the range LOCALHOST says hello to the first 32 of them."""
HELLOS = 10
"""More than the five at once that Fast DDS says by default, after which it waits for 3 s."""


def test_a_node_announces_itself_as_the_profile_says(lab: Lab) -> None:
    """By the profile the tenth announcement comes after 0.5 s, by default after more than 12 s.

    The port is that of section 9.6.1.1 of the RTPS specification.
    """
    for name in (PROFILE, QOS_FROM_PROFILE):
        lab.environment.pop(name, None)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as ear:
        ear.bind(('127.0.0.1', 7400 + 250 * int(lab.environment['ROS_DOMAIN_ID']) + 10 + 2 * NUMBER))
        ear.settimeout(LIMIT)
        node = lab.node('icr_steering')
        times = []
        for _ in range(HELLOS):
            assert ear.recv(65536).startswith(b'RTPS')
            times.append(time.monotonic())
    node.terminate()
    node.communicate()
    assert times[-1] - times[0] < 6.0
