"""The shell that puts a component on Fast DDS: convert, wait for what belongs to the cycle, act, convert, publish."""

import time
from collections import deque
from collections.abc import Iterator
from functools import partial
from operator import itemgetter

from rclpy.context import Context
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.subscription import Subscription

from omni_vehicle_ros import interface
from omni_vehicle_ros.components.component import Component, Output
from omni_vehicle_ros.components.gate import Gate
from omni_vehicle_ros.control.health import OK, WARN
from omni_vehicle_ros.errors import MessageError, OmniVehicleError
from omni_vehicle_ros.messages import Diagnostics, Status, Step, Text, Value, decode
from omni_vehicle_ros.nodes.declare import declare
from omni_vehicle_ros.nodes.exchange import Exchange, Inlet
from omni_vehicle_ros.nodes.handshake import Handshake
from omni_vehicle_ros.nodes.owners import Owners
from omni_vehicle_ros.nodes.ports import publish_on, subscribe_to
from omni_vehicle_ros.nodes.scheduling import be_punctual, work_through
from omni_vehicle_ros.parameters import PacingParameters

WARN_PERIOD = 5.0

FUTURE = 1_000_000_000
"""A stamp farther ahead than this is of another clock, and answers for now only [ns]."""

INBOX = 512
"""Messages that may wait for their cycle; of a flood, the latest are kept."""

_ORDER = {row.name: number for number, row in enumerate(interface.TOPICS)}
_BY_TOPIC = itemgetter(0)


