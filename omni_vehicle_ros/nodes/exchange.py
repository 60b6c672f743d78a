"""Hands messages over from node to node of one process, where nobody outside it listens.

Each node has all its publishers and subscriptions on Fast DDS. But to encode a message, send it and decode it takes
longer than most nodes need to answer it. So a publisher to which only nodes of this process listen hands the value
over, which is immutable, and publishes nothing; as soon as anybody else listens, all hear it over DDS.
"""

import time
from collections import deque
from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

from rclpy.duration import Duration
from rclpy.publisher import Publisher
from rclpy.subscription import Subscription

from omni_vehicle_ros.interface import Topic
from omni_vehicle_ros.messages import Text, Value, encode

ARRIVAL_LIMIT = Duration(seconds=0.5)
"""In which what was published has come to the subscriptions of the same process."""

Take = Callable[[Any], None]


class Inlet(NamedTuple):
    """One subscription of this process.

    Attributes
    ----------
    subscription
        On DDS.
    hear
        Takes the bytes of a message; also of one that is handed over, if there is no ``take``.
    take
        Takes the value of a message that is handed over.
    """

    subscription: Subscription
    hear: Callable[[bytes], None]
    take: Callable[[Value], None] | None = None

    def fetch(self, begin: Callable[[int], None] = lambda received: None) -> None:
        """Take the messages that wait in the middleware.

        Parameters
        ----------
        begin
            Called before each with the time at which the middleware received it [ns since 1970; 0 if not known].
        """
        take_message, kind = self.subscription.handle.take_message, self.subscription.msg_type
        while (found := take_message(kind, True)) is not None:
            begin(found[1]['received_timestamp'] or 0)
            self.hear(found[0])


class Outlet:
    """What is said by one publisher, over DDS or to the nodes of this process only.

    Parameters
    ----------
    publisher
        On DDS.
    type_name
        Of its messages.
    inlets
        Of its topic; those that are added later count, too.
    hand_over
        Called with some of those who take a message, and the message.

    Attributes
    ----------
    publisher
        As given.
    """

    def __init__(
        self, publisher: Publisher, type_name: str, inlets: list[Inlet], hand_over: Callable[[list[Take], Any], None]
    ) -> None:
        self.publisher = publisher
        self._publish = publisher.handle.publish_raw
        self._type_name, self._inlets, self._hand_over = type_name, inlets, hand_over
        self._local = False
        self._of_values: list[Take] = []
        self._of_bytes: list[Take] = []

    def say(self, value: Value | Text) -> None:
        """Publish a message, or hand it over."""
        if not self._local:
            self._publish(encode(self._type_name, value))
            return
        if self._of_values:
            self._hand_over(self._of_values, value)
        if self._of_bytes:
            self._hand_over(self._of_bytes, encode(self._type_name, value))

    def go_round(self) -> None:
        """Say all by DDS until the next look."""
        self._local = False

    def look(self) -> bool:
        """See who listens, and go the right way; return whether messages were handed over until now, and no more."""
        local = self.publisher.get_subscription_count() == len(self._inlets)
        if local and not self._local:
            self._go_local()
        elif self._local and not local:
            self._local = False
            return True
        return False

    def _go_local(self) -> None:
        """Hand over from now on. What was published before is taken first: no message overtakes another."""
        self._local = self.publisher.wait_for_all_acked(ARRIVAL_LIMIT)
        if self._local:
            self._of_values = [inlet.take for inlet in self._inlets if inlet.take is not None]
            self._of_bytes = [inlet.hear for inlet in self._inlets if inlet.take is None]
            for inlet in self._inlets:
                inlet.fetch()


class Exchange:
    """All that the nodes of one process say to each other.

    Attributes
    ----------
    wake
        Called when there is something to deliver, where there was nothing.
    shared
        Whether several nodes live in this process.
    heard
        Messages that came over DDS so far.
    """

    def __init__(self) -> None:
        self.shared = False
        self.heard = 0
        self.wake: Callable[[], None] = lambda: None
        self._inlets: dict[str, list[Inlet]] = {}
        self._outlets: list[Outlet] = []
        self._queue: deque[tuple[Take, Any]] = deque()

    def add_inlet(self, inlet: Inlet) -> None:
        """Announce a subscription."""
        topic = inlet.subscription.topic_name
        self._inlets.setdefault(topic, []).append(inlet)
        self._go_round({topic})

    def forget(self, subscriptions: Iterable[Subscription], outlets: Iterable[Outlet]) -> None:
        """Let go of subscriptions and publishers that will be destroyed; not to be called by who takes a message."""
        gone, ended = list(subscriptions), list(outlets)
        self._outlets = [outlet for outlet in self._outlets if outlet not in ended]
        for inlets in self._inlets.values():
            inlets[:] = [inlet for inlet in inlets if inlet.subscription not in gone]
        self._go_round({subscription.topic_name for subscription in gone})

    def outlet(self, publisher: Publisher, topic: Topic) -> Outlet:
        """Return what to say the messages of a publisher to; latched ones always go over DDS, which keeps them."""
        inlets = self._inlets.setdefault(publisher.topic_name, [])
        outlet = Outlet(publisher, topic.type, inlets, self._hand_over)
        if not topic.qos.latched:
            self._outlets.append(outlet)
        return outlet

    def _go_round(self, topics: set[str]) -> None:
        """Say by DDS what other nodes of this process listen to than before, until the next look."""
        self._deliver(len(self._queue))
        for outlet in self._outlets:
            if outlet.publisher.topic_name in topics:
                outlet.go_round()

    def look(self) -> None:
        """See who listens to what; to be called in a while again, and never by who takes a message."""
        for outlet in self._outlets:
            if outlet.look():
                # What waits was said before anything that goes over DDS from now on.
                self._deliver(len(self._queue))

    def deliver(self, until: float) -> None:
        """Hand over what waits, and then what is said meanwhile, until nothing waits or it is ``until`` [s]."""
        while self._queue:
            self._deliver(len(self._queue))
            if time.monotonic() >= until:
                return

    @property
    def waits(self) -> bool:
        """Whether there is something to deliver."""
        return bool(self._queue)

    def _hand_over(self, takers: list[Take], said: Any) -> None:
        """Let a message wait: who speaks comes to an end before others answer."""
        if not self._queue:
            self.wake()
        for take in takers:
            self._queue.append((take, said))

    def _deliver(self, count: int) -> None:
        queue = self._queue
        for _ in range(count):
            take, said = queue[0]
            take(said)
            queue.popleft()  # not before: an answer to the last one that waits need not wake anybody
