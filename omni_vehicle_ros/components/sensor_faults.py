"""Sensors that drop out, lie or repeat themselves."""

from collections import deque
from random import Random

from omni_vehicle_ros.components.component import NANOSECONDS, Output
from omni_vehicle_ros.components.message_fault import changed
from omni_vehicle_ros.control.failing_actuator import broken_turn
from omni_vehicle_ros.faults import OK, Fault
from omni_vehicle_ros.messages import Flag, Imu, Joints, Odometry, Value


class SensorFaults:
    """What the sensors of the vehicle say in place of the truth, which goes out on a topic of its own meanwhile."""

    def __init__(self) -> None:
        self._faults: dict[str, SensorFault] = {}

    def fail(self, fault: Fault, now: int) -> None:
        """Let a sensor fail from ``now`` [ns] on, or be ok."""
        self._faults.pop(fault.component, None)
        if fault.failure != OK:
            self._faults[fault.component] = SensorFault(fault, now)

    def apply(self, stamp: int, outputs: list[Output]) -> list[Output]:
        """Return what is said at ``stamp`` [ns] in place of ``outputs``."""
        if not self._faults:
            return outputs
        said = []
        for output in outputs:
            fault = self._faults.get(output.topic)
            value = output.value if fault is None else fault.apply(stamp, output.value)
            said.append(output if value is output.value else Output(output.topic, value))
            if value is not output.value:
                said.append(Output(f'{output.topic}/truth', output.value))
        return said


class SensorFault:
    """What a fault makes of the messages of one sensor.

    Parameters
    ----------
    fault
        Of a sensor, other than ok.
    now
        When it began [ns].
    """

    def __init__(self, fault: Fault, now: int) -> None:
        self._fault, self._begun = fault, now
        self._seen: deque[tuple[int, Value]] = deque()

    def apply(self, stamp: int, value: Value) -> Value:
        """Return what the sensor says; ``value`` itself where that is the truth."""
        fault, age = self._fault, stamp - self._begun
        if fault.failure == 'off' or (fault.failure == 'intermittent' and broken_turn(fault, age)):
            return empty(value)
        if fault.failure == 'wrong':
            return changed(value, lambda number: fault.value * number)
        if fault.failure == 'garbage':
            random = Random(f'{fault.component} {age}')
            return changed(value, lambda number: random.uniform(-fault.value, fault.value))
        if fault.failure in ('stuck', 'delayed'):
            return self._past(stamp, value)
        return value

    def _past(self, stamp: int, value: Value) -> Value:
        """Return what was seen a while ago, or first."""
        seen = self._seen
        seen.append((stamp, value))
        if self._fault.failure == 'stuck':
            return _stamped(seen[0][1], stamp)
        while len(seen) > 1 and seen[1][0] <= stamp - round(self._fault.value * NANOSECONDS):
            seen.popleft()
        return _stamped(seen[0][1], stamp)


def _stamped(value: Value, stamp: int) -> Value:
    return value if isinstance(value, Flag) else value._replace(stamp=stamp)


def empty(value: Value) -> Value:
    """Return a message that says nothing but when: no numbers in arrays; else zeros, and no frame."""
    if isinstance(value, Joints):
        return value._replace(position=(), velocity=(), effort=())
    value = changed(value, lambda number: 0.0)
    return value._replace(frame='') if isinstance(value, Odometry | Imu) else value