class Shell(Node):
    """A node around one component.

    Parameters
    ----------
    role
        Which node of the wiring table this is, with ``/`` for modules: ``front_left/wheel_module``.
    context
        The ROS context it lives in.
    namespace
        Namespace of the node; None takes it from the command line.
    exchange
        Of the process.

    Attributes
    ----------
    unserved
        Subscriptions that no executor serves: who made them takes their messages when it suits.
    """

    unserved: tuple[Subscription, ...] = ()

    def __init__(self, role: str, *, context: Context, exchange: Exchange, namespace: str | None = None) -> None:
        super().__init__(role.split('/')[-1], context=context, namespace=namespace)
        self.role = role
        self.exchange = exchange
        self.finished = False
        self.gate = Gate(())
        self.now = 0
        self._opened = 0.0
        self.pacing = declare(self, PacingParameters)
        self.lockstep = self.pacing.pacing == 'lockstep'
        self._schedule()
        self._inbox: deque[tuple[int, str, Value]] = deque(maxlen=INBOX)
        self._warned: dict[str, float] = {}

    def _schedule(self) -> None:
        """Choose how the kernel schedules this process: what drives goes before what only looks on.

        That goes before the rest of the machine: it must not be kept waiting while it holds a lock of shared memory.
        """
        if self.lockstep:
            work_through()
            return
        priority = self.pacing.realtime_priority
        drives = self.role not in (interface.DRIVER, interface.RECORDER)
        refusal = be_punctual(priority if drives else max(priority - 1, 0))
        if refusal and self.role == interface.PLANT:
            self.get_logger().warning(
                f'realtime_priority {priority}: {refusal}; cycles may be missed when the machine is busy. Allow it '
                '(ulimit -r, or rtprio in /etc/security/limits.conf), or set realtime_priority to 0'
            )

    @property
    def vehicle_namespace(self) -> str:
        """The namespace of the vehicle: that of the node, less the name of the wheel."""
        namespace = self.get_namespace().rstrip('/')
        wheel = self.role.split('/')[0] if '/' in self.role else ''
        return namespace.removesuffix(f'/{wheel}') if wheel else namespace

    @property
    def subscriptions(self) -> Iterator[Subscription]:
        """The subscriptions that an executor serves."""
        return (one for one in super().subscriptions if one not in self.unserved)

    @property
    def full_name(self) -> str:
        """The name of the node with its namespace."""
        return f'{self.get_namespace().rstrip("/")}/{self.get_name()}'

    def attach(self, component: Component) -> None:
        """Make the ports of a component and begin to serve it."""
        self.component = component
        sources = component.sources
        if self.lockstep and interface.DRIVER in self.pacing.participants and self.subscribes('driver/step'):
            sources = (*sources, 'driver/step')
        self.gate = Gate(sources)
        self.connect()
        for row in self.topics():
            if self.subscribes(row.name) and row.name != 'ready':
                self._subscribe(row)

    def connect(self) -> None:
        """Make the publishers of this node."""
        self.open_ports([row for row in self.topics() if self.publishes(row.name)])
        publishers = [outlet.publisher for outlet in self._outlets.values()]
        self._handshake = Handshake(
            self, self.role, self.vehicle_namespace, self.topics(), self.pacing.participants, publishers
        )
        mine = [row for row in self.topics() if self.subscribes(row.name)]
        self._owners = Owners(self, self.vehicle_namespace, mine)

    def open_ports(self, rows: list[interface.Topic]) -> None:
        """Make the publishers of some topics."""
        self._outlets = {
            row.name: self.exchange.outlet(publish_on(self, row, self.vehicle_namespace), row) for row in rows
        }

    def topics(self) -> list[interface.Topic]:
        """Return the rows of the wiring table that this vehicle uses: /clock only if it owns it."""
        return [row for row in interface.TOPICS if row.name != '/clock' or self.pacing.publish_clock]

    def publishes(self, topic: str) -> bool:
        """Whether this node publishes on ``topic``."""
        return self.role in interface.topic(topic).publishers

    def subscribes(self, topic: str) -> bool:
        """Whether this node subscribes to ``topic``."""
        return self.role in interface.topic(topic).subscribers

    def _subscribe(self, row: interface.Topic) -> None:
        """Take the messages of a topic, over DDS and from the nodes of this process."""
        name, type_name = row.name, row.type

        def hear(data: bytes) -> None:
            try:
                value = decode(type_name, data)
            except MessageError as error:
                self.warn(f'{name}: {error}; the message is dropped')
                return
            self.take(name, value)

        # In real time a message that was lost is out of date before it could be sent again.
        reliable = self.lockstep or not row.cyclic
        subscription = subscribe_to(self, row, self.vehicle_namespace, hear, reliable=reliable)
        self.exchange.add_inlet(Inlet(subscription, hear, partial(self.take, name)))

    def take(self, topic: str, value: Value) -> None:
        """Keep a message for the cycle that it belongs to, and act when that is complete."""
        self._inbox.append((_ORDER[topic], topic, value))
        if topic == self.component.beat:
            if self.lockstep and self.gate.waiting:
                self.warn(f'cycle skipped at {value.stamp / 1e9:.3f} s: no answer from {self.gate.absent()}')
            self.gate.open(value.stamp)
            self._opened = time.monotonic()
        elif isinstance(value, Step):
            self.gate.announce(name for name in value.topics if self.subscribes(name))
            self.gate.answer(topic, value.stamp)
        else:
            self.gate.hear(topic)
            self.gate.answer(topic, value.stamp if value.stamp < self.now + FUTURE else self.now)
        self.act()

    def act(self) -> None:
        """Let the component act if its cycle is complete."""
        stamp = self.gate.ready()
        if stamp is None:
            return
        missing = self.gate.missing()
        self.gate.close()
        self.now = stamp
        self.hand_over()
        self.publish(self.component.step(stamp, missing))

    def hand_over(self) -> None:
        """Hand the messages that wait to the component: always in the same order, whatever order they came in."""
        waiting = sorted(self._inbox, key=_BY_TOPIC)
        self._inbox.clear()
        for _, topic, value in waiting:
            self.component.receive(topic, value, self.now)

    def publish(self, outputs: list[Output]) -> None:
        """Publish what a component has to say."""
        for topic, value in outputs:
            self._outlets[topic].say(value)

    def say(self, topic: str, value: Value | Text) -> None:
        """Publish one message."""
        self._outlets[topic].say(value)

    def await_heard(self, topic: str) -> None:
        """Wait a little until those who listen to ``topic`` have what was published on it."""
        self._outlets[topic].publisher.wait_for_all_acked(Duration(seconds=0.5))

    def poll(self) -> None:
        """Do what no message calls for: handshake, a look round, and the end of a wait that takes too long."""
        if not self._handshake.done and self._handshake.complete():
            self.exchange.look()
            self.say('ready', Text(self.role))
        if self._owners.look():
            self._say_strangers(self._owners.strangers)
        if self.lockstep and self.gate.waiting and time.monotonic() - self._opened > self.pacing.wait_limit:
            limit = self.pacing.wait_limit
            self.warn(f'no answer from {self.gate.absent()} for {limit:g} s; going on without')
            self.gate.give_up()
            self.act()

    def _say_strangers(self, strangers: str) -> None:
        """Name who publishes what belongs to another node, or say that nobody does any more."""
        level, text = (WARN, strangers) if strangers else (OK, 'every topic is published by its owner alone')
        self.say('/diagnostics', Diagnostics(self.now, (Status(level, f'{self.full_name}: inputs', text),)))

    def wait(self) -> float:
        """Return for how long there is nothing to do but to take messages [s]."""
        return 0.05

    def end(self) -> None:
        """Finish what must not be left half done; called once, before the node is destroyed."""

    def warn(self, message: str) -> None:
        """Log a warning, the same one at most every few seconds."""
        now = time.monotonic()
        if now - self._warned.get(message, -WARN_PERIOD) >= WARN_PERIOD:
            self._warned = {text: when for text, when in self._warned.items() if now - when < WARN_PERIOD}
            self._warned[message] = now
            self.get_logger().warning(message)


class StartError(OmniVehicleError):
    """A node could not start, or stopped for want of the others."""
