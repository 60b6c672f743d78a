"""Bags: MCAP files in directories with ``metadata.yaml``, as rosbag2 makes them; without ROS."""

from omni_vehicle_ros.bags.bag import Bag, TopicInfo, open_bag
from omni_vehicle_ros.bags.blocks import read_blocks
from omni_vehicle_ros.bags.columns import Columns
from omni_vehicle_ros.bags.mcap_file_reader import RecordedMessage
from omni_vehicle_ros.bags.mcap_stream import MessageStream, read_messages
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
