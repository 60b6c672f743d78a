"""Hands messages over from node to node of one process, where nobody outside it listens.

Each node has all its publishers and subscriptions on Fast DDS. But encoding a message, sending it and decoding it
costs many times what most nodes do with it. So a publisher whose only subscriptions are those of this process hands
the value over, which is immutable, and publishes nothing; as soon as anybody else listens, all hear it over DDS.
"""

import time
from collections import deque
from collections.abc import Callable
from typing import Any, NamedTuple

from rclpy.duration import Duration
from rclpy.publisher import Publisher
from rclpy.subscription import Subscription

from omni_vehicle_ros.interface import Topic
from omni_vehicle_ros.messages import Text, Value, encode

ACKNOWLEDGED = Duration(seconds=0.5)
"""In which a subscription of the same process has what was sent to it."""

Take = Callable[[Any], None]


class Inlet(NamedTuple):
    """One subscription of this process."""

    subscription: Subscription
    hear: Callable[[bytes], None]
    """Takes a message that came over DDS."""
    take: Callable[[Value], None] | None
    """Takes a value that is handed over; None to have it as bytes, too."""


class Outlet:
    """What one publisher says, over DDS or to the nodes of this process only.

    Parameters
    ----------
    publisher
        Of the topic.
    type_name
        Of the messages.
    inlets
        The subscriptions of this process to the topic; those that are added later count, too.
    hand_over
        Called with whom a message is for, and the message.

    Attributes
    ----------
    publisher
        As given.
    local
        Whether messages are handed over, and not published.
    """

    def __init__(
        self, publisher: Publisher, type_name: str, inlets: list[Inlet], hand_over: Callable[[Take, Any], None]
    ) -> None:
        self.publisher = publisher
        self.local = False
        self._publish = publisher.handle.publish_raw
        self._type_name, self._inlets, self._hand_over = type_name, inlets, hand_over

    def say(self, value: Value | Text) -> None:
        """Publish a message, or hand it over."""
        if not self.local:
            self._publish(encode(self._type_name, value))
            return
        data = None
        for inlet in self._inlets:
            if inlet.take is not None:
                self._hand_over(inlet.take, value)
            else:
                data = data or encode(self._type_name, value)
                self._hand_over(inlet.hear, data)

    def unheard_outside(self) -> bool:
        """Whether all who listen are in this process, and connected."""
        return bool(self.publisher.get_subscription_count() == len(self._inlets))

    def go_local(self) -> None:
        """Hand over from now on; what was published before is taken first."""
        self.local = self.publisher.wait_for_all_acked(ACKNOWLEDGED)
        if self.local:
            for subscription, hear, _ in self._inlets:
                while (found := subscription.handle.take_message(subscription.msg_type, True)) is not None:
                    hear(found[0])


class Exchange:
    """All that the nodes of one process say to each other.

    Attributes
    ----------
    wake
        Called when there is something to deliver, where there was nothing.
    """

    def __init__(self) -> None:
        self.wake: Callable[[], None] = lambda: None
        self._inlets: dict[str, list[Inlet]] = {}
        self._outlets: list[Outlet] = []
        self._queue: deque[tuple[Take, Any]] = deque()

    def add_subscription(
        self, subscription: Subscription, hear: Callable[[bytes], None], take: Callable[[Value], None] | None
    ) -> None:
        """Announce a subscription; see `Inlet`."""
        self._inlets.setdefault(subscription.topic_name, []).append(Inlet(subscription, hear, take))

    def add_publisher(self, publisher: Publisher, topic: Topic) -> Outlet:
        """Return what to say the messages of a publisher to; latched ones always go over DDS, which keeps them."""
        inlets = self._inlets.setdefault(publisher.topic_name, [])
        outlet = Outlet(publisher, topic.type, inlets, self._hand_over)
        if not topic.qos.latched:
            self._outlets.append(outlet)
        return outlet

    def look(self) -> None:
        """See who listens, and let each publisher go the right way; on each topic the order stays as it was."""
        for outlet in self._outlets:
            unheard = outlet.unheard_outside()
            if unheard and not outlet.local:
                outlet.go_local()
            elif outlet.local and not unheard:
                outlet.local = False
                for _ in range(len(self._queue)):
                    self._deliver_first()

    def deliver(self, until: float) -> None:
        """Hand over what waits, and what is said meanwhile, until nothing waits or it is ``until`` [s]."""
        while self._queue and time.monotonic() < until:
            self._deliver_first()

    @property
    def waits(self) -> bool:
        """Whether there is something to deliver."""
        return bool(self._queue)

    def _hand_over(self, take: Take, said: Any) -> None:
        """Let a message wait: who speaks comes to an end before others answer."""
        if not self._queue:
            self.wake()
        self._queue.append((take, said))

    def _deliver_first(self) -> None:
        """Hand over the first message; it waits until it was taken, so that an answer to it wakes nobody."""
        take, said = self._queue[0]
        take(said)
        self._queue.popleft()
