"""A run in plain Python, without ROS: the components called one after the other, in lock step."""

from collections.abc import Callable
from pathlib import Path

from omni_vehicle_ros import interface
from omni_vehicle_ros.bags import Bag
from omni_vehicle_ros.bags.memory import MemoryWriter
from omni_vehicle_ros.bags.writer import BagWriter
from omni_vehicle_ros.components.component import Component, Output, Reporter
from omni_vehicle_ros.components.driver import Driver, Script
from omni_vehicle_ros.components.exact_side_slip import ExactSideSlip
from omni_vehicle_ros.components.faulty_component import FaultyComponent
from omni_vehicle_ros.components.icr_steering import IcrSteering
from omni_vehicle_ros.components.joints import ZEROS
from omni_vehicle_ros.components.journal import Journal
from omni_vehicle_ros.components.plant import Plant
from omni_vehicle_ros.components.side_slip_controller import SideSlipController
from omni_vehicle_ros.components.wheel_module import WheelModule
from omni_vehicle_ros.control.health import health
from omni_vehicle_ros.ending import Uninterrupted
from omni_vehicle_ros.errors import ScenarioError
from omni_vehicle_ros.interface import SIDE_SLIP_CONTROLLER, TOPICS, WHEEL_MODULES
from omni_vehicle_ros.messages import encode
from omni_vehicle_ros.scenarios import Scenario
from omni_vehicle_ros.wheels import WHEELS, PerWheel

ACKNOWLEDGE = 4


class Simulation:
    """All components of a scenario.

    Parameters
    ----------
    scenario
        What is run.
    take
        Called with every message, in the order in which it is said.
    namespace
        Of the vehicle.
    script
        What the driver goes by in place of the scenario's commands.
    publish_clock
        Whether the vehicle owns /clock.

    Raises
    ------
    ScenarioError
        Side-slip control with ideal actuators and gains that have no exact form.
    """

    def __init__(
        self,
        scenario: Scenario,
        take: Callable[[Output], None],
        namespace: str = '',
        script: Script | None = None,
        *,
        publish_clock: bool = True,
    ) -> None:
        period = scenario.plant.control_period
        self._take = take
        self.end = scenario.cycles * round(period * 1e9)
        self._acknowledge = ACKNOWLEDGE * round(period * 1e9)

        def name(role: str) -> str:
            return interface.resolve(role, namespace)

        gains = exact_gains(scenario)
        controlled = scenario.side_slip_control and gains is None
        self.plant = Plant(
            scenario.vehicle, scenario.plant, name=name(interface.PLANT), slip_gain=gains or ZEROS,
            publish_clock=publish_clock, steering=scenario.wheel_module,
        )
        modules = [
            WheelModule(
                role.split('/')[0], scenario.wheel_module, period, scenario.side_slip.trim_limit,
                trimmed=controlled, name=name(role),
            )
            for role in WHEEL_MODULES
        ]
        steering = IcrSteering(
            scenario.vehicle, scenario.steering, scenario.wheel_module, period, scenario.side_slip.trim_limit,
            lockstep=True, name=name(interface.ICR_STEERING),
        )
        # The order is that of the block diagram: who speaks first is heard by those after it in the same cycle.
        self._chain: list[tuple[str, Component]] = [
            (interface.DRIVER, Driver(scenario, script, name=name(interface.DRIVER))),
            (interface.ICR_STEERING, steering),
            *zip(WHEEL_MODULES, modules, strict=True),
        ]
        if scenario.side_slip_control:
            controller = (
                SideSlipController(scenario.side_slip, scenario.vehicle, name=name(SIDE_SLIP_CONTROLLER))
                if controlled
                else ExactSideSlip(scenario.side_slip, self.plant, name=name(SIDE_SLIP_CONTROLLER))
            )
            self._chain.insert(2, (SIDE_SLIP_CONTROLLER, controller))
        self._moving: Component = self.plant
        if scenario.faults or script is not None:
            self._moving = FaultyComponent(interface.PLANT, self.plant)
            self._chain = [(role, FaultyComponent(role, component)) for role, component in self._chain]
        hearers = [*self._chain, (interface.PLANT, self._moving)]
        self._hearers = {
            row.name: [component for role, component in hearers if role in row.subscribers] for row in TOPICS
        }
        if gains is not None:  # the trims are in the plant already
            self._hearers.update((f'{wheel}/trim', [steering]) for wheel in WHEELS)
        self._recorder = Reporter(name(interface.RECORDER))

    def run(self, progress: Callable[[float], None] = lambda time: None) -> None:
        """Run to the end of the scenario; call ``progress`` with the simulated time [s] now and then."""
        self._say(0, self.plant.begin())
        stamp, latest, recorded = 0, 0, -self._acknowledge
        while True:
            for _, component in self._chain:
                self._say(stamp, component.step(stamp))
            latest = max(latest, stamp)
            if latest - recorded >= self._acknowledge:
                recorded = latest
                self._say(stamp, self._recorder.report(recorded, health([], 'recording')))
                progress(recorded / 1e9)
            if stamp >= self.end:
                break
            outputs = self._moving.step(stamp)
            stamp = outputs[0].value.stamp
            self._say(stamp, outputs)
        progress(stamp / 1e9)

    def _say(self, now: int, outputs: list[Output]) -> None:
        """Hand messages to those who subscribe to them, as their nodes would do."""
        for output in outputs:
            self._take(output)
            topic, value = output
            for component in self._hearers[topic]:
                component.receive(topic, value, now)


