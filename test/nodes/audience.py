"""Listens as any ROS user would, and works the services of a replay; nothing here is of this package."""

import sys
import time
from collections.abc import Callable

import rclpy
from geometry_msgs.msg import Vector3Stamped
from rclpy.qos import DurabilityPolicy, QoSProfile
from rosgraph_msgs.msg import Clock
from std_msgs.msg import String
from std_srvs.srv import Trigger

LIMIT = 60.0
LATCHED = QoSProfile(depth=50, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class Audience:
    """Keeps what it hears, by topic."""

    def __init__(self) -> None:
        self.node = rclpy.create_node('audience')
        self.heard: dict[str, list[bytes]] = {}
        for topic, kind, qos in (
            ('/said', String, 1000), ('/bank', Vector3Stamped, LATCHED), ('/clock', Clock, 1000),
        ):
            found = self.heard.setdefault(topic, [])
            self.node.create_subscription(kind, topic, found.append, qos, raw=True)
        names = ('pause', 'resume', 'step')  # made now, a replay that comes finds all of them at once
        self.clients = {name: self.node.create_client(Trigger, f'/replay/{name}') for name in names}

    def until(self, condition: Callable[[], bool], what: str) -> None:
        """Take messages until a condition holds."""
        end = time.monotonic() + LIMIT
        while not condition():
            assert time.monotonic() < end, f'waited in vain for {what}; heard {self.counts()}'
            rclpy.spin_once(self.node, timeout_sec=0.05)

    def counts(self) -> dict[str, int]:
        """Return how many messages came on each topic."""
        return {topic: len(found) for topic, found in self.heard.items()}

    def call(self, name: str) -> str:
        """Call a service of the replay; print and return its answer."""
        client = self.clients[name]
        assert client.wait_for_service(LIMIT)
        future = client.call_async(Trigger.Request())
        self.until(future.done, name)
        answer = future.result()
        print(f'{name} {answer.success} {answer.message}', flush=True)
        return str(answer.message)


def listen(audience: Audience, said: int, bank: int) -> None:
    """Print the bytes of what comes on both topics, when that many have come."""
    audience.until(lambda: len(audience.heard['/said']) >= said and len(audience.heard['/bank']) >= bank, 'all')
    for topic, found in audience.heard.items():
        print(topic, *(data.hex() for data in found), flush=True)


def work(audience: Audience) -> None:
    """Pause, step twice, and resume; print how much is heard in between."""
    said = audience.heard['/said']
    audience.until(lambda: len(said) > 0, 'the first message')
    audience.call('step')
    audience.call('pause')
    for _ in range(2):
        before = len(said)
        audience.call('step')
        audience.until(lambda before=before: len(said) > before, 'a step')  # type: ignore[misc]
        print('heard', len(said) - before, flush=True)
    before = len(said)
    audience.call('resume')
    audience.until(lambda: len(said) > before, 'more')


def work_early(audience: Audience) -> None:
    """Pause before the replay begins, and step as soon as it lets us, twice."""
    audience.call('pause')
    while 'not begun' in audience.call('step'):
        pass
    audience.call('step')


def publish_clock(audience: Audience) -> None:
    """Be a clock for as long as the process lives."""
    publisher = audience.node.create_publisher(Clock, '/clock', 10)
    print('ticking', flush=True)
    while True:
        publisher.publish(Clock())
        rclpy.spin_once(audience.node, timeout_sec=0.05)


rclpy.init()
audience = Audience()
print('listening', flush=True)
if sys.argv[1] == 'listen':
    listen(audience, int(sys.argv[2]), int(sys.argv[3]))
elif sys.argv[1] == 'work':
    work(audience)
elif sys.argv[1] == 'early':
    work_early(audience)
else:
    publish_clock(audience)
