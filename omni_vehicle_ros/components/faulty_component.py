"""A component with faults between it and all others, for runs without processes."""

from omni_vehicle_ros.components.component import Component, Output
from omni_vehicle_ros.components.inbox import Inbox
from omni_vehicle_ros.faults import FAULTS
from omni_vehicle_ros.messages import Value


class FaultyComponent:
    """Keeps the messages of a component for its next cycle and gives it what faults leave of them.

    A process that was killed or frozen is silent; one that answers late in wall time is not late here.

    Parameters
    ----------
    role
        Node of the component.
    component
        Who acts.
    """

    def __init__(self, role: str, component: Component) -> None:
        self.name, self.beat, self.sources = component.name, component.beat, component.sources
        self._component = component
        self._inbox = Inbox(role, component, fault_injection=True)
        self._heard: set[str] = set()

    def receive(self, topic: str, value: Value, now: int) -> None:
        """Take a message that came in."""
        self._inbox.put(topic, value)
        self._heard.add(topic)

    def step(self, stamp: int, missing: tuple[str, ...] = ()) -> list[Output]:
        """Act on the cycle that began at ``stamp`` [ns]; say nothing if the process is dead or frozen."""
        self._heard.difference_update(self._inbox.hand_over(stamp))
        heard, self._heard = self._heard, set()
        if self._inbox.silent:
            return []
        outputs = self._component.step(stamp, tuple(source for source in self.sources if source not in heard))
        for topic, value in outputs:
            if topic == FAULTS:  # what a driver says of itself
                self._inbox.inject(value, stamp)
        return outputs
