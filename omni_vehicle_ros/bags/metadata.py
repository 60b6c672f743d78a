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
SECOND = 1_000_000_000

INFINITE = 2**63 - 1
"""A duration without end, as rosbag2 writes it [ns]."""


class OfferedQos(NamedTuple):
    """The quality of service that one publisher offers, in rosbag2's words; durations in ns."""

    history: str = 'keep_last'
    depth: int = 10
    reliability: str = 'reliable'
    durability: str = 'volatile'
    deadline: int = INFINITE
    lifespan: int = INFINITE
    liveliness: str = 'automatic'
    liveliness_lease_duration: int = INFINITE
    avoid_ros_namespace_conventions: bool = False


class TopicRecord(NamedTuple):
    """A topic, and how many of its messages lie in the bag."""

    name: str
    type_name: str
    type_hash: str
    offers: tuple[OfferedQos, ...]
    """One for each publisher."""
    message_count: int


class FileRecord(NamedTuple):
    """A file of a bag."""

    name: str
    span: tuple[int, int]
    """Log times of its first and its last message [ns]."""
    message_count: int


def offer(qos: Qos) -> OfferedQos:
    """Return what a publisher of the wiring table offers."""
    return OfferedQos(depth=qos.depth, durability='transient_local' if qos.latched else 'volatile')


def qos_profiles(offers: Sequence[OfferedQos]) -> list[dict[str, Any]]:
    """Return the offered qualities of service as rosbag2 writes them."""
    return [{name: _plain(name, value) for name, value in entry._asdict().items()} for entry in offers]


def _plain(name: str, value: Any) -> Any:
    if name in ('deadline', 'lifespan', 'liveliness_lease_duration'):
        seconds, nanoseconds = divmod(value, SECOND)
        return {'sec': seconds, 'nsec': nanoseconds}
    return value


def bag_information(
    files: Sequence[FileRecord], topics: Sequence[TopicRecord], custom: Mapping[str, str]
) -> dict[str, Any]:
    """Return the content of ``metadata.yaml`` below its root.

    Parameters
    ----------
    files
        The files of the bag, in the order of recording.
    topics
        What lies in them.
    custom
        Any words of the user.
    """
    spans = [file.span for file in files if file.message_count] or [(0, 0)]
    begin, end = min(span[0] for span in spans), max(span[1] for span in spans)
    return {
        'version': VERSION,
        'storage_identifier': 'mcap',
        **_time_entry((begin, end), sum(file.message_count for file in files)),
        'topics_with_message_count': [_topic_entry(topic) for topic in topics],
        'compression_format': '',
        'compression_mode': '',
        'relative_file_paths': [file.name for file in files],
        'files': [{'path': file.name, **_time_entry(file.span, file.message_count)} for file in files],
        'custom_data': dict(custom),
        'ros_distro': 'jazzy',
    }


def _time_entry(span: tuple[int, int], count: int) -> dict[str, Any]:
    return {
        'duration': {'nanoseconds': span[1] - span[0]},
        'starting_time': {'nanoseconds_since_epoch': span[0]},
        'message_count': count,
    }


def _topic_entry(topic: TopicRecord) -> dict[str, Any]:
    return {
        'topic_metadata': {
            'name': topic.name,
            'type': topic.type_name,
            'serialization_format': 'cdr',
            'offered_qos_profiles': qos_profiles(topic.offers),
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
