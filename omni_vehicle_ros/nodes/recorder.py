"""Node ``recorder``: writes every message of the vehicle to a bag, as the bytes that came."""

import sys
import time
from collections.abc import Callable
from pathlib import Path

from rclpy.context import Context

from omni_vehicle_ros import interface
from omni_vehicle_ros.bags.writer import BagWriter
from omni_vehicle_ros.components.component import ERROR, Reporter
from omni_vehicle_ros.components.journal import Journal
from omni_vehicle_ros.control.health import health
from omni_vehicle_ros.errors import MessageError
from omni_vehicle_ros.messages import Step, decode
from omni_vehicle_ros.nodes.declare import declare
from omni_vehicle_ros.nodes.ports import subscribe_to
from omni_vehicle_ros.nodes.process import run
from omni_vehicle_ros.nodes.shell import Shell
from omni_vehicle_ros.parameters import PlantParameters

DEPTH = 4000
"""Messages of one topic that may wait for the recorder: many times what the plant lets it fall behind."""

ACKNOWLEDGE = 4
"""Cycles from one acknowledgement to the next."""

FLUSH_PERIOD = 0.2
END_LIMIT = 3.0


class RecorderNode(Shell):
    """Takes raw bytes, orders them by simulated time and writes them; says at the end what was lost."""

    def __init__(self, context: Context, namespace: str | None = None) -> None:
        super().__init__(interface.RECORDER, context=context, namespace=namespace)
        period = declare(self, PlantParameters, only=('control_period',)).control_period
        directory = Path(str(self.declare_parameter('directory', 'bag').value))
        self._writer = BagWriter(directory)
        self._journal = Journal(self._writer, self.vehicle_namespace, round(period * 1e9))
        self._acknowledge = ACKNOWLEDGE * self._journal.period
        self._end: int | None = None
        self._ended = 0.0
        self._flushed = time.monotonic()
        self._closed = False
        self._reporter = Reporter(self.full_name)
        self.connect()
        for row in self.topics():
            if row.recorded:
                subscribe_to(self, row, self.vehicle_namespace, self._taker(row), depth=DEPTH)

    def _taker(self, row: interface.Topic) -> Callable[[bytes], None]:
        name, type_name = row.name, row.type
        journal = self._journal

        def take(data: bytes) -> None:
            try:
                journal.add(name, data)
                if name == 'joint_states':
                    self._beat()
                elif name == 'driver/step':
                    step: Step = decode(type_name, data)
                    self._end = step.end
            except MessageError as error:
                self.warn(f'{name}: {error}; the message is not recorded')

        return take

    def _beat(self) -> None:
        now = self._journal.now
        if now % self._acknowledge == 0:
            step = Step(now, 0, (interface.RECORDER,))
            lost = self._journal.lost if self.lockstep else 0
            values = (('messages lost', str(lost)),) if lost else ()
            state = health([(ERROR, 'messages were lost')] if lost else [], 'recording', values)
            self.say('recorder/step', step)
            self.publish(self._reporter.report(now, state))

    def poll(self) -> None:
        """Flush what came, and finish when the scenario is over."""
        super().poll()
        wall = time.monotonic()
        if wall - self._flushed >= FLUSH_PERIOD:
            self._flushed = wall
            self._writer.flush()
        if self._end is None or self._journal.now < self._end:
            self._ended = wall
        elif self._journal.complete(self._end) or wall - self._ended > END_LIMIT:
            self.finished = True

    def end(self) -> None:
        """Write what waits, close the bag, and say what was lost."""
        if self._closed:
            return
        self._closed = True
        self._journal.flush()
        self._writer.close()
        what = 'lost' if self.lockstep else 'cycles missed'
        print(f'recorded {self._journal.written} messages, {self._journal.lost} {what}', flush=True)


def main() -> None:
    """Run the node until the scenario is over or a signal comes."""
    sys.exit(run(lambda context: [RecorderNode(context)]))
