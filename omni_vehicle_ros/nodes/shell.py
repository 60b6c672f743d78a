"""The shell that puts a component on Fast DDS: convert, wait for what belongs to the cycle, act, convert, publish."""

import time
from collections import deque
from collections.abc import Callable

from rcl_interfaces.msg import SetParametersResult
from rclpy.context import Context
from rclpy.duration import Duration
from rclpy.lifecycle import LifecycleState, TransitionCallbackReturn
from rclpy.parameter import Parameter

from omni_vehicle_ros import interface
from omni_vehicle_ros.components.beats import Beats
from omni_vehicle_ros.components.component import NANOSECONDS, Component, Output
from omni_vehicle_ros.components.gate import Gate
from omni_vehicle_ros.components.inbox import Inbox
from omni_vehicle_ros.control.health import OK, WARN
from omni_vehicle_ros.cores import stay_on_core
from omni_vehicle_ros.errors import MessageError
from omni_vehicle_ros.faults import FAULTS, Fault, faults_message
from omni_vehicle_ros.faults import OK as UNHARMED
from omni_vehicle_ros.messages import Diagnostics, Status, Step, Text, Value, decode
from omni_vehicle_ros.nodes.declare import declare, why_fixed
from omni_vehicle_ros.nodes.earlier import Earlier
from omni_vehicle_ros.nodes.exchange import Exchange, Inlet
from omni_vehicle_ros.nodes.failing_process import end_or_freeze
from omni_vehicle_ros.nodes.fault_parameters import FaultParameters
from omni_vehicle_ros.nodes.handshake import Handshake
from omni_vehicle_ros.nodes.managed import ManagedNode
from omni_vehicle_ros.nodes.owners import Owners
from omni_vehicle_ros.nodes.ports import on_this_machine
from omni_vehicle_ros.nodes.scheduling import be_punctual, work_through
from omni_vehicle_ros.nodes.supervisor import Supervisor
from omni_vehicle_ros.parameters import PacingParameters

WARN_PERIOD = 5.0
WARNING_LENGTH = 500
"""What somebody sends may be in it, and /rosout keeps the last 1000 for who comes later."""

FUTURE = 1_000_000_000
"""A stamp farther ahead than this is of another clock, and answers for now only [ns]."""

RESTARTED = 10
"""Beats of another clock in a row by which a plant that was started anew is known."""

CONNECT_LIMIT = 3.0
"""Wall time in which a node is connected to all the others, if they are there [s]."""

PREVIOUS_SHARE = 0.125
"""Share of wait_limit that a node waits for what belongs to the cycle before: less than others wait for that node."""

SHARES = {
    interface.ICR_STEERING: 0.7, interface.SIDE_SLIP_CONTROLLER: 0.8, **dict.fromkeys(interface.WHEEL_MODULES, 0.9),
}
"""Share of wait_limit that a node waits, if not all of it: less than those who wait for its answer meanwhile."""


