"""Publishers and subscriptions, made from the wiring table; messages cross them as raw bytes."""

import importlib
import os
from collections.abc import Callable
from typing import Any

from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.subscription import Subscription

from omni_vehicle_ros.interface import Qos, Topic, resolve


def message_class(type_name: str) -> Any:
    """Return the class of a type such as ``sensor_msgs/msg/JointState``."""
    package, kind, name = type_name.split('/')
    return getattr(importlib.import_module(f'{package}.{kind}'), name)


def publisher_profile(qos: Qos) -> QoSProfile:
    """Return the profile of a publisher."""
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        depth=qos.depth,
        reliability=ReliabilityPolicy.RELIABLE,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if qos.latched else DurabilityPolicy.VOLATILE,
    )


def subscription_profile(
    qos: Qos, *, depth: int | None = None, latched: bool = False, reliable: bool = True
) -> QoSProfile:
    """Return the profile of a subscription.

    It asks for volatile messages unless ``latched``: a latched subscription would refuse the publishers
    of ``ros2 topic pub`` and the like, which are volatile. One that is not ``reliable`` spares the publisher to
    keep account of it, and never waits for a lost message with the next one at hand.
    """
    profile = publisher_profile(Qos(depth or qos.depth, latched))
    if not reliable:
        profile.reliability = ReliabilityPolicy.BEST_EFFORT
    return profile


def on_this_machine() -> bool:
    """Return whether all nodes that can be heard are on this machine."""
    elsewhere = any(map(os.environ.get, ('ROS_STATIC_PEERS', 'ROS_DISCOVERY_SERVER')))
    return os.environ.get('ROS_AUTOMATIC_DISCOVERY_RANGE') == 'LOCALHOST' and not elsewhere


def publish_on(node: Node, topic: Topic, namespace: str) -> Publisher:
    """Make the publisher of a topic of the vehicle in ``namespace``."""
    return node.create_publisher(
        message_class(topic.type), resolve(topic.name, namespace), publisher_profile(topic.qos)
    )


def subscribe_to(
    node: Node,
    topic: Topic,
    namespace: str,
    callback: Callable[[bytes], None],
    *,
    depth: int | None = None,
    latched: bool = False,
    reliable: bool = True,
) -> Subscription:
    """Make a subscription that hands over the bytes of each message."""
    profile = subscription_profile(topic.qos, depth=depth, latched=latched, reliable=reliable)
    return node.create_subscription(
        message_class(topic.type), resolve(topic.name, namespace), callback, profile, raw=True
    )