def exact_gains(scenario: Scenario) -> PerWheel | None:
    """Return the gains of wheel_slip control where it is solved exactly: with ideal actuators and no faults; else None.

    Raises
    ------
    ScenarioError
        There are integral or derivative gains.
    """
    if not (scenario.side_slip_control and scenario.wheel_module.ideal_actuators) or scenario.faults:
        return None
    if scenario.side_slip.controller != 'wheel_slip':
        return None
    for name in ('integral_gains', 'derivative_gains'):
        gains = getattr(scenario.side_slip, name)
        if any(gains):
            raise ScenarioError(
                f'side_slip.{name}: {list(gains)} must be 0 with wheel_module.ideal_actuators, where the side slip '
                'is solved for exactly and has no past; set ideal_actuators: false'
            )
    return scenario.side_slip.proportional_gains


def simulate(
    scenario: Scenario,
    bag: Path,
    namespace: str = '',
    progress: Callable[[float], None] = lambda time: None,
    script: Script | None = None,
    *,
    publish_clock: bool = True,
) -> Journal:
    """Run a scenario offline, or what ``script`` says in it, and write its bag; return what the recording counted."""
    with Uninterrupted() as signals, BagWriter(bag) as writer:
        journal = Journal(writer, namespace, round(scenario.plant.control_period * 1e9))

        def advance(time: float) -> None:
            progress(time)
            signals.deliver()

        try:
            _run_into(journal, scenario, namespace, advance, script, publish_clock=publish_clock)
        finally:
            journal.flush()
    return journal


def record(scenario: Scenario) -> Bag:
    """Run a scenario offline and return its bag without a file: the messages that `simulate` writes."""
    writer = MemoryWriter()
    journal = Journal(writer, '', round(scenario.plant.control_period * 1e9))
    _run_into(journal, scenario, '', lambda time: None)
    journal.flush()
    return writer.bag(scenario.name)


def _run_into(
    journal: Journal,
    scenario: Scenario,
    namespace: str,
    progress: Callable[[float], None],
    script: Script | None = None,
    *,
    publish_clock: bool = True,
) -> None:
    types = {row.name: row.type for row in TOPICS}

    def take(output: Output) -> None:
        journal.add(output.topic, encode(types[output.topic], output.value))

    Simulation(scenario, take, namespace, script, publish_clock=publish_clock).run(progress)