class Shell(ManagedNode):
    """A node around one component; parameters as of `ManagedNode`.

    Attributes
    ----------
    age
        How long ago the message at hand came in [s].
    """

    def __init__(self, role: str, *, context: Context, exchange: Exchange, namespace: str | None = None) -> None:
        super().__init__(role, context=context, exchange=exchange, namespace=namespace)
        self.finished = False
        self.age = 0.0
        self._sources: tuple[str, ...] = ()
        self._previous: tuple[str, ...] = ()
        self._fetched: dict[str, Inlet] = {}
        self._fetching = False
        self._warned: dict[str, float] = {}
        self.pacing = declare(self, PacingParameters)
        self.lockstep = self.pacing.pacing == 'lockstep'
        self._schedule()
        rows = interface.topics(
            publish_clock=self.pacing.publish_clock, fault_injection=self.pacing.fault_injection
        )
        # Where no driver takes part, nobody may say that the drive is over.
        stepped = self.lockstep or interface.DRIVER in self.pacing.participants
        self._rows = {row.name: row for row in rows if stepped or row.name != 'driver/step'}
        self._beats = Beats(RESTARTED)
        self._late: deque[tuple[float, list[Output]]] = deque()
        self._initial: list[Fault] = []
        self._fault_parameters: FaultParameters | None = None
        self._uncertain: set[str] = set()
        self._supervisor = Supervisor(self._bury, self._go_on_without)
        if self.pacing.autostart:
            self.bring_up()

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
                f'realtime_priority {priority}: {refusal}; allow it (ulimit -r, or rtprio in '
                '/etc/security/limits.conf), or set it to 0'
            )

    def attach(
        self, component: Component, *, previous: tuple[str, ...] = (), fetched: tuple[str, ...] = ()
    ) -> None:
        """Make the ports of a component and begin to serve it.

        Parameters
        ----------
        component
            Who acts.
        previous
            Topics on which it waits for answers of the cycle before, too, in lock step.
        fetched
            Topics whose messages come before others of the same cycle: they are fetched with these. To be woken for
            a message costs more than to take it.
        """
        self.component, self._beat, self._sources = component, component.beat, component.sources
        self._previous = previous if self.lockstep else ()
        self._fetched = {}
        self._inbox = Inbox(self.role, component, fault_injection=self.pacing.fault_injection)
        if self._fault_parameters is None:
            self._fault_parameters = FaultParameters(self, self.role, self.pacing.fault_injection, self.inject)
            self._initial = self._fault_parameters.initial
        self.connect()
        for row in self.topics():
            if self.subscribes(row.name) and row.name != 'ready':
                # In real time the next message is there before one that was lost could be sent again, and what is sent
                # again holds up those behind it. In lock step none is lost in shared memory: fewer are on the way than
                # it holds.
                again = not (row.cyclic or (row.repeated and not self.lockstep))
                reliable = again or (self.lockstep and not on_this_machine())
                if row.name == interface.EMERGENCY_STOP:
                    earlier = Earlier(self._decoder(row, self._heed), self._decoder(row, self._inbox.put))
                    self.subscribe(row, earlier.hear, always=True)
                    self.subscribe(row, earlier.hear_earlier, depth=1, latched=True, always=True)
                    continue
                # In real time an older beat is out of date, too.
                depth = 1 if row.name == component.beat and not self.lockstep else None
                hear = self._decoder(row, self.take)
                inlet = self.subscribe(row, hear, self.take, reliable=reliable, depth=depth)
                if row.name in fetched and not self.exchange.shared:
                    self._fetched[row.name] = inlet
        self._spare_wakes()

    def connect(self) -> None:
        """Make the publishers of this node."""
        self.open_ports([row for row in self.topics() if self.publishes(row.name)])

    def topics(self) -> list[interface.Topic]:
        """Return the rows of the wiring table that this vehicle uses."""
        return list(self._rows.values())

    def publishes(self, topic: str) -> bool:
        """Whether this node publishes on ``topic``."""
        return topic in self._rows and self.role in self._rows[topic].publishers

    def subscribes(self, topic: str) -> bool:
        """Whether this node subscribes to ``topic``."""
        return topic in self._rows and self.role in self._rows[topic].subscribers

    def _decoder(self, row: interface.Topic, use: Callable[[str, Value], None]) -> Callable[[bytes], None]:
        """Return what takes the bytes of a topic and decodes them for ``use``."""
        name, type_name = row.name, row.type

        def hear(data: bytes) -> None:
            if len(data) > interface.LONGEST:
                self.warn(f'{name}: more than {interface.LONGEST} bytes; the message is dropped')
                return
            try:
                value = decode(type_name, data)
            except MessageError as error:
                self.warn(f'{name}: {error}; the message is dropped')
                return
            use(name, value)

        return hear

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Begin anew with the next cycle, when connected to the others."""
        sources = self._sources
        if self.lockstep and interface.DRIVER in self.pacing.participants and self.subscribes('driver/step'):
            sources = (*sources, 'driver/step')
        self.gate = Gate(sources, self._previous, patient=self.lockstep)
        self._opened = self._activated = time.monotonic()
        rows = self.topics()
        publishers = [outlet.publisher for outlet in self.outlets.values()]
        self._handshake = Handshake(
            self, self.role, self.vehicle_namespace, rows, self.pacing.participants, publishers
        )
        mine = [row for row in rows if self.subscribes(row.name)]
        self._owners = Owners(self, self.vehicle_namespace, mine)
        return super().on_activate(state)

    def take(self, topic: str, value: Value) -> None:
        """Keep a message for the cycle that it belongs to, and act when that is complete."""
        self.note(topic, value)
        if not self._fetching:
            self.act()

    def note(self, topic: str, value: Value) -> None:
        """Keep a message for the cycle that it belongs to."""
        if topic == self._beat and not (self.lockstep or self._beats.accept(value.stamp)):
            self.warn(f'{topic}: a stamp of another clock; the message is dropped')
            return
        self._inbox.put(topic, value)
        if topic == self._beat:
            if self.lockstep and self.gate.waiting:
                self.warn(f'cycle skipped at {value.stamp / 1e9:.3f} s: no answer from {self.gate.absent()}')
            self.gate.open(value.stamp)
            self._opened = time.monotonic()
        elif isinstance(value, Step):
            self.gate.announce(name for name in value.topics if self.subscribes(name))
            self.gate.answer(topic, value.stamp)
        else:
            stamp = value.stamp
            self.gate.hear(topic, stamp if stamp < self.now + FUTURE else self.now)

    def fetch(self) -> None:
        """Note the messages that wait in the middleware."""
        self._fetching = True
        for inlet in self._fetched.values():
            inlet.fetch(self._note_age)
        self._fetching, self.age = False, 0.0

    def _spare_wakes(self) -> None:
        """Have the executor leave to `fetch` what it can; not as long as others that would wake this node are lost."""
        lost = self.active and self.gate.lost
        unserved = () if lost else tuple(inlet.subscription for inlet in self._fetched.values())
        if unserved != self.unserved:
            self.unserved = unserved
            self._wake_executor()

    def _note_age(self, received: int) -> None:
        self.age = max((time.time_ns() - received) / NANOSECONDS, 0.0) if received else 0.0

    def _heed(self, topic: str, value: Value) -> None:
        """Take what must not be missed by a node that is not active yet."""
        (self.take if self.active else self._inbox.put)(topic, value)

    def act(self) -> None:
        """Let the component act if its cycle is complete."""
        if self._fetched:
            self.fetch()
        stamp = self.gate.ready()
        if stamp is None or not self._connected():
            if self._fetched and self._impatient():
                self.exchange.wake()
            return
        missing = self.gate.missing()
        self.gate.close()
        self.now = stamp
        blocked = self.hand_over()
        if missing or blocked:
            absent = {*missing, *blocked}
            missing = tuple(source for source in self.component.sources if source in absent)
        if self._inbox.process.failure == UNHARMED and not self._late:
            self.publish(self.component.step(stamp, missing))
        else:
            self._act_harmed(stamp, missing)

    def _connected(self) -> bool:
        """Whether an answer comes through: of a node that joins a lock step later, the first could be lost."""
        return self._handshake.done or not self.lockstep or time.monotonic() - self._activated > CONNECT_LIMIT

    def _act_harmed(self, stamp: int, missing: tuple[str, ...]) -> None:
        """Act late, or not at all."""
        fault = self._inbox.process
        if not self._inbox.silent:
            self._late.append((time.monotonic() + fault.value, self.component.step(stamp, missing)))
        elif not self.exchange.shared:
            self._inbox.process = Fault(fault.component)  # who is thawed goes on
            end_or_freeze(fault.failure, [outlet.publisher for outlet in self.outlets.values()])

    def hand_over(self) -> tuple[str, ...]:
        """Hand the messages that wait to the component; return the topics of which faults let nothing through."""
        blocked = self._inbox.hand_over(self.now)
        if self._inbox.refused:
            if self.role == interface.PLANT:
                self._say_note('faults', '; '.join(dict.fromkeys(self._inbox.refused)))
            self._inbox.refused = []
        return blocked

    def inject(self, faults: list[Fault]) -> None:
        """Let all nodes, and whoever records, know what happens from now on; before the node is active, then."""
        if not self.active:
            self._initial += faults
            return
        message = faults_message(self.now, faults)
        self.say(FAULTS, message)
        if not self.subscribes(FAULTS):
            self._inbox.inject(message, self.now)

    def set_parameters_atomically(self, parameter_list: list[Parameter]) -> SetParametersResult:
        """Refuse what was read at the start with the reason; rclpy would only say that it is read-only."""
        refused = why_fixed(self, self.full_name, parameter_list)
        if refused:
            return SetParametersResult(successful=False, reason=refused)
        return super().set_parameters_atomically(parameter_list)

    def publish(self, outputs: list[Output]) -> None:
        """Publish what a component has to say."""
        for topic, value in outputs:
            self.outlets[topic].say(value)

    def await_heard(self, topic: str) -> None:
        """Wait a little until those who listen to ``topic`` have what was published on it."""
        self.outlets[topic].publisher.wait_for_all_acked(Duration(seconds=0.5))

    def poll(self) -> None:
        """Do what no message calls for: handshake, a look round, and the end of a wait that takes too long."""
        if not self.active:
            return
        if not self._handshake.done and self._handshake.complete():
            self.exchange.look()
            if self.lockstep:
                stay_on_core()
            if self._initial:
                self.inject(self._initial)
                self._initial = []
            self.say('ready', Text(self.role))
            self._supervisor.say_ready(self.role)
        self._supervisor.listen()
        while self._late and time.monotonic() >= self._late[0][0]:
            self.publish(self._late.popleft()[1])
        if self._owners.look():
            self._say_strangers(self._owners.strangers)
        if self._fetched:
            self.act()
            self._spare_wakes()
        if not (self.lockstep and self.gate.waiting):
            return
        waited, limit = time.monotonic() - self._opened, self.pacing.wait_limit
        if waited > PREVIOUS_SHARE * limit:
            self.gate.give_up_previous()
            self.act()
        limit = self.pacing.start_limit if self._uncertain else limit * SHARES.get(self.role, 1.0)
        if self.gate.waiting and waited > limit:
            self.warn(f'no answer from {self.gate.absent()} for {limit:g} s; going on without')
            self.gate.give_up()
            self.act()

    def _bury(self, role: str) -> None:
        """Count a node no more that has died; wait until it is known whether it comes back."""
        self._owners.bury(role)
        self._uncertain.add(role)

    def _go_on_without(self, role: str) -> None:
        self._uncertain.discard(role)
        self.miss(role, [row.name for row in self._rows.values() if row.publishers == (role,)])

    def miss(self, role: str, topics: list[str]) -> None:
        """Wait no more for a node and what it alone says on ``topics``, until it answers again."""
        if not self.lockstep:
            return
        self.gate.give_up_on(topics)
        self._opened = time.monotonic()
        if role == interface.DRIVER:
            self.gate.forget_announced()
        self.act()

    def _say_strangers(self, strangers: str) -> None:
        """Name who publishes what belongs to another node, or say that nobody does any more."""
        level = WARN if strangers else OK
        self._say_note('inputs', strangers or 'every topic has one publisher', level)

    def _say_note(self, about: str, text: str, level: int = WARN) -> None:
        """Say on /diagnostics what is no state of the component."""
        self.say('/diagnostics', Diagnostics(self.now, (Status(level, f'{self.full_name}: {about}', text),)))

    def wait(self) -> float:
        """Return for how long there is nothing to do but to take messages [s]."""
        if self._late or self._impatient():
            return 0.001
        return 0.05 if self.lockstep else 0.02

    def _impatient(self) -> bool:
        """Return whether nothing is awaited but what has been said already, and is to be fetched."""
        return self.lockstep and self.active and self.gate.awaits_only(self._fetched)

    def warn(self, message: str) -> None:
        """Log a warning, of a long one the beginning, and the same one at most every few seconds."""
        message = message[:WARNING_LENGTH]
        now = time.monotonic()
        if now - self._warned.get(message, -WARN_PERIOD) >= WARN_PERIOD:
            self._warned = {text: when for text, when in self._warned.items() if now - when < WARN_PERIOD}
            self._warned[message] = now
            self.get_logger().warning(message)
