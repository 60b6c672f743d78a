"""Node ``plant``: the simulated vehicle, and the one that keeps the time."""

import json
import sys
import time

from rclpy.context import Context
from rclpy.lifecycle import LifecycleState, TransitionCallbackReturn

from omni_vehicle_ros import interface
from omni_vehicle_ros.components.component import Output
from omni_vehicle_ros.components.plant import Plant
from omni_vehicle_ros.components.punctuality import Lateness, Punctuality
from omni_vehicle_ros.errors import MessageError
from omni_vehicle_ros.messages import Text, Value, decode
from omni_vehicle_ros.model.warm import warm
from omni_vehicle_ros.nodes.declare import declare
from omni_vehicle_ros.nodes.exchange import Exchange
from omni_vehicle_ros.nodes.managed import StartError
from omni_vehicle_ros.nodes.process import run
from omni_vehicle_ros.nodes.shell import Shell
from omni_vehicle_ros.parameters import PlantParameters, VehicleParameters, WheelModuleParameters

RECORDER_WINDOW = 16
"""Cycles that the plant may run ahead of the recorder in lock step.

There are 23 messages in a cycle, and the shared memory of Fast DDS holds 512 for one process: with more of them on the
way some would be dropped, and sent again later than the publishers remember them.
"""


NEWCOMER = 5.0
LOOK_PERIOD = 0.5


