"""Bags: MCAP files in directories with ``metadata.yaml``, as rosbag2 makes them; without ROS."""

from omni_vehicle_ros.bags.bag import Bag, TopicInfo, open_bag
from omni_vehicle_ros.bags.columns.blocks import read_blocks
from omni_vehicle_ros.bags.columns.columns import Columns
from omni_vehicle_ros.bags.mcap.file_reader import RecordedMessage
from omni_vehicle_ros.bags.mcap.stream import MessageStream, read_messages
from omni_vehicle_ros.bags.writer import BagWriter

__all__ = [
    'Bag',
    'BagWriter',
    'Columns',
    'MessageStream',
    'RecordedMessage',
    'TopicInfo',
    'open_bag',
    'read_blocks',
    'read_messages',
]
