"""What the driver of a scenario publishes in each control cycle: a pure function of the scenario."""

from bisect import bisect_right
from typing import Any

from omni_vehicle_ros import messages
from omni_vehicle_ros.faults import FAULTS, Fault, faults_message
from omni_vehicle_ros.scenarios.commands import Command
from omni_vehicle_ros.scenarios.environment import EnvironmentChange, EnvironmentProfile
from omni_vehicle_ros.scenarios.scenario import Scenario, whole_cycles
from omni_vehicle_ros.wheels import WHEELS

Message = tuple[str, Any]


class DriverScript:
    """The messages of a scenario's driver.

    Commands go out when they begin and then every ``command_period``; the environment at the start and in every
    cycle in which it changes, so that a recording holds what acted; faults when they begin and end. Stamps are
    those of the cycles, exact in nanoseconds.

    Parameters
    ----------
    scenario
        What to play.
    """

    trouble = ''

    def __init__(self, scenario: Scenario) -> None:
        period = scenario.plant.control_period
        self._period_ns = round(period * 1e9)
        self._repeat = max(1, round(scenario.command_period / period))
        self._straight = 10.0 * scenario.steering.straight_radius
        self._commands = scenario.commands
        self._starts = [whole_cycles(command.at, period) for command in scenario.commands]
        self._steps = _steps(scenario)
        self._faults = _faults(scenario)
        profiles = (entry for entry in scenario.environment if isinstance(entry, EnvironmentProfile))
        self._profiles = [(whole_cycles(p.at, period), whole_cycles(p.end, period), p) for p in profiles]

    def messages(self, cycle: int) -> list[Message]:
        """Return what to publish in a cycle.

        Parameters
        ----------
        cycle
            Number of the control cycle, from 0.

        Returns
        -------
        list of (str, value)
            Topics, as in the wiring table, and values of `omni_vehicle_ros.messages`.
        """
        stamp = cycle * self._period_ns
        around = {**self._profile_messages(cycle), **self._steps.get(cycle, {})}
        said = [(topic, value._replace(stamp=stamp)) for topic, value in around.items()]
        if cycle in self._faults:
            said.append((FAULTS, faults_message(stamp, self._faults[cycle])))
        current = bisect_right(self._starts, cycle) - 1
        if current >= 0 and (cycle - self._starts[current]) % self._repeat == 0:
            said += self._command(self._commands[current], stamp)
        return said

    def _profile_messages(self, cycle: int) -> dict[str, Any]:
        """Return the messages, without stamps, of the profiles that change from the cycle before to this one."""
        said: dict[str, Any] = {}
        for first, last, profile in self._profiles:
            if first < cycle <= last:
                before = (cycle - 1) * self._period_ns * 1e-9
                now = profile.end if cycle == last else cycle * self._period_ns * 1e-9
                if profile.values(now) != profile.values(before):
                    said |= _environment_messages(profile.change(now))
        return said

    def _command(self, command: Command, stamp: int) -> list[Message]:
        stop = command.emergency_stop
        said: list[Message] = [] if stop is None else [('emergency_stop', messages.Flag(stop))]
        return said + self._motion(command, stamp)

    def _motion(self, command: Command, stamp: int) -> list[Message]:
        """Return what says where to go."""
        if command.twist is not None:
            topic = 'teleop/cmd_vel' if command.cmd_vel is None else 'cmd_vel'
            return [(topic, messages.Twist(stamp, *command.twist))]
        if command.icr is None:
            return []
        x, y = (0.0, self._straight) if isinstance(command.icr, str) else command.icr
        icr = ('driver/icr', messages.Point(stamp, x, y))
        if command.speed is not None:
            return [icr, ('driver/speed', messages.Twist(stamp, command.speed))]
        return [icr, ('driver/traction', messages.Wrench(stamp, command.traction or 0.0, tz=command.yaw_moment))]


def _steps(scenario: Scenario) -> dict[int, dict[str, Any]]:
    """Return messages without stamps by cycle and topic: all in cycle 0, then steps and the begin of profiles."""
    plant, period = scenario.plant, scenario.plant.control_period
    by_cycle = {0: _environment_messages(EnvironmentChange(0.0, plant.bank, plant.wind, plant.friction))}
    for entry in scenario.environment:
        cycle, last = whole_cycles(entry.at, period), whole_cycles(entry.end, period)
        if isinstance(entry, EnvironmentProfile):
            entry = entry.change(entry.end if cycle == last else cycle * period)
        by_cycle.setdefault(cycle, {}).update(_environment_messages(entry))
    return by_cycle


def _faults(scenario: Scenario) -> dict[int, list[Fault]]:
    """Return by cycle what fails in it, after what is ok again."""
    period = scenario.plant.control_period
    by_cycle: dict[int, list[Fault]] = {}
    for event in scenario.faults:
        if event.lasting is not None:
            by_cycle.setdefault(whole_cycles(event.end, period), []).append(Fault(event.fault.component))
    for event in scenario.faults:
        by_cycle.setdefault(whole_cycles(event.at, period), []).append(event.fault)
    return by_cycle


def _environment_messages(change: EnvironmentChange) -> dict[str, Any]:
    said: dict[str, Any] = {}
    if change.bank is not None:
        said['environment/bank'] = messages.Vector(0, change.bank, 0.0)
    if change.wind is not None:
        said['environment/wind'] = messages.Vector(0, 0.0, change.wind)
    if change.friction is not None:
        said['environment/friction'] = messages.Joints(0, WHEELS, effort=change.friction)
    return said