class PlantNode(Shell):
    """Moves when all modules have answered (lock step) or when it is time (real time)."""

    def __init__(self, context: Context, exchange: Exchange, namespace: str | None = None) -> None:
        super().__init__(interface.PLANT, context=context, exchange=exchange, namespace=namespace)

    def build(self) -> None:
        """Read the parameters and make component and ports."""
        vehicle, plant = declare(self, VehicleParameters), declare(self, PlantParameters)
        steering = declare(self, WheelModuleParameters, only=('ideal_actuators', 'steer_rate_limit', 'steer_limit'))
        self._plant = Plant(
            vehicle, plant, name=self.full_name, publish_clock=self.pacing.publish_clock, steering=steering
        )
        # Where nothing is compiled yet, the others wait for it now, and not in their first cycle.
        warm(vehicle)
        self._tick = plant.control_period / self.pacing.realtime_factor
        self._state_timeout = round(plant.state_timeout * 1e9)
        self._punctuality = Punctuality(self._plant.sources, self._tick)
        self._lateness = Lateness(self._punctuality)
        self._states = dict.fromkeys(self._plant.sources, -self._state_timeout - 1)
        self._came = dict(self._states)
        self._ready: set[str] = set()
        self._begun = False
        self._looked = 0.0
        self._recorded, self._window = 0, RECORDER_WINDOW * self._plant.period
        self._recorder_lost = interface.RECORDER not in self.pacing.participants
        # In real time it moves by the clock, and not when states come.
        self.attach(self._plant, fetched=() if self.lockstep else self._plant.sources)
        self.subscribe(interface.topic('ready'), self._note_ready, latched=True, always=True)

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Begin when the others are ready, or go on where time stood still."""
        self._made = self._due = time.monotonic()
        answer = super().on_activate(state)
        if self._begun:
            self._punctuality.rest()
            self.publish(self._plant.begin(self.now))
        return answer

    def _note_ready(self, data: bytes) -> None:
        try:
            text: Text = decode(interface.topic('ready').type, data)
        except MessageError as error:
            self.warn(f'ready: {error}; the message is dropped')
            return
        if text.data in self.pacing.participants:
            self._ready.add(text.data)

    def take(self, topic: str, value: Value) -> None:
        """Take a message; note how far the modules and the recorder are."""
        if topic == 'recorder/step':
            self._recorded = max(self._recorded, value.stamp)
            self._recorder_lost = False
            self.act()
            return
        super().take(topic, value)

    def note(self, topic: str, value: Value) -> None:
        """Note a message, and when it came."""
        if not self.lockstep and topic in self._states:
            self._came[topic] = max(self._came[topic], min(value.stamp, self.now))
            self._punctuality.answer(topic, value.stamp, time.monotonic() - self.age)
        super().note(topic, value)

    def act(self) -> None:
        """In lock step, move as soon as the cycle is complete and the recorder is not far behind."""
        if self.lockstep and self._begun and (self._recorder_lost or not self._recorder_is_behind):
            super().act()

    @property
    def _recorder_is_behind(self) -> bool:
        return self.now - self._recorded > self._window

    def publish(self, outputs: list[Output]) -> None:
        """Publish what the sensors see, and open the cycle that begins with it."""
        super().publish(outputs)
        for topic, value in outputs:
            if topic == 'joint_states':
                if value.stamp != self.now + self._plant.period:
                    self._shift(value.stamp - self.now - self._plant.period)
                self.now = value.stamp
                self.gate.open(self.now)
                self._opened = time.monotonic()
                if not self.lockstep:
                    self._punctuality.tick(self.now, self._opened)

    def _shift(self, jump: int) -> None:
        """Follow the clock that has jumped, so that no state is older or newer by that [ns]."""
        self._came = {topic: stamp + jump for topic, stamp in self._came.items()}
        self._states = {topic: stamp + jump for topic, stamp in self._states.items()}

    def poll(self) -> None:
        """Begin, and in real time move when it is time."""
        if not self.active:
            return
        if time.monotonic() - self._made < NEWCOMER:
            self._look_for_another()
        if not self._begun:
            super().poll()
            self._begin()
        elif self.lockstep:
            if self._recorder_is_behind and time.monotonic() - self._opened > self.pacing.wait_limit:
                self._recorder_lost = True
            super().poll()
        elif time.monotonic() >= self._due:
            super().poll()
            self._move()

    def _look_for_another(self) -> None:
        """Give way to a plant that was there before: two of them would drive each other's modules."""
        wall = time.monotonic()
        if wall - self._looked < LOOK_PERIOD:
            return
        self._looked = wall
        topic = interface.resolve('joint_states', self.vehicle_namespace)
        if self.count_publishers(topic) > 1:
            raise StartError(f'another node publishes {topic}; choose another namespace or another ROS_DOMAIN_ID')

    def _begin(self) -> None:
        others = {*self.pacing.participants} - self._ready
        if self.lockstep and others:
            if time.monotonic() - self._made > self.pacing.start_limit:
                raise StartError(
                    f'not ready after {self.pacing.start_limit:g} s: {", ".join(sorted(others))}; are they running?'
                )
            return
        self._begun = True
        self._due = time.monotonic() + self._tick
        self.publish(self._plant.begin())

    def _move(self) -> None:
        """Take the latest from every module, unless it is too old; catch up with at most one late cycle."""
        self.fetch()
        self.gate.close()
        blocked = self.hand_over()
        self._states.update((topic, stamp) for topic, stamp in self._came.items() if topic not in blocked)
        oldest = self.now - self._state_timeout
        missing = tuple(topic for topic, stamp in self._states.items() if stamp < oldest)
        counted = self._punctuality
        self._plant.values = ('cycles', str(counted.cycles)), ('missed', str(counted.missed))
        self.publish(self._plant.step(self.now, missing))
        self._due = max(self._due + self._tick, time.monotonic() - self._tick)
        late = self._lateness.look(self._opened)
        if late is not None:
            level, text = late
            self._say_note('punctuality', text, level)

    def finish(self) -> None:
        """Print how punctual the modules were, for whoever writes a report."""
        if not self.lockstep:
            print(f'punctual {json.dumps(self._punctuality.figures())}', flush=True)

    def wait(self) -> float:
        """Return the time until the next move."""
        if self.lockstep or not self.active or not self._begun:
            return 0.02
        return max(self._due - time.monotonic(), 0.0)


def main() -> None:
    """Run the node until a signal comes."""
    sys.exit(run(lambda context, exchange: [PlantNode(context, exchange)]))
