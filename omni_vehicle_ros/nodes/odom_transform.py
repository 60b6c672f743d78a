"""Node ``odom_transform``: says ``odom`` again as the transform odom -> base_link on ``/tf``, for those who draw.

It needs tf2_msgs, which comes with an installation of ROS 2, but not from PyPI.
"""

import math
import sys

from geometry_msgs.msg import TransformStamped
from rclpy.context import Context
from rclpy.node import Node

from omni_vehicle_ros import interface
from omni_vehicle_ros.errors import MessageError
from omni_vehicle_ros.interface import BASE_FRAME, ODOM_FRAME, Qos
from omni_vehicle_ros.messages import Odometry, decode
from omni_vehicle_ros.nodes.managed import StartError
from omni_vehicle_ros.nodes.ports import publisher_profile, subscribe_to
from omni_vehicle_ros.nodes.process import run

SECOND = 1_000_000_000
TF = Qos(depth=100, latched=False)


def transform(odometry: Odometry) -> TransformStamped:
    """Return the pose of the vehicle as the transform that takes base_link to odom."""
    found = TransformStamped()
    found.header.stamp.sec, found.header.stamp.nanosec = divmod(odometry.stamp, SECOND)
    found.header.frame_id, found.child_frame_id = ODOM_FRAME, BASE_FRAME
    found.transform.translation.x, found.transform.translation.y = odometry.x, odometry.y
    found.transform.rotation.z = math.sin(0.5 * odometry.heading)
    found.transform.rotation.w = math.cos(0.5 * odometry.heading)
    return found


class OdomTransform(Node):
    """Publishes a transform for each message of ``odom`` in its namespace."""

    def __init__(self, context: Context) -> None:
        super().__init__('odom_transform', context=context)
        self.finished = False
        try:
            from tf2_msgs.msg import TFMessage
        except ImportError as error:
            raise StartError('tf2_msgs is not installed; it comes with ROS 2 Jazzy, not from PyPI') from error
        self._message = TFMessage
        self._publisher = self.create_publisher(TFMessage, '/tf', publisher_profile(TF))
        subscribe_to(self, interface.topic('odom'), self.get_namespace(), self._say)

    def _say(self, data: bytes) -> None:
        try:
            odometry: Odometry = decode(interface.topic('odom').type, data)
        except MessageError as error:
            self.get_logger().warning(f'odom: {error}; the message is dropped', throttle_duration_sec=1.0)
            return
        self._publisher.publish(self._message(transforms=[transform(odometry)]))

    def poll(self) -> None:
        """Do nothing: messages call for all."""

    def wait(self) -> float:
        """Return for how long there is nothing to do but to take messages [s]."""
        return 0.5

    def end(self) -> None:
        """Leave nothing half done: there is nothing."""


def main() -> None:
    """Run the node until a signal comes."""
    sys.exit(run(lambda context, _: [OdomTransform(context)]))
