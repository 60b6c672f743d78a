"""One MCAP file made of what was saved of another: schemas, channels, times and bytes as they were."""

from collections.abc import Mapping
from typing import IO, Any

from mcap.writer import Writer

from omni_vehicle_ros import __version__
from omni_vehicle_ros.bags.mcap.definitions import Attachment
from omni_vehicle_ros.bags.metadata import as_yaml
from omni_vehicle_ros.bags.repair.salvage import Salvage, Saved, SavedMessage

BAG_RECORD = 'rosbag2'
"""Name of the metadata record with the metadata of the bag, which is made anew."""


class RebuiltFile:
    """Writes what a salvage gives.

    Parameters
    ----------
    stream
        Where to.
    salvage
        Knows the definitions of what it gives.
    """

    def __init__(self, stream: IO[bytes], salvage: Salvage) -> None:
        self._salvage = salvage
        self._writer = Writer(stream, enable_data_crcs=True)
        self._started = False
        self._schemas: dict[int, int] = {0: 0}
        self._channels: dict[int, int] = {}

    def write(self, item: Saved) -> None:
        """Write a message, an attachment or words about the file."""
        self._start()
        if isinstance(item, SavedMessage):
            channel = self._channels.get(item.channel) or self._add_channel(item.channel)
            self._writer.add_message(channel, item.log_time, item.data, item.publish_time, item.sequence)
        elif isinstance(item, Attachment):
            self._writer.add_attachment(item.create_time, item.log_time, item.name, item.media_type, item.data)
        elif item.name != BAG_RECORD:
            self._writer.add_metadata(item.name, item.texts)

    def finish(self, information: Mapping[str, Any]) -> None:
        """Write the channels without messages, the metadata of the bag, index and summary."""
        self._start()
        for number in self._salvage.definitions.channels.keys() - self._channels.keys():
            self._add_channel(number)
        self._writer.add_metadata(BAG_RECORD, {'serialized_metadata': as_yaml(information)})
        self._writer.finish()

    def _start(self) -> None:
        if not self._started:
            self._started = True
            self._writer.start(self._salvage.profile, f'omni_vehicle_ros {__version__}')

    def _add_channel(self, number: int) -> int:
        channel = self._salvage.definitions.channels[number]
        if channel.schema not in self._schemas:
            schema = self._salvage.definitions.schemas[channel.schema]
            self._schemas[channel.schema] = self._writer.register_schema(schema.name, schema.encoding, schema.data)
        made = self._writer.register_channel(
            channel.topic, channel.encoding, self._schemas[channel.schema], dict(channel.metadata)
        )
        self._channels[number] = int(made)
        return self._channels[number]
