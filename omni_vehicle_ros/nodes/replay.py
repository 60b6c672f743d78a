"""Node ``replay``: publishes the messages of a bag as the bytes that were recorded."""

import time
from dataclasses import dataclass, field
from pathlib import Path

from rclpy.context import Context
from rclpy.duration import Duration
from rclpy.exceptions import InvalidTopicNameException
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, HistoryPolicy, LivelinessPolicy, QoSProfile, ReliabilityPolicy
from std_srvs.srv import Trigger

from omni_vehicle_ros.bags.installed import installed_schema
from omni_vehicle_ros.bags.metadata import INFINITE, OfferedQos
from omni_vehicle_ros.bags.player import CLOCK, CLOCK_TYPE, Entry, Player, PlayerSettings
from omni_vehicle_ros.bags.source import TopicFacts, open_source
from omni_vehicle_ros.components.topic_playing import TopicPlaying, combined_offer, latched_depth, unplayable
from omni_vehicle_ros.errors import BagError, MessageError
from omni_vehicle_ros.messages.stamps import restamped_now
from omni_vehicle_ros.nodes.managed import StartError
from omni_vehicle_ros.nodes.ports import message_class
from omni_vehicle_ros.nodes.process import run
from omni_vehicle_ros.nodes.refusals import REFUSALS, one_line

DISCOVERY = 1.0
"""Wait for those who listen, at least [s]."""

SETTLE = 0.5
"""How long nobody new must have come before it begins: they match a publisher later than it matches them [s]."""

DISCOVERY_LIMIT = 4.0
"""Wait for those who listen, at most: Fast DDS announces every 3 s [s]."""

LOOK_PERIOD = 1.0
ACKNOWLEDGE_LIMIT = 2.0


@dataclass(frozen=True)
class Replay:
    """What to replay.

    Attributes
    ----------
    bag
        A bag directory or file.
    topics
        Names of topics; all if there are none.
    commands_only
        Publish only what a driver, or anyone, tells a vehicle, and with the stamp 0, which means now.
    player
        What of it, and how.
    """

    bag: Path
    topics: tuple[str, ...] = ()
    commands_only: bool = False
    player: PlayerSettings = field(default_factory=PlayerSettings)


