"""Takes a wheel module through its lifecycle while the vehicle drives, as any ROS user would."""

import time
from collections.abc import Callable

import rclpy
from geometry_msgs.msg import PointStamped, TwistStamped
from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState, GetState
from sensor_msgs.msg import JointState

LIMIT = 60.0
MODULE = '/front_left/wheel_module'


class Manager:
    """Drives in circles, and knows the joints and the state of a module."""

    def __init__(self) -> None:
        rclpy.init()
        self.node = rclpy.create_node('manager')
        self.joints = JointState()
        self.asked = 0.0
        self.icr = PointStamped()
        self.icr.header.frame_id = 'base_link'
        self._speed = TwistStamped()
        self._speed.twist.linear.x = 2.0
        self._publishers = (
            self.node.create_publisher(PointStamped, 'driver/icr', 10),
            self.node.create_publisher(TwistStamped, 'driver/speed', 10),
        )
        self.node.create_subscription(JointState, 'joint_states', self._see, 10)
        self.node.create_subscription(JointState, 'front_left/command', self._hear, 10)
        self._change = self.node.create_client(ChangeState, f'{MODULE}/change_state')
        self._get = self.node.create_client(GetState, f'{MODULE}/get_state')
        self._said = 0.0

    def _see(self, message: JointState) -> None:
        self.joints = message

    def _hear(self, message: JointState) -> None:
        self.asked = message.position[0]

    def until(self, condition: Callable[[], bool], what: str) -> None:
        """Drive until something has come about."""
        end = time.monotonic() + LIMIT
        while not condition():
            if time.monotonic() > end:
                raise SystemExit(f'in vain for {what}: {self.joints}')
            if time.monotonic() - self._said > 0.05:
                self._said = time.monotonic()
                for publisher, message in zip(self._publishers, (self.icr, self._speed), strict=True):
                    publisher.publish(message)
            rclpy.spin_once(self.node, timeout_sec=0.01)

    def call(self, client, request):
        """Return the answer of a service."""
        self.until(client.service_is_ready, client.srv_name)
        future = client.call_async(request)
        self.until(future.done, client.srv_name)
        return future.result()

    def state(self) -> str:
        """Return the state of the module."""
        return str(self.call(self._get, GetState.Request()).current_state.label)

    def change(self, transition: int) -> bool:
        """Ask for a transition; return whether it was made."""
        return bool(self.call(self._change, ChangeState.Request(transition=Transition(id=transition))).success)

    def steers(self, wheel: int, sign: float) -> bool:
        """Whether a wheel points to one side by more than 0.08 rad."""
        return bool(self.joints.position) and sign * self.joints.position[wheel] > 0.08

    def go(self, speed: float) -> None:
        """Have the vehicle drive at a speed."""
        self._speed.twist.linear.x = speed

    def turn(self, y: float) -> None:
        """Have the vehicle turn about a point beside it."""
        self.icr.point.y = y


def main() -> None:
    """Print ``done`` when all came about."""
    manager = Manager()
    manager.turn(8.0)
    manager.until(lambda: manager.steers(0, 1.0) and manager.steers(1, 1.0), 'a turn to the left')
    assert manager.state() == 'active'
    assert manager.change(Transition.TRANSITION_DEACTIVATE)
    assert manager.state() == 'inactive'
    manager.turn(-8.0)
    manager.until(lambda: manager.asked < -0.08, 'a command to the right')
    held = manager.joints.position[0]
    asked = manager.joints.header.stamp.sec
    manager.until(lambda: manager.joints.header.stamp.sec > asked + 1, 'the next second')
    assert manager.joints.position[0] == held, 'a command reached a wheel that is not active'
    assert manager.joints.effort[4] == 0.0
    assert not manager.change(Transition.TRANSITION_CONFIGURE)
    assert manager.change(Transition.TRANSITION_CLEANUP)
    assert manager.state() == 'unconfigured'
    manager.until(lambda: manager.node.count_publishers('/front_left/state') == 0, 'the end of its ports')
    assert manager.change(Transition.TRANSITION_CONFIGURE)
    assert manager.change(Transition.TRANSITION_ACTIVATE)
    manager.until(lambda: manager.steers(0, -1.0), 'the wheel to follow again')
    print('done', flush=True)
    manager.node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
