"""What lies in the files of a bag, against what its ``metadata.yaml`` says."""

from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import yaml

from omni_vehicle_ros.bags.metadata import FILE_NAME, ROOT, FileRecord, OfferedQos, TopicRecord, bag_information
from omni_vehicle_ros.bags.offers import BROKEN_YAML, read_offers
from omni_vehicle_ros.bags.repair.salvage import Salvage

LARGEST = 2**22
"""Size of a ``metadata.yaml`` above which it is not read [byte]."""

_NANOSECONDS = (('starting_time', 'nanoseconds_since_epoch'), ('duration', 'nanoseconds'))


class FoundMetadata(NamedTuple):
    """The ``metadata.yaml`` of a bag, as far as it can be read."""

    information: Mapping[str, Any] = {}
    """What it says, empty if that makes no sense."""
    damage: str = ''
    """Why not."""


def read_metadata(path: Path) -> FoundMetadata:
    """Return the metadata of a bag directory; of a single file nothing.

    Raises
    ------
    OSError
        The system refuses to read.
    """
    file = path / FILE_NAME
    if not path.is_dir():
        return FoundMetadata()
    if not file.is_file():
        return FoundMetadata(damage=f'{FILE_NAME} is missing')
    if file.stat().st_size > LARGEST:
        return FoundMetadata(damage=f'{FILE_NAME} has more than {LARGEST} bytes')
    try:
        information = yaml.safe_load(file.read_bytes().decode())[ROOT]
        if not isinstance(information, dict):
            raise ValueError(information)
        return FoundMetadata(information)
    except BROKEN_YAML:
        return FoundMetadata(damage=f'{FILE_NAME} can not be read')


class BagContents:
    """Gathers what lies in the files of a bag."""

    def __init__(self) -> None:
        self._files: list[FileRecord] = []
        self._topics: dict[str, TopicRecord] = {}

    def add(self, name: str, salvage: Salvage) -> None:
        """Add what was saved of a file."""
        self._files.append(FileRecord(name, salvage.span, salvage.messages))
        definitions = salvage.definitions
        for number, channel in definitions.channels.items():
            type_name = definitions.schemas[channel.schema].name if channel.schema else ''
            metadata = dict(channel.metadata)
            offers = _offers(metadata.get('offered_qos_profiles', ''))
            type_hash = metadata.get('topic_type_hash', '')
            first = TopicRecord(channel.topic, type_name, type_hash, (), 0)
            known = self._topics.get(channel.topic, first)
            self._topics[channel.topic] = known._replace(
                offers=tuple(dict.fromkeys(known.offers + offers)),
                message_count=known.message_count + salvage.by_channel[number],
            )

    def information(self, found: FoundMetadata) -> dict[str, Any]:
        """Return new metadata, with the user's words of the old."""
        custom = found.information.get('custom_data')
        words = {str(key): str(word) for key, word in custom.items()} if isinstance(custom, dict) else {}
        distribution = found.information.get('ros_distro')
        information = bag_information(self._files, list(self._topics.values()), words)
        return {**information, **({'ros_distro': distribution} if isinstance(distribution, str) else {})}

    def compare(self, found: FoundMetadata, *, counts: bool) -> str:
        """Return what is wrong with the metadata that was found, empty if nothing is.

        Parameters
        ----------
        found
            As `read_metadata` gives it.
        counts
            Whether to compare times and numbers of messages, too, and not the names of the files only.
        """
        if found.damage:
            return found.damage
        told, true = found.information, self.information(FoundMetadata())
        try:
            missing = [name for name in told['relative_file_paths'] if name not in true['relative_file_paths']]
            if missing:
                return f'{FILE_NAME} names {", ".join(map(repr, missing))}, which is missing'
            if not counts:
                return ''
            wrong = [key for key in ('relative_file_paths', 'message_count') if told[key] != true[key]]
            # rosbags counts the nanosecond after the last message, too
            wrong += [key for key, unit in _NANOSECONDS if self._any and abs(told[key][unit] - true[key][unit]) > 1]
            wrong += ['topics_with_message_count'] if _topics(told) != _topics(true) else []
        except BROKEN_YAML:
            return f'{FILE_NAME} is not complete'
        return f'{FILE_NAME} is wrong about {", ".join(wrong)}' if wrong else ''

    @property
    def _any(self) -> bool:
        return any(file.message_count for file in self._files)


def _topics(information: Mapping[str, Any]) -> set[tuple[str, str, int]]:
    rows = [(row['topic_metadata'], row['message_count']) for row in information['topics_with_message_count']]
    return {(topic['name'], topic['type'], count) for topic, count in rows if count}


@lru_cache(maxsize=1024)
def _offers(text: str) -> tuple[OfferedQos, ...]:
    return read_offers(text)
