"""What the environment of a node says of the network, unless the user has said otherwise."""

import os

from omni_vehicle_ros.share import config_directory

PROFILE, QOS_FROM_PROFILE = 'FASTRTPS_DEFAULT_PROFILES_FILE', 'RMW_FASTRTPS_USE_QOS_FROM_XML'
DISCOVERY_RANGE = 'ROS_AUTOMATIC_DISCOVERY_RANGE'


def network_environment() -> dict[str, str]:
    """Return the environment of nodes that stay on this machine."""
    environment = {**os.environ, **profile_environment()}
    environment.setdefault(DISCOVERY_RANGE, 'LOCALHOST')
    return environment


def profile_environment() -> dict[str, str]:
    """Return what has Fast DDS go by our profile; nothing if the user has chosen. Other middlewares do not read it.

    Fast DDS reads it when the first node of a process is made.
    """
    if {PROFILE, QOS_FROM_PROFILE} & os.environ.keys():
        return {}
    return {PROFILE: str(config_directory() / 'fastdds.xml'), QOS_FROM_PROFILE: '1'}
