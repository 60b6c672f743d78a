"""What the driver of a scenario publishes in each control cycle: a pure function of the scenario."""

from bisect import bisect_right
from typing import Any

from omni_vehicle_ros import messages
from omni_vehicle_ros.scenarios.commands import Command, EnvironmentChange
from omni_vehicle_ros.scenarios.scenario import Scenario, whole_cycles
from omni_vehicle_ros.wheels import WHEELS

Message = tuple[str, Any]


class DriverScript:
    """The messages of a scenario's driver.

    Commands go out when they begin and then every ``command_period``; the environment at the start and when
    it changes, so that a recording holds what acted. Stamps are those of the cycles, exact in nanoseconds.

    Parameters
    ----------
    scenario
        What to play.
    """

    def __init__(self, scenario: Scenario) -> None:
        period = scenario.plant.control_period
        self._period_ns = round(period * 1e9)
        self._repeat = max(1, round(scenario.command_period / period))
        self._straight = 10.0 * scenario.steering.straight_radius
        self._commands = scenario.commands
        self._starts = [whole_cycles(command.at, period) for command in scenario.commands]
        self._environment = _environment_messages(scenario)

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
        said = [(topic, value._replace(stamp=stamp)) for topic, value in self._environment.get(cycle, ())]
        current = bisect_right(self._starts, cycle) - 1
        if current >= 0 and (cycle - self._starts[current]) % self._repeat == 0:
            said += self._command(self._commands[current], stamp)
        return said

    def _command(self, command: Command, stamp: int) -> list[Message]:
        if command.cmd_vel is not None:
            return [('cmd_vel', messages.Twist(stamp, *command.cmd_vel))]
        if command.icr is None:
            return []
        x, y = (0.0, self._straight) if isinstance(command.icr, str) else command.icr
        icr = ('driver/icr', messages.Point(stamp, x, y))
        if command.speed is not None:
            return [icr, ('driver/speed', messages.Twist(stamp, command.speed))]
        return [icr, ('driver/traction', messages.Wrench(stamp, command.traction or 0.0, tz=command.yaw_moment))]


def _environment_messages(scenario: Scenario) -> dict[int, list[Message]]:
    """Return the messages about the environment, without stamps, by cycle; cycle 0 has all of them."""
    plant = scenario.plant
    start = EnvironmentChange(0.0, plant.bank, plant.wind, plant.friction)
    by_cycle: dict[int, dict[str, Any]] = {}
    for change in (start, *scenario.environment):
        said = by_cycle.setdefault(whole_cycles(change.at, plant.control_period), {})
        if change.bank is not None:
            said['environment/bank'] = messages.Vector(0, change.bank, 0.0)
        if change.wind is not None:
            said['environment/wind'] = messages.Vector(0, 0.0, change.wind)
        if change.friction is not None:
            said['environment/friction'] = messages.Joints(0, WHEELS, effort=change.friction)
    return {cycle: list(said.items()) for cycle, said in by_cycle.items()}
