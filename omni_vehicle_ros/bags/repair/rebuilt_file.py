"""One MCAP file made of what was saved of another: schemas, channels, times and bytes as they were."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from omni_vehicle_ros.bags.mcap.definitions import Attachment
from omni_vehicle_ros.bags.mcap.file_writer import BAG_RECORD, bag_record
from omni_vehicle_ros.bags.mcap.writer import McapWriter
from omni_vehicle_ros.bags.repair.salvage import Salvage, Saved, SavedMessage

CHUNK_SIZE = 2**20
"""Nobody waits for these messages, and larger chunks are packed tighter [byte]."""


class RebuiltFile:
    """Writes what a salvage gives.

    Parameters
    ----------
    path
        Of the new file.
    salvage
        Knows the definitions of what it gives.
    """

    def __init__(self, path: Path, salvage: Salvage) -> None:
        self._path = path
        self._salvage = salvage
        self._writer: McapWriter | None = None
        self._schemas: set[int] = set()
        self._channels: set[int] = set()

    def write(self, item: Saved) -> None:
        """Write a message, an attachment or words about the file."""
        writer = self._open()
        if isinstance(item, SavedMessage):
            if item.channel not in self._channels:
                self._add_channel(writer, item.channel)
            writer.add_message(*item)
        elif isinstance(item, Attachment):
            writer.add_attachment(item)
        elif item.name != BAG_RECORD:
            writer.add_metadata(item)

    def finish(self, information: Mapping[str, Any]) -> None:
        """Write the channels without messages, the metadata of the bag, index and summary."""
        writer = self._open()
        for number in self._salvage.definitions.channels.keys() - self._channels:
            self._add_channel(writer, number)
        writer.add_metadata(bag_record(information))
        writer.finish()

    def abandon(self) -> None:
        """Close the file as it is, if it was begun."""
        if self._writer is not None:
            self._writer.abandon()

    def _open(self) -> McapWriter:
        """Begin the file with what is written first: what comes before it tells the profile."""
        if self._writer is None:
            self._writer = McapWriter(self._path, self._salvage.profile, 'zstd', CHUNK_SIZE)
        return self._writer

    def _add_channel(self, writer: McapWriter, number: int) -> None:
        channel = self._salvage.definitions.channels[number]
        if channel.schema and channel.schema not in self._schemas:
            self._schemas.add(channel.schema)
            writer.add_schema(channel.schema, self._salvage.definitions.schemas[channel.schema])
        self._channels.add(number)
        writer.add_channel(number, channel)
