"""Quality of service as channels of a bag tell it, ours or not."""

from collections.abc import Mapping
from typing import Any

import yaml

from omni_vehicle_ros.bags.metadata import INFINITE, SECOND, OfferedQos

LARGEST = 2**16
"""Length of a text above which it is not read."""

BROKEN_YAML = (yaml.YAMLError, LookupError, ValueError, TypeError, AttributeError, OverflowError, RecursionError)
"""What reading YAML may raise on texts that are not."""

_WORDS = {  # by the numbers that rosbag2 wrote before ROS 2 Jazzy
    'history': ('system_default', 'keep_last', 'keep_all', 'unknown'),
    'reliability': ('system_default', 'reliable', 'best_effort', 'unknown', 'best_available'),
    'durability': ('system_default', 'transient_local', 'volatile', 'unknown', 'best_available'),
    'liveliness': ('system_default', 'automatic', 'manual_by_node', 'manual_by_topic', 'unknown', 'best_available'),
}


def read_offers(text: str) -> tuple[OfferedQos, ...]:
    """Return what publishers offer by the text ``offered_qos_profiles`` of a channel; nothing if it makes no sense."""
    try:
        return convert_offers(yaml.safe_load(text) if len(text) <= LARGEST else None)
    except BROKEN_YAML:
        return ()


def convert_offers(profiles: Any) -> tuple[OfferedQos, ...]:
    """Return what publishers offer by the profiles as YAML gives them; nothing if they make no sense."""
    try:
        return tuple(_offer(profile) for profile in profiles) if isinstance(profiles, list) else ()
    except BROKEN_YAML:
        return ()


def _offer(profile: Mapping[str, Any]) -> OfferedQos:
    default = OfferedQos()._asdict()
    return OfferedQos(**{name: _value(name, profile[name]) for name in default if name in profile})


def _value(name: str, value: Any) -> Any:
    if name in _WORDS:
        word = dict(enumerate(_WORDS[name])).get(value, value)
        if word not in _WORDS[name]:
            raise ValueError(word)
        return word
    if isinstance(value, Mapping):
        return min(int(value['sec']) * SECOND + int(value['nsec']), INFINITE)
    return bool(value) if isinstance(OfferedQos._field_defaults[name], bool) else int(value)
