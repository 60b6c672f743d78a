"""The driver of a scenario: says what its script, or a bag in its place, says, when it says it."""

from typing import Protocol

from omni_vehicle_ros.components.component import ERROR, Output, Reporter
from omni_vehicle_ros.control.health import health
from omni_vehicle_ros.faults import FAULTS
from omni_vehicle_ros.interface import TOPICS
from omni_vehicle_ros.messages import Step, Value
from omni_vehicle_ros.scenarios.scenario import Scenario
from omni_vehicle_ros.scenarios.script import DriverScript, Message

_ORDER = {row.name: number for number, row in enumerate(TOPICS)} | {FAULTS: -1}
_REPEATED = ('driver/icr', 'driver/speed', 'driver/traction', 'cmd_vel')

CATCH_UP = 40
"""Cycles of which commands are still said after the clock has jumped: what is older, newer ones have replaced."""


class Script(Protocol):
    """What a driver goes by."""

    trouble: str
    """Why it does not say all that it should, if so."""

    def messages(self, cycle: int) -> list[Message]:
        """Return what to publish in a cycle; asked for one after the other."""


class Driver:
    """Plays commands and environment on the stamps of the plant.

    Parameters
    ----------
    scenario
        Gives period and end, and the commands if there is no ``script``.
    script
        To go by in place of the scenario's own.
    name
        Full name of the node, for diagnostics.
    restarted
        Whether another has driven before: the faults of cycles before its first one are not said again.
    """

    beat = 'joint_states'
    sources: tuple[str, ...] = ()

    def __init__(
        self, scenario: Scenario, script: Script | None = None, *, name: str = '/driver', restarted: bool = False
    ) -> None:
        self.name = name
        self._restarted = restarted
        self.end = scenario.cycles * round(scenario.plant.control_period * 1e9)
        self._script: Script = script or DriverScript(scenario)
        self._period = round(scenario.plant.control_period * 1e9)
        self._next_cycle = 0
        self._reporter = Reporter(name)

    def receive(self, topic: str, value: Value, now: int) -> None:
        """Take the beat; a driver looks at nothing but the time."""

    def step(self, stamp: int, missing: tuple[str, ...] = ()) -> list[Output]:
        """Return the commands of every cycle up to ``stamp`` [ns] that were not yet said."""
        cycle = stamp // self._period
        troubles = [(ERROR, self._script.trouble)] if self._script.trouble else []
        outputs = self._reporter.report(stamp, health(troubles, 'playing'))
        for passed in range(self._next_cycle, cycle + 1):
            said = sorted(self._script.messages(passed), key=lambda message: _ORDER[message[0]])
            if passed < cycle - CATCH_UP:
                said = [message for message in said if message[0] not in _REPEATED]
            if passed < cycle and self._restarted:
                said = [message for message in said if message[0] != FAULTS]
            outputs += [Output(topic, value) for topic, value in said]
        self._restarted = False
        self._next_cycle = max(self._next_cycle, cycle + 1)
        topics = tuple(output.topic for output in outputs if output.topic != '/diagnostics')
        outputs.append(Output('driver/step', Step(stamp, self.end, topics)))
        return outputs
