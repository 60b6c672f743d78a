"""Drives the vehicle as any ROS user would: nothing here is of this package."""

import sys
import time

import rclpy
from geometry_msgs.msg import PointStamped, TwistStamped
from nav_msgs.msg import Odometry


def main() -> None:
    """Publish an ICR and a speed until the vehicle has gone some way, then fall silent and print how it stops."""
    rclpy.init()
    node = rclpy.create_node('outsider')
    icr = node.create_publisher(PointStamped, 'driver/icr', 10)
    speed = node.create_publisher(TwistStamped, 'driver/speed', 10)
    seen: list[Odometry] = []
    node.create_subscription(Odometry, 'odom', seen.append, 10)
    centre, forward = PointStamped(), TwistStamped()
    centre.header.frame_id = forward.header.frame_id = 'base_link'
    centre.point.y = 8.0
    forward.twist.linear.x = 2.0
    end = time.monotonic() + float(sys.argv[1])
    next_time = 0.0
    while time.monotonic() < end:
        rclpy.spin_once(node, timeout_sec=0.01)
        last = seen[-1] if seen else None
        if last and last.twist.twist.linear.x > 1.8 and last.twist.twist.angular.z > 0.15:
            break
        if time.monotonic() >= next_time:
            next_time = time.monotonic() + 0.05
            icr.publish(centre)
            speed.publish(forward)
    print(f'moving {seen[-1].twist.twist.linear.x:.3f} {seen[-1].twist.twist.angular.z:.3f}', flush=True)
    while time.monotonic() < end:
        rclpy.spin_once(node, timeout_sec=0.01)
        if abs(seen[-1].twist.twist.linear.x) < 0.02:
            break
    print(f'stopped {seen[-1].twist.twist.linear.x!r}', flush=True)
    node.destroy_node()
    rclpy.shutdown()


main()
