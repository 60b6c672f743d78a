"""Records the topics of the wiring table, ordered by simulated time, in lock step with the vehicle."""

import time
from collections.abc import Callable
from typing import Any, NamedTuple

from omni_vehicle_ros import interface
from omni_vehicle_ros.components.component import DIAGNOSTICS_PERIOD, ERROR, Reporter
from omni_vehicle_ros.components.journal import Journal, Writer
from omni_vehicle_ros.components.recording_statistics import RecordingStatistics, TopicStatistics
from omni_vehicle_ros.control.health import Health, health
from omni_vehicle_ros.errors import BagError, MessageError
from omni_vehicle_ros.messages import Step, decode
from omni_vehicle_ros.nodes.declare import declare
from omni_vehicle_ros.nodes.shell import Shell
from omni_vehicle_ros.parameters import PlantParameters

DEPTH = 4000
"""Messages of one topic that may wait for the recorder: many times what the plant lets it fall behind."""

ACKNOWLEDGE = 4
"""Cycles from one acknowledgement to the next."""

END_LIMIT = 3.0

BEAT = 'joint_states'
"""The topic that begins a cycle."""


class _Queue(NamedTuple):
    """What waits in the middleware for one subscription."""

    take_message: Callable[..., tuple[bytes, Any] | None]
    kind: Any
    hear: Callable[[bytes], None]

    def empty(self) -> None:
        """Take all of it."""
        for _ in range(DEPTH):  # a flood on one topic keeps no other waiting for ever
            found = self.take_message(self.kind, True)
            if found is None:
                break
            self.hear(found[0])


class VehicleRecording:
    """Takes raw bytes, orders them by simulated time and writes them; says at the end what was lost.

    Of the topics that have a message in every cycle only `BEAT` comes by the executor: to be woken for each message
    costs more than to take it. The others wait in the middleware for the next acknowledgement, in which several of
    each are taken at once. Their stamps order them; those of other topics may say that they mean now, so that these
    come at once.

    Parameters
    ----------
    node
        The recorder, connected.
    writer
        Where messages go.
    fail
        Called with what the writer refuses.
    """

    period = 0.05

    def __init__(self, node: Shell, writer: Writer, fail: Callable[[BagError], None]) -> None:
        period = declare(node, PlantParameters, only=('control_period',)).control_period
        self._node, self._fail = node, fail
        self._journal = Journal(writer, node.vehicle_namespace, round(period * 1e9))
        self._acknowledge = ACKNOWLEDGE * self._journal.period
        self._acknowledged = -self._acknowledge
        self._end: int | None = None
        self._ended = 0.0
        self._reporter = Reporter(node.full_name)
        self._statistics = RecordingStatistics()
        self._values: tuple[tuple[str, str], ...] = ()
        self._reported = 0
        self._waiting: list[_Queue] = []
        self._served: list[_Queue] = []
        for row in node.topics():
            if row.recorded:
                self._subscribe(row)

    def _subscribe(self, row: interface.Topic) -> None:
        take = self._taker(row)
        subscription = self._node.subscribe(row, take, depth=DEPTH).subscription
        queue = _Queue(subscription.handle.take_message, subscription.msg_type, take)
        if row.cyclic and row.name != BEAT:
            self._node.unserved += (subscription,)
            self._waiting.append(queue)
        else:
            self._served.append(queue)

    def _taker(self, row: interface.Topic) -> Callable[[bytes], None]:
        name, type_name = row.name, row.type
        journal = self._journal
        full = interface.resolve(name, self._node.vehicle_namespace)
        statistics = self._statistics.topics.setdefault(full, TopicStatistics())

        def take(data: bytes) -> None:
            if len(data) > interface.LONGEST:
                self._node.warn(f'{name}: more than {interface.LONGEST} bytes; the message is not recorded')
                return
            try:
                stamp = journal.add(name, data)
                statistics.add(len(data), stamp // journal.period if row.cyclic else None)
                if name == BEAT:
                    self._beat()
                elif name == 'driver/step':
                    step: Step = decode(type_name, data)
                    self._end = step.end
            except MessageError as error:
                self._node.warn(f'{name}: {error}; the message is not recorded')
            except BagError as error:
                self._fail(error)

        return take

    def _beat(self) -> None:
        now = self._journal.now
        if now - self._acknowledged >= self._acknowledge:
            self._acknowledged = now
            self.take()
            step = Step(now, 0, (interface.RECORDER,))
            self._node.say('recorder/step', step)
            state = self._state_in_lockstep() if self._node.lockstep else self._state(now)
            self._node.publish(self._reporter.report(now, state))

    def _state_in_lockstep(self) -> Health:
        """Return what is the same in every run: no rates, which depend on when messages came."""
        lost = self._journal.lost
        values = (('messages lost', str(lost)),) if lost else ()
        return health([(ERROR, 'messages were lost')] if lost else [], 'recording', values)

    def _state(self, now: int) -> Health:
        """Return the state with statistics, which are worked out once a second."""
        if not 0 <= now - self._reported < DIAGNOSTICS_PERIOD:
            self._reported = now
            for topic in self._statistics.topics.values():
                topic.look(('the stamps tell',))
            self._values = self._statistics.values(now, {})
        return health([], 'recording', self._values)

    def poll(self) -> bool:
        """Return whether the scenario is over and all of it has come."""
        self.take()
        wall = time.monotonic()
        if self._end is None or self._journal.now < self._end:
            self._ended = wall
            return False
        return self._journal.complete(self._end) or wall - self._ended > END_LIMIT

    def miss(self, topics: list[str]) -> None:
        """Wait at the end for no more of some topics, until they are heard again."""
        self.take()
        self._journal.miss(topics)

    def take(self) -> None:
        """Take the messages that wait in the middleware."""
        for queue in self._waiting:
            queue.empty()

    def now(self) -> int:
        """Return simulated time [ns]."""
        return self._journal.now

    def end(self) -> None:
        """Write what waits, also what the executor has not handed over yet.

        A node says how it is before its last word of a cycle, so that all of that is here.
        """
        self.take()
        for queue in self._served:
            queue.empty()
        self._journal.flush()

    def summary(self) -> str:
        """Return how many messages were written, and how many are missing."""
        what = 'lost' if self._node.lockstep else 'cycles missed'
        return f'recorded {self._journal.written} messages, {self._journal.lost} {what}'
