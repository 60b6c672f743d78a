"""What the driver wants now: one valid source at a time holds, and each is watched for its age.

There are four sources: driver/icr with driver/speed, driver/icr with driver/traction, teleop/cmd_vel, and
cmd_vel; `omni_vehicle_ros.control.arbitration` chooses. The speed, the traction or the twist carries the
heartbeat. The ICR is latched: it need be said once only, and is straight on before.
"""

import math
from typing import NamedTuple

from omni_vehicle_ros.control.arbitration import Arbitration, Source
from omni_vehicle_ros.control.commands import (
    PointCommand,
    TractionDemand,
    TwistCommand,
    TwistDemand,
    WrenchCommand,
    check_cmd_vel,
    check_icr,
    check_speed,
    check_traction,
)
from omni_vehicle_ros.control.freshness import NANOSECONDS, Freshness
from omni_vehicle_ros.control.health import ERROR, WARN
from omni_vehicle_ros.control.motion import STRAIGHT, Motion, magnitude_of_speed
from omni_vehicle_ros.errors import CommandError
from omni_vehicle_ros.parameters import SteeringParameters, VehicleParameters

REFUSAL_SHOWN = NANOSECONDS
"""How long a refusal is reported [ns]."""


class Demand(NamedTuple):
    """What the driver wants.

    Attributes
    ----------
    motion
        Direction to turn to; None: stay with the present one.
    magnitude
        Signed magnitude of the motion [m/s].
    traction
        Open-loop traction in place of the magnitude, if any.
    limit
        Largest magnitude that faults of the vehicle allow [m/s].
    """

    motion: Motion | None
    magnitude: float
    traction: TractionDemand | None = None
    limit: float = math.inf

    @property
    def rest(self) -> bool:
        """Whether nothing is to move: no speed, no traction, no yaw moment."""
        traction = self.traction
        return not self.magnitude and (traction is None or (traction.force <= 0.0 and not traction.yaw_moment))


class Driver:
    """Takes the commands of all sources and says what holds.

    Parameters
    ----------
    vehicle, steering
        Geometry; limits and time-out.
    """

    def __init__(self, vehicle: VehicleParameters, steering: SteeringParameters) -> None:
        self._vehicle = vehicle
        self._steering = steering
        self.forget()

    def forget(self) -> None:
        """Begin anew, as if no command had ever come."""
        self._arbitration = Arbitration(self._steering.command_timeout)
        self._icr: Motion | None = None
        self._lost = False  # the driver has said where to turn, but never to where that can be
        self._speed = 0.0
        self._traction = TractionDemand(0.0, 0.0, '')
        self._twists = dict.fromkeys((Source.TELEOP, Source.CMD_VEL), TwistDemand(None, 0.0, ''))
        self._refused: dict[str, tuple[str, int]] = {}
        self._clamped: dict[Source, str] = {}

    def icr(self, command: PointCommand, now: int) -> None:
        """Take an ICR that came in at ``now`` [ns]; a bad one is refused and the last good one kept."""
        try:
            self._icr = check_icr(command, self._vehicle, self._steering)
        except CommandError as error:
            self._lost = self._icr is None
            self._refuse('driver/icr', error, now)
        else:
            self._lost = False
            self._refused.pop('driver/icr', None)

    def speed(self, command: TwistCommand, now: int) -> None:
        """Take a speed that came in at ``now`` [ns]; a bad one is refused and the last good one kept."""
        try:
            self._speed, warning = check_speed(command, self._steering)
        except CommandError as error:
            self._refuse(Source.SPEED.topic, error, now)
        else:
            self._accept(Source.SPEED, command.stamp, now, warning)

    def traction(self, command: WrenchCommand, now: int) -> None:
        """Take a traction that came in at ``now`` [ns]; a bad one is refused and the last good one kept."""
        try:
            self._traction = check_traction(command, self._vehicle, self._steering)
        except CommandError as error:
            self._refuse(Source.TRACTION.topic, error, now)
        else:
            self._accept(Source.TRACTION, command.stamp, now, self._traction.warning)

    def cmd_vel(self, command: TwistCommand, now: int) -> None:
        """Take a twist of autonomy that came in at ``now`` [ns]; a bad one is refused and the last good one kept."""
        self._take_twist(Source.CMD_VEL, command, now)

    def teleop(self, command: TwistCommand, now: int) -> None:
        """Take a twist of a hand that came in at ``now`` [ns]; a bad one is refused and the last good one kept."""
        self._take_twist(Source.TELEOP, command, now)

    def _take_twist(self, source: Source, command: TwistCommand, now: int) -> None:
        try:
            twist = check_cmd_vel(command, self._vehicle, self._steering, source.topic)
        except CommandError as error:
            self._refuse(source.topic, error, now)
        else:
            self._twists[source] = twist
            self._accept(source, command.stamp, now, twist.warning)

    def demand(self, now: int) -> Demand:
        """Return what holds at ``now`` [ns].

        Without any source an ICR alone steers, at speed 0. A stale source wants speed 0 and no other angles.
        """
        source = self._arbitration.choose(now)
        if source is None:
            return Demand(self._icr, 0.0)
        if self.state(now) is Freshness.STALE:
            return Demand(None, 0.0)
        if source in self._twists:
            return Demand(self._twists[source].motion, self._twists[source].magnitude)
        if self._lost:
            return Demand(None, 0.0)
        if source is Source.TRACTION:
            return Demand(self._icr or STRAIGHT, 0.0, self._traction)
        if self._icr is None:
            return Demand(STRAIGHT if self._speed else None, self._speed)
        return Demand(self._icr, magnitude_of_speed(self._icr, self._speed))

    def state(self, now: int) -> Freshness:
        """Return whether the source that holds is fresh at ``now`` [ns]."""
        return self._arbitration.state(now)

    @property
    def source(self) -> str:
        """Topic of the source that holds; empty if there is none yet."""
        source = self._arbitration.source
        return '' if source is None else source.topic

    def notes(self, now: int) -> list[tuple[int, str]]:
        """Return levels and messages of what is wrong at ``now`` [ns]."""
        notes = [(ERROR, text) for text, when in self._refused.values() if now - when <= REFUSAL_SHOWN]
        source = self._arbitration.source
        if source is None:
            return notes
        for other in self._arbitration.ignored(now):
            text = f'{other.topic} is ignored: {source.topic} holds, and {source.kind} goes before {other.kind}'
            notes.append((WARN, text))
        if self.state(now) is Freshness.STALE:
            limit = self._steering.command_timeout
            text = f'{source.topic} is older than command_timeout, {limit:g} s: speed goes to 0, steer angles hold'
            return [*notes, (WARN, text)]
        if self._clamped.get(source):
            notes.append((WARN, self._clamped[source]))
        if self._arbitration.warning:
            notes.append((WARN, f'{source.topic}: {self._arbitration.warning}'))
        return notes

    def _refuse(self, topic: str, error: CommandError, now: int) -> None:
        holds = 'no ICR before it was good, so the commanded speed is 0' if self._lost else 'the last good one holds'
        self._refused[topic] = f'{error}; refused, {holds}', now

    def _accept(self, source: Source, stamp: int, now: int, warning: str) -> None:
        self._refused.pop(source.topic, None)
        self._clamped[source] = warning
        self._arbitration.received(source, stamp, now)
