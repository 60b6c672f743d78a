"""A bag, surveyed: all that a report says, gathered in one reading and in bounded memory."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from omni_vehicle_ros.analysis.signals import Array
from omni_vehicle_ros.analysis.stream.envelope import Envelope, Times
from omni_vehicle_ros.analysis.stream.events import Complaints, Heartbeat, Spans
from omni_vehicle_ros.analysis.stream.grip import GRAVITY, BodyMotion, GripMap, tyre_use
from omni_vehicle_ros.analysis.stream.join import Join
from omni_vehicle_ros.analysis.stream.limits import Limits
from omni_vehicle_ros.analysis.stream.path import PathTrace
from omni_vehicle_ros.analysis.stream.reading import BagReader, Progress
from omni_vehicle_ros.analysis.stream.response import Response
from omni_vehicle_ros.analysis.stream.roles import Roles
from omni_vehicle_ros.analysis.stream.statistics import RunningStatistics
from omni_vehicle_ros.analysis.stream.timing import TopicTiming
from omni_vehicle_ros.analysis.stream.traces import (
    STEER_JOINTS,
    TRACES,
    Trace,
    by_name,
    other_joints,
    wheel_forces,
)
from omni_vehicle_ros.bags import Columns
from omni_vehicle_ros.wheels import WHEELS

HEARTBEATS = ('driver/speed', 'driver/traction', 'teleop/cmd_vel', 'cmd_vel')
NONSENSE = 1e30
"""Numbers as large as this come of damage; their squares could still be summed up."""
MOST_TOPICS = 500
"""Topics whose timing is followed."""


@dataclass(frozen=True)
class Signals:
    """The signals of a trace: their course and their statistics."""

    trace: Trace
    envelope: Envelope
    statistics: RunningStatistics


class Survey:
    """What is known of a bag; grows with `add`, and is whole after `finish`.

    Parameters
    ----------
    path
        Of the bag.
    limits
        Of the vehicle.
    namespace
        Of the vehicle; None: the one that there is.

    Attributes
    ----------
    signals
        By the name of the trace.
    timing
        By the full name of the topic.
    responses
        By what responds.
    tyre_grip, body_grip
        g-g diagrams: of each tyre, in shares of friction times load; of the body, in g, by imu or else by odom.
    path
        The motion over ground.
    spans, complaints, heartbeat
        Where events come from.
    """

    def __init__(self, path: Path, limits: Limits, namespace: str | None = None) -> None:
        self.bag, self.limits = path, limits
        self.roles = Roles(path, namespace)
        self.signals: dict[str, Signals] = {}
        self.timing: dict[str, TopicTiming] = {}
        self.types: dict[str, str] = {}
        self.counts: dict[str, int] = {}
        self.unreadable: dict[str, str] = {}
        self.damage: tuple[str, ...] = ()
        self.path = PathTrace()
        self.tyre_grip, self.body_grip = tuple(GripMap() for _ in WHEELS), GripMap()
        self.spans = _Watch(limits)
        self.complaints = Complaints()
        self._motion = BodyMotion()
        self.heartbeat = Heartbeat(limits.command_timeout)
        self.responses = {'steer_angle': Response(4), 'twist': Response(3)}
        self._steer = Join((1,) * 8, self._take_steer)
        self._twist = Join((3,), self._take_twist)
        self._force = Join((4,), self._take_force)
        self._friction = np.array(limits.friction)

    def add(self, topic: str, columns: Columns) -> None:
        """Take the next messages of a topic, by its full name."""
        if topic in self.timing or len(self.timing) < MOST_TOPICS:
            self.timing.setdefault(topic, TopicTiming()).add(columns.stamp_ns, columns.log_time_ns)
        role = self.roles.role(topic, columns.type_name)
        if role is None:
            return
        columns = without_nonsense(columns)
        times = np.where(columns.stamp_ns == 0, columns.log_time_ns, columns.stamp_ns)
        self._follow(role, times, columns)
        if role in HEARTBEATS:
            self.heartbeat.add(role, times)
        if role == '/diagnostics':
            self.complaints.add(times, columns.statuses)
        self._join(role, times, columns)

    def _follow(self, role: str, times: Times, columns: Columns) -> None:
        traces = TRACES.get(role, ())
        if role == 'joint_states' and not any(name in STEER_JOINTS for name in columns.names):
            traces = other_joints(columns) if 'joint_position' not in self.signals else tuple(
                self.signals[name].trace for name in ('joint_position', 'joint_velocity'))
        for trace in traces:
            width = len(trace.labels)
            signals = self.signals.setdefault(trace.name, Signals(trace, Envelope(width), RunningStatistics(width)))
            values = trace.read(columns)
            signals.envelope.add(times, values)
            signals.statistics.add(times, values)
            self.spans.add(trace.name, times, values)

    def _join(self, role: str, times: Times, columns: Columns) -> None:
        """Bring together what belongs together."""
        wheel, _, what = role.partition('/')
        if role == 'odom':
            self.path.add(times, columns)
            self._motion.add(times, columns.vx, columns.vy, columns.yaw_rate)
            self._twist.add(times, np.column_stack([columns.vx, columns.vy, columns.yaw_rate]))
        elif role == 'commanded_twist':
            self._twist.add_other(0, times, np.column_stack([columns.vx, columns.vy, columns.yaw_rate]))
        elif role == 'joint_states':
            angles = by_name(columns, 'position', STEER_JOINTS)
            if np.isfinite(angles).any():
                self.path.add_angles(times, angles)
                self._steer.add(times, angles)
        elif what in ('command', 'trim') and wheel in WHEELS:
            place = WHEELS.index(wheel)
            angle = by_name(columns, 'position', STEER_JOINTS[place : place + 1])
            self._steer.add_other(place + 4 * (what == 'trim'), times, angle)
        elif role == 'tyres/force':
            self._force.add(times, wheel_forces(columns).reshape(len(columns), 12))
        elif role == 'environment/friction':
            self._force.add_other(0, times, by_name(columns, 'effort', WHEELS))
        elif role == 'imu':
            self.body_grip.add(columns.ax / GRAVITY, columns.ay / GRAVITY)

    def _take_steer(self, times: Times, angles: Array, beside: Array) -> None:
        trims = np.where(np.isfinite(beside[:, 4:]), beside[:, 4:], 0.0)
        self.responses['steer_angle'].add(times, angles, beside[:, :4] + trims)

    def _take_twist(self, times: Times, twist: Array, commanded: Array) -> None:
        self.responses['twist'].add(times, twist, commanded)

    def _take_force(self, times: Times, rows: Array, friction: Array) -> None:
        known = np.isfinite(friction)
        changes = np.where(known, friction, self._friction)
        self._friction = changes[-1]
        along, across = tyre_use(rows.reshape(-1, 4, 3), changes)
        for wheel, grip in enumerate(self.tyre_grip):
            grip.add(along[:, wheel], across[:, wheel])

    def finish(self, reader: BagReader) -> None:
        """Say that all messages have come, and what the reader met."""
        for join in (self._steer, self._twist, self._force):
            join.finish()
        for timing in self.timing.values():
            timing.finish()
        if not self._has('imu'):
            self.body_grip = self._motion.grip
        self.spans.finish()
        self.complaints.finish()
        self.types, self.counts, self.unreadable = dict(reader.types), dict(reader.counts), dict(reader.unreadable)
        self.damage = tuple(reader.damage)

    @property
    def span(self) -> tuple[int, int]:
        """First and last stamp of what the vehicle said, else of any topic [ns]."""
        found = [self.timing[self.roles.topics[role]] for role in ('odom', 'joint_states', 'imu') if self._has(role)]
        found = found or [entry for entry in self.timing.values() if entry.cyclic] or list(self.timing.values())
        return (min(entry.first for entry in found), max(entry.last for entry in found)) if found else (0, 0)

    def _has(self, role: str) -> bool:
        return self.roles.topics.get(role) in self.timing


def without_nonsense(columns: Columns) -> Columns:
    """Return columns in which numbers beyond `NONSENSE`, which no physical quantity is, are NaN."""
    arrays = {
        name: np.where(np.abs(array) < NONSENSE, array, np.nan) if array.dtype == np.float64 else array
        for name, array in columns.arrays.items()
    }
    return replace(columns, arrays=arrays)


class _Watch:
    """Watches the signals for limits that are reached, and for wheels without load."""

    def __init__(self, limits: Limits) -> None:
        self._tests = limits.tests()
        self.found: dict[tuple[str, str], Spans] = {}

    def add(self, name: str, times: Times, values: Array) -> None:
        """Take samples of a trace."""
        for test in self._tests.get(name, ()):
            for place, wheel in enumerate(WHEELS if values.shape[1] == 4 else (name.rpartition('.')[2],)):
                spans = self.found.setdefault((wheel, test.text), Spans(test.kind, wheel, test.text))
                spans.add(times, test.so(values[:, place]))

    def finish(self) -> None:
        """Say that all samples have come."""
        for spans in self.found.values():
            spans.finish()


def survey_bag(
    path: Path, limits: Limits, *, namespace: str | None = None, progress: Progress = lambda read: None,
    reader: BagReader | None = None,
) -> Survey:
    """Read a bag from begin to end, and return what it says.

    Parameters
    ----------
    path
        A bag directory or file.
    limits
        Of the vehicle.
    namespace
        Of the vehicle; None: the one that there is.
    progress
        Called with what was read [MB].
    reader
        Of the bag, if there is one already.

    Raises
    ------
    BagError
        There is no such bag, it can't be read, it holds no message that could be analysed, or several vehicles.
    """
    reader = reader or BagReader(path)
    survey = Survey(path, limits, namespace)
    for topic, columns in reader.blocks(progress):
        survey.add(topic, columns)
    survey.finish(reader)
    return survey
