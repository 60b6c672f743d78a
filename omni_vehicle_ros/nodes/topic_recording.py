"""Records chosen topics of any type, in the order and at the times in which they were received."""

import time

from omni_vehicle_ros import interface
from omni_vehicle_ros.bags.snapshot import SnapshotBuffer
from omni_vehicle_ros.bags.writer import BagWriter
from omni_vehicle_ros.components.topic_choice import TopicChoice
from omni_vehicle_ros.control.health import OK, WARN
from omni_vehicle_ros.messages import Diagnostics, Status
from omni_vehicle_ros.nodes.shell import Shell
from omni_vehicle_ros.nodes.taps import Taps
from omni_vehicle_ros.parameters import RecorderParameters

REPORT_PERIOD = 1_000_000_000


class TopicRecording:
    """Finds topics, records them, and reports once a second of wall time.

    Parameters
    ----------
    node
        The recorder.
    settings
        Which topics.
    sink
        Where messages go.
    """

    period = 0.01

    def __init__(self, node: Shell, settings: RecorderParameters, sink: BagWriter | SnapshotBuffer) -> None:
        self._node, self._sink = node, sink
        self._taps = Taps(node, TopicChoice(settings, node.resolve_topic_name), sink, node.get_logger().warning)
        self._reported = 0
        node.open_ports([interface.topic('/diagnostics')])

    def poll(self) -> bool:
        """Write what came and say how it goes; such a recording is never over by itself."""
        self._taps.look()
        self._taps.take()
        now = self.now()
        if not 0 <= now - self._reported < REPORT_PERIOD:
            self._reported = now
            self._report(now)
        return False

    def take(self) -> None:
        """Write what came."""
        self._taps.take()

    def now(self) -> int:
        """Return wall time [ns]."""
        return time.time_ns()

    def end(self) -> None:
        """Write what waits."""
        self._taps.end()

    def summary(self) -> str:
        """Return what was recorded, lost, missing, and written where."""
        missing = f'; nobody published {", ".join(self._taps.missing)}' if self._taps.missing else ''
        written = f'{missing}; {self._sink.count} written to {self._sink.directory}'
        return f'{self._taps.statistics.summary()}{written}'

    def _report(self, now: int) -> None:
        statistics = self._taps.statistics
        skipped = {**self._taps.skipped, **dict.fromkeys(self._taps.missing, 'nobody publishes it')}
        lost = statistics.fresh_losses()
        values = statistics.values(now, skipped)
        level, text = (WARN, f'{lost} messages were lost') if lost else (OK, 'recording')
        self._node.say('/diagnostics', Diagnostics(now, (Status(level, self._node.full_name, text, values),)))
