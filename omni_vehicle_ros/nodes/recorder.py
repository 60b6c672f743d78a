"""Node ``recorder``: writes the messages of the vehicle, or of any other topics, to a bag as the bytes that came."""

import sys
import time
from typing import Protocol

from rclpy.context import Context
from rclpy.service import Service
from std_srvs.srv import Trigger

from omni_vehicle_ros import interface
from omni_vehicle_ros.bags.snapshot import SnapshotBuffer
from omni_vehicle_ros.bags.writer import BagWriter
from omni_vehicle_ros.control.health import ERROR
from omni_vehicle_ros.errors import BagError
from omni_vehicle_ros.messages import Diagnostics, Status
from omni_vehicle_ros.nodes.declare import declare
from omni_vehicle_ros.nodes.exchange import Exchange
from omni_vehicle_ros.nodes.managed import StartError
from omni_vehicle_ros.nodes.process import run
from omni_vehicle_ros.nodes.shell import Shell
from omni_vehicle_ros.nodes.topic_recording import TopicRecording
from omni_vehicle_ros.nodes.vehicle_recording import VehicleRecording
from omni_vehicle_ros.parameters import RecorderParameters

FLUSH_PERIOD = 0.2


class Recording(Protocol):
    """What kind of recording it is."""

    period: float
    """From one call of `poll` to the next [s]."""

    def poll(self) -> bool:
        """Do what is due, and return whether the recording is over."""

    def take(self) -> None:
        """Take the messages that wait, if the executor doesn't hand them over."""

    def now(self) -> int:
        """Return the stamp of a diagnostic [ns]."""

    def end(self) -> None:
        """Write what waits."""

    def summary(self) -> str:
        """Return in words what was recorded."""


class RecorderNode(Shell):
    """Owns the bag: makes it, flushes it, closes it, and says how that went."""

    def __init__(self, context: Context, exchange: Exchange, namespace: str | None = None) -> None:
        super().__init__(interface.RECORDER, context=context, exchange=exchange, namespace=namespace)

    def build(self) -> None:
        """Read the parameters and make component and ports."""
        settings = declare(self, RecorderParameters)
        if settings.chooses and self.lockstep:
            raise StartError('topics, regex and all need pacing realtime: in lock step the vehicle is recorded')
        self._sink = make_sink(settings)
        self._failure: BagError | None = None
        self._snapshots: Service | None = None
        self._flushed = time.monotonic()
        self._recording: Recording
        if settings.chooses:
            self._recording = TopicRecording(self, settings, self._sink)
        else:
            self.connect()
            self._recording = VehicleRecording(self, self._sink, self.fail)
        if isinstance(self._sink, SnapshotBuffer):
            self._offer_snapshots(self._sink)

    def poll(self) -> None:
        """Flush what came, and finish when the recording is over.

        Raises
        ------
        BagError
            The bag can't be written any more; /diagnostics says so.
        """
        if not self.active:
            return
        if isinstance(self._recording, VehicleRecording):
            super().poll()
        try:
            self.finished = self._recording.poll()
            wall = time.monotonic()
            if wall - self._flushed >= FLUSH_PERIOD:
                self._flushed = wall
                self._sink.flush()
        except BagError as error:
            self.fail(error)
        if self._failure is not None:
            raise self._failure

    def miss(self, role: str, topics: list[str]) -> None:
        """Wait at the end for nothing more of a node that has died."""
        if isinstance(self._recording, VehicleRecording):
            self._recording.miss(topics)

    def wait(self) -> float:
        """Return for how long there is nothing to do but to take messages [s]."""
        return self._recording.period if self.active else super().wait()

    def fail(self, error: BagError) -> None:
        """Say on /diagnostics that the bag can't be written any more, and end with the next poll."""
        if self._failure is None:
            self._failure = error
            status = Status(ERROR, self.full_name, f'the recording has ended: {error}')
            self.say('/diagnostics', Diagnostics(self._recording.now(), (status,)))
            self.await_heard('/diagnostics')

    def finish(self) -> None:
        """Write what waits, close the bag, and say what was lost."""
        if self._snapshots is not None:
            self.destroy_service(self._snapshots)
        try:
            if self._failure is None:
                self._recording.end()
                self._sink.close()
        finally:
            print(self._recording.summary(), flush=True)

    def _offer_snapshots(self, sink: SnapshotBuffer) -> None:
        def answer(_: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
            try:
                response.message, response.success = sink.take(self._recording.take), True
            except BagError as error:
                response.message = str(error)
            return response

        self._snapshots = self.create_service(Trigger, '~/snapshot', answer)


def make_sink(settings: RecorderParameters) -> BagWriter | SnapshotBuffer:
    """Return what messages are written to.

    Raises
    ------
    BagError
        The directory exists, or can't be made.
    """
    split_time = round(settings.split_time * 1e9)
    if settings.snapshot:
        return SnapshotBuffer(
            settings.directory, settings.snapshot_size, round(settings.snapshot_time * 1e9),
            compression=settings.compression, split_size=settings.split_size, split_time=split_time,
        )
    return BagWriter(
        settings.directory, compression=settings.compression, split_size=settings.split_size, split_time=split_time
    )


def main() -> None:
    """Run the node until the scenario is over or a signal comes."""
    sys.exit(run(lambda context, exchange: [RecorderNode(context, exchange)]))
