"""The ``metadata.yaml`` of a bag directory, version 9, as rosbag2 of ROS 2 Jazzy writes it."""

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import yaml

from omni_vehicle_ros.interface import Qos

FILE_NAME = 'metadata.yaml'
VERSION = 9
ROOT = 'rosbag2_bagfile_information'

_INFINITE = {'sec': 9223372036, 'nsec': 854775807}


class TopicRecord(NamedTuple):
    """A topic, and how many of its messages lie in the bag."""

    name: str
    type_name: str
    type_hash: str
    qos: Qos
    message_count: int


def qos_profiles(qos: Qos) -> list[dict[str, Any]]:
    """Return the offered quality of service in rosbag2's words."""
    return [
        {
            'history': 'keep_last',
            'depth': qos.depth,
            'reliability': 'reliable',
            'durability': 'transient_local' if qos.latched else 'volatile',
            'deadline': dict(_INFINITE),
            'lifespan': dict(_INFINITE),
            'liveliness': 'automatic',
            'liveliness_lease_duration': dict(_INFINITE),
            'avoid_ros_namespace_conventions': False,
        }
    ]


def bag_information(
    file_name: str, topics: Sequence[TopicRecord], span: tuple[int, int], custom: Mapping[str, str]
) -> dict[str, Any]:
    """Return the content of ``metadata.yaml`` below its root.

    Parameters
    ----------
    file_name
        The only file of the bag.
    topics
        What lies in it.
    span
        Log times of the first and the last message [ns].
    custom
        Any words of the user.
    """
    count = sum(topic.message_count for topic in topics)
    starting_time = {'nanoseconds_since_epoch': span[0]}
    duration = {'nanoseconds': span[1] - span[0]}
    return {
        'version': VERSION,
        'storage_identifier': 'mcap',
        'duration': duration,
        'starting_time': starting_time,
        'message_count': count,
        'topics_with_message_count': [_topic_entry(topic) for topic in topics],
        'compression_format': '',
        'compression_mode': '',
        'relative_file_paths': [file_name],
        'files': [
            {'path': file_name, 'starting_time': starting_time, 'duration': duration, 'message_count': count},
        ],
        'custom_data': dict(custom),
        'ros_distro': 'jazzy',
    }


def _topic_entry(topic: TopicRecord) -> dict[str, Any]:
    return {
        'topic_metadata': {
            'name': topic.name,
            'type': topic.type_name,
            'serialization_format': 'cdr',
            'offered_qos_profiles': qos_profiles(topic.qos),
            'type_description_hash': topic.type_hash,
        },
        'message_count': topic.message_count,
    }


class _Dumper(yaml.SafeDumper):
    """Writes values that occur twice twice: YAML's anchors would puzzle simple readers."""

    def ignore_aliases(self, data: Any) -> bool:
        return True


def as_yaml(content: Any) -> str:
    """Return YAML text."""
    return yaml.dump(content, Dumper=_Dumper, sort_keys=False)


def write_metadata(directory: Path, information: Mapping[str, Any]) -> None:
    """Write ``metadata.yaml``: at every moment the file is absent, the old one or the new one.

    Raises
    ------
    OSError
        It can't be written; the old one stays.
    """
    temporary = directory / f'.{FILE_NAME}.tmp'
    try:
        temporary.write_text(as_yaml({ROOT: information}), encoding='utf-8')
        os.replace(temporary, directory / FILE_NAME)
    finally:
        temporary.unlink(missing_ok=True)