class ReplayNode(Node):
    """Publishes what the player says is due; offers the services pause, resume and step."""

    def __init__(self, context: Context, replay: Replay) -> None:
        super().__init__('replay', context=context)
        self.finished = False
        self._replay, self._source = replay, open_source(replay.bag)
        self._playing = TopicPlaying(replay.topics, commands_only=replay.commands_only)
        self._player = Player(self._source, self._playing.plays, self._latched, replay.player)
        self._outlets: dict[str, tuple[Publisher, str] | None] = {}
        self._depths: dict[str, int] = {}
        self._count = 0
        self._began = False
        if self._source.topics:
            self._playing.check(str(replay.bag), self._source.topics)
        for topic in self._source.topics:
            if self._plays(topic):
                self._open(topic)
        if replay.player.clock:
            self._outlets[CLOCK] = self.create_publisher(message_class(CLOCK_TYPE), CLOCK, 10), CLOCK_TYPE
        for name, answer in (('pause', self._pause), ('resume', self._resume), ('step', self._step)):
            self.create_service(Trigger, f'~/{name}', answer)
        self._made = self._looked = self._came = time.monotonic()
        self._listeners = 0

    def poll(self) -> None:
        """Publish what is due.

        Raises
        ------
        StartError
            Another node publishes /clock.
        BagError
            The bag can't be read, or has nothing of what is asked for.
        """
        wall = time.monotonic()
        if not self._began and not self._listeners_are_there(wall):
            return
        if not self._began or wall >= self._looked + LOOK_PERIOD:
            self._looked = wall
            self._look_for_other_clocks()
            self._began = True
        self._publish(self._player.due(time.monotonic_ns()))
        if self._player.finished:
            self._finish()

    def _listeners_are_there(self, wall: float) -> bool:
        """Whether all who listen are probably connected: what is published before that they don't hear."""
        count = sum(outlet[0].get_subscription_count() for outlet in self._outlets.values() if outlet)
        if count != self._listeners:
            self._listeners, self._came = count, wall
        waited = wall - self._made
        return waited >= DISCOVERY_LIMIT or (waited >= DISCOVERY and count > 0 and wall - self._came >= SETTLE)

    def wait(self) -> float:
        """Return for how long there is nothing to do [s]."""
        if not self._began:
            return 0.05
        return self._player.wait(time.monotonic_ns())

    def end(self) -> None:
        """Say how much it was, and what is damaged."""
        for line in self._source.damage:
            self.get_logger().warning(line)
        if self._count:
            print(f'replayed {self._count} messages', flush=True)

    def _finish(self) -> None:
        """End when all is heard.

        Raises
        ------
        BagError
            There was nothing to play.
        """
        self.finished = True
        bag = str(self._replay.bag)
        self._playing.check(bag, self._source.topics)
        if self._player.first is None:
            raise BagError(f'{bag} holds no messages that can be read')
        if not self._count:
            raise BagError(f'{bag}: nothing lies between --start and --duration that can be published')
        until = time.monotonic() + ACKNOWLEDGE_LIMIT
        for outlet in filter(None, self._outlets.values()):
            outlet[0].wait_for_all_acked(Duration(seconds=max(until - time.monotonic(), 0.0)))

    def _publish(self, entries: list[Entry]) -> None:
        restamp = self._replay.commands_only
        for _, topic, type_name, data in entries:
            if topic not in self._outlets:
                self._open(topic)
            opened = self._outlets[topic]
            if opened is None:
                continue
            publisher, kind = opened
            if type_name != kind:
                self._skip(topic, f'it has several types: {kind}, {type_name}')
                continue
            publisher.publish(_restamped(data) if restamp else data)
            self._count += 1

    def _plays(self, topic: str) -> bool:
        return self._playing.plays(topic) and not (topic == CLOCK and self._replay.player.clock)

    def _latched(self, topic: str) -> int:
        if topic not in self._depths:
            self._depths[topic] = latched_depth(self._source.topics[topic].offers)
        return self._depths[topic]

    def _open(self, topic: str) -> None:
        """Make the publisher of a topic, or say why not."""
        facts = self._source.topics[topic]
        try:
            kind = message_class(facts.type_name)
            reason = unplayable(facts, _type_hash(facts))
            if topic == CLOCK and self._began and self.count_publishers(CLOCK):
                reason = 'another node publishes it, and there can be one clock only'
            if not reason:
                publisher = self.create_publisher(kind, topic, _profile(combined_offer(facts.offers)))
                self._outlets[topic] = publisher, facts.type_name
                return
        except (ImportError, AttributeError, ValueError, TypeError):  # of names that are none, too
            reason = f'its type {facts.type_name} is not installed'
        except (InvalidTopicNameException, *REFUSALS) as error:
            reason = one_line(error)
        self._skip(topic, reason)

    def _skip(self, topic: str, reason: str) -> None:
        """Leave a topic out from now on."""
        self._outlets[topic] = None
        self.get_logger().warning(f'{topic} is not replayed: {reason}')

    def _look_for_other_clocks(self) -> None:
        """Refuse to be the second clock; later, when another one comes, warn of it."""
        if self._outlets.get(CLOCK) is None or self.count_publishers(CLOCK) < 2:
            return
        infos = self.get_publishers_info_by_topic(CLOCK)
        names = sorted({f'{info.node_namespace.rstrip("/")}/{info.node_name}' for info in infos})
        text = f'{CLOCK} has more than one publisher ({", ".join(names)}); there can be one clock only'
        if not self._began:
            raise StartError(f'{text}: end the other, or leave it out of --topics')
        self.get_logger().warning(text, throttle_duration_sec=5.0)

    def _pause(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self._player.pause(time.monotonic_ns())
        return self._answer(response, 'paused')

    def _resume(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self._player.resume(time.monotonic_ns())
        return self._answer(response, 'playing')

    def _step(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        if not self._player.paused:
            response.message = 'not paused: call pause first'
            return response
        if not self._began:
            response.message = 'it has not begun: those who listen are still being awaited; call step again'
            return response
        entries = self._player.step(time.monotonic_ns())
        if not entries:
            response.message = 'nothing is left' if self._player.finished else 'the begin is still being sought'
            return response
        before = self._count
        self._publish(entries)
        return self._answer(response, f'{self._count - before} messages')

    def _answer(self, response: Trigger.Response, text: str) -> Trigger.Response:
        response.success, response.message = True, f'{text}, at {self._player.position:.3f} s of the bag'
        return response


def _restamped(data: bytes) -> bytes:
    try:
        return restamped_now(data)
    except MessageError:
        return data  # too short for a command: whoever takes it says so


def _type_hash(facts: TopicFacts) -> str:
    """Return the hash of the installed type; empty if its package doesn't tell."""
    try:
        return installed_schema(facts.type_name).type_hash
    except BagError:
        return ''


def _profile(offer: OfferedQos) -> QoSProfile:
    durations = {
        name: Duration(nanoseconds=value)
        for name, value in (
            ('deadline', offer.deadline), ('lifespan', offer.lifespan),
            ('liveliness_lease_duration', offer.liveliness_lease_duration),
        )
        if value != INFINITE
    }
    return QoSProfile(
        history=HistoryPolicy[offer.history.upper()],
        depth=offer.depth,
        reliability=ReliabilityPolicy[offer.reliability.upper()],
        durability=DurabilityPolicy[offer.durability.upper()],
        liveliness=LivelinessPolicy[offer.liveliness.upper()],
        avoid_ros_namespace_conventions=offer.avoid_ros_namespace_conventions,
        **durations,
    )


def play(replay: Replay) -> int:
    """Replay a bag to its end or until a signal comes; return the exit code."""
    return run(lambda context, _: [ReplayNode(context, replay)])
