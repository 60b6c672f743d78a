"""Subscriptions to topics of any type, found while running, of which the raw bytes are taken."""

import time
from collections.abc import Callable, Sequence
from operator import itemgetter
from typing import Any, NamedTuple, Protocol

from rclpy.node import Node
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    LivelinessPolicy,
    QoSProfile,
    ReliabilityPolicy,
)
from rclpy.subscription import Subscription
from rclpy.topic_endpoint_info import TopicEndpointInfo

from omni_vehicle_ros.bags.installed import installed_schema
from omni_vehicle_ros.bags.metadata import OfferedQos
from omni_vehicle_ros.bags.schema import Schema
from omni_vehicle_ros.components.recording_statistics import RecordingStatistics, TopicStatistics
from omni_vehicle_ros.components.topic_choice import Request, TopicChoice, request_for, weaker
from omni_vehicle_ros.errors import BagError
from omni_vehicle_ros.nodes.ports import message_class

DEPTH = 4000
"""Messages of one topic that may wait: at 1,000 a second, those of four seconds."""

BATCH = 4000
"""Messages of one topic that are taken at a time, so that a flood on one keeps no other waiting."""

LOOK_PERIOD = 1.0
"""From one look at the publishers of known topics to the next [s]."""

NEW_PERIOD = 0.2
"""From one look for new topics to the next [s]."""


class Sink(Protocol):
    """What messages are written to."""

    def add_topic(
        self, name: str, type_name: str, qos: Sequence[OfferedQos], description: Schema | None = None
    ) -> None:
        """Announce a topic."""

    def write(self, name: str, data: bytes, log_time_ns: int, publish_time_ns: int | None = None) -> None:
        """Write a message."""


class _Tap(NamedTuple):
    subscription: Subscription
    type_name: str
    kind: Any
    request: Request
    statistics: TopicStatistics


class _Taken(NamedTuple):
    received: int
    topic: str
    data: bytes
    sent: int
    number: int | None


