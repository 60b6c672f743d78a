"""Node ``driver``: plays the commands and the environment of a scenario, or those of a bag."""

import sys
import time
from pathlib import Path

from rclpy.context import Context

from omni_vehicle_ros import interface
from omni_vehicle_ros.components.component import Output
from omni_vehicle_ros.components.driver import Driver
from omni_vehicle_ros.components.recorded_commands import RecordedCommands
from omni_vehicle_ros.faults import FAULTS
from omni_vehicle_ros.nodes.declare import declare_plain
from omni_vehicle_ros.nodes.exchange import Exchange
from omni_vehicle_ros.nodes.process import run
from omni_vehicle_ros.nodes.shell import Shell
from omni_vehicle_ros.scenarios import load_scenario

PROGRESS_PERIOD = 0.1


class DriverNode(Shell):
    """Says what the scenario or the bag says, when it says it; prints the simulated time on standard output."""

    def __init__(self, context: Context, exchange: Exchange, namespace: str | None = None) -> None:
        super().__init__(interface.DRIVER, context=context, exchange=exchange, namespace=namespace)

    def build(self) -> None:
        """Read the parameters and make component and ports."""
        scenario = load_scenario(str(declare_plain(self, 'scenario', 'demo')))
        bag = str(declare_plain(self, 'commands', ''))
        script = RecordedCommands(Path(bag), scenario) if bag else None
        restarted = bool(declare_plain(self, 'restarted', False))
        self._driver = Driver(scenario, script, name=self.full_name, restarted=restarted)
        self._printed = 0.0
        self.attach(self._driver)

    def publish(self, outputs: list[Output]) -> None:
        """Publish, and print how far the scenario is, for whoever shows a progress bar."""
        super().publish(outputs)
        for topic, value in outputs:
            if topic == FAULTS:
                self._inbox.inject(value, self.now)
        wall = time.monotonic()
        if wall - self._printed > PROGRESS_PERIOD or self.now >= self._driver.end:
            self._printed = wall
            print(f'time {self.now / 1e9:.3f}', flush=True)


def main() -> None:
    """Run the node until a signal comes."""
    sys.exit(run(lambda context, exchange: [DriverNode(context, exchange)]))