class Taps:
    """Records what a choice takes.

    An executor hands raw bytes over without what the middleware knows about them: when they were sent and received,
    and their number. So the subscriptions belong to a node of their own, hidden by its name, which no executor serves,
    and their queues are emptied by `take`. That makes times independent of when it is called, and costs less, too.

    Parameters
    ----------
    node
        The recorder; looks at the graph.
    choice
        Which topics to record.
    sink
        Where messages go, in the order in which they were received.
    say
        Called with what the user should know.

    Attributes
    ----------
    statistics
        Of the recording.
    skipped
        Why topics that were chosen aren't recorded, by topic.
    """

    def __init__(self, node: Node, choice: TopicChoice, sink: Sink, say: Callable[[str], None]) -> None:
        self.statistics = RecordingStatistics()
        self.skipped: dict[str, str] = {}
        self._choice, self._sink, self._say = choice, sink, say
        self._inputs = Node(
            f'_{node.get_name()}_inputs', context=node.context, namespace=node.get_namespace(),
            use_global_arguments=False, enable_rosout=False, start_parameter_services=False,
        )
        self._taps: dict[str, _Tap] = {}
        self._held: list[_Taken] = []
        self._until = 0
        self._looked_for_new = self._looked = -LOOK_PERIOD

    @property
    def missing(self) -> list[str]:
        """Topics that are chosen by name, and that nobody has published yet."""
        return sorted(self._choice.named - {*self._taps, *self.skipped})

    def look(self) -> None:
        """Find new topics, and see who publishes on the others, both from time to time."""
        now = time.monotonic()
        if now - self._looked_for_new < NEW_PERIOD:
            return
        self._looked_for_new = now
        thorough = now - self._looked >= LOOK_PERIOD
        if thorough:
            self._looked = now
        for topic, _ in self._inputs.get_topic_names_and_types():
            if topic in self._taps:
                if thorough:
                    self._look_again(topic)
            elif topic not in self.skipped and self._choice.takes(topic):
                self._begin(topic)

    def take(self) -> None:
        """Write what has come.

        What comes while the queues are emptied waits for the next time, so that the order is right across topics.
        """
        until = time.time_ns()
        taken = self._held
        for topic, tap in self._taps.items():
            take, kind = tap.subscription.handle.take_message, tap.kind
            for _ in range(BATCH):
                found = take(kind, True)
                if found is None:
                    break
                data, facts = found
                received = facts['received_timestamp'] or until
                sent = facts['source_timestamp'] or received
                taken.append(_Taken(received, topic, data, sent, facts['publication_sequence_number']))
        taken.sort(key=itemgetter(0))
        if until < self._until:  # the clock was set back: nothing waits for it
            until = 2**63
        ready = [one for one in taken if one.received < until]
        self._held, self._until = taken[len(ready) :], until
        self._write(ready)

    def end(self) -> None:
        """Write all that has come, and let the subscriptions go."""
        self.take()
        self._write(self._held)
        self._held = []
        for tap in self._taps.values():
            tap.statistics.look(tap.statistics.publishers)
        self._inputs.destroy_node()

    def _write(self, messages: list[_Taken]) -> None:
        write, taps = self._sink.write, self._taps
        for received, topic, data, sent, number in messages:
            write(topic, data, received, sent)
            taps[topic].statistics.add(len(data), number)

    def _begin(self, topic: str) -> None:
        """Subscribe to a topic that is new, or say why not."""
        publishers = self._inputs.get_publishers_info_by_topic(topic)
        if not publishers:
            return
        types = sorted({one.topic_type for one in publishers})
        if len(types) > 1:
            self._skip(topic, f'it has several types: {", ".join(types)}')
            return
        try:
            description = installed_schema(types[0])
            kind = message_class(types[0])
        except (BagError, ImportError, AttributeError) as error:
            self._skip(topic, str(error))
            return
        foreign = {str(one.topic_type_hash) for one in publishers} - {description.type_hash}
        if any(one.startswith('RIHS01_') for one in foreign):
            self._skip(topic, f'its publisher has another definition of {types[0]} than the installed one')
            return
        offers = [_offer(one) for one in publishers]
        self._sink.add_topic(topic, types[0], offers, description)
        statistics = self.statistics.topics.setdefault(topic, TopicStatistics())
        statistics.look(_names(publishers))
        request = request_for(offers)
        self._taps[topic] = _Tap(self._subscribe(topic, kind, request), types[0], kind, request, statistics)

    def _look_again(self, topic: str) -> None:
        """Note who publishes, and ask for less if a new publisher offers less; name one of another type."""
        tap = self._taps[topic]
        found = self._inputs.get_publishers_info_by_topic(topic)
        publishers = [one for one in found if one.topic_type == tap.type_name]
        for foreign in sorted({one.topic_type for one in found} - {tap.type_name}):
            if (name := f'{topic} as {foreign}') not in self.skipped:
                self._skip(name, f'in this bag the topic has the type {tap.type_name}')
        tap.statistics.look(_names(publishers))
        request = weaker(tap.request, request_for(map(_offer, publishers)))
        if request != tap.request:
            self._say(f'{topic}: a publisher offers less than the others; subscribing anew, some messages may be lost')
            self.take()
            self._inputs.destroy_subscription(tap.subscription)
            self._taps[topic] = tap._replace(subscription=self._subscribe(topic, tap.kind, request), request=request)

    def _skip(self, topic: str, reason: str) -> None:
        self.skipped[topic] = reason
        self._say(f'{topic} is not recorded: {reason}')

    def _subscribe(self, topic: str, kind: Any, request: Request) -> Subscription:
        profile = QoSProfile(
            history=HistoryPolicy.KEEP_LAST,
            depth=DEPTH,
            reliability=ReliabilityPolicy.RELIABLE if request.reliable else ReliabilityPolicy.BEST_EFFORT,
            durability=DurabilityPolicy.TRANSIENT_LOCAL if request.latched else DurabilityPolicy.VOLATILE,
        )
        return self._inputs.create_subscription(kind, topic, _unused, profile, raw=True)


def _unused(data: bytes) -> None:
    """Stand for a callback: no executor calls it."""


def _names(publishers: Sequence[TopicEndpointInfo]) -> list[str]:
    return [bytes(one.endpoint_gid).hex() for one in publishers]


def _offer(publisher: TopicEndpointInfo) -> OfferedQos:
    """Return what a publisher offers, in rosbag2's words."""
    profile = publisher.qos_profile
    return OfferedQos(
        _word(HistoryPolicy, profile.history), profile.depth,
        _word(ReliabilityPolicy, profile.reliability), _word(DurabilityPolicy, profile.durability),
        profile.deadline.nanoseconds, profile.lifespan.nanoseconds,
        _word(LivelinessPolicy, profile.liveliness), profile.liveliness_lease_duration.nanoseconds,
        profile.avoid_ros_namespace_conventions,
    )


def _word(policy: Any, value: Any) -> str:
    return str(policy(value).name.lower())
