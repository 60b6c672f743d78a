"""The commands and the environment of a bag, in the place of those of a scenario."""

from collections.abc import Iterator
from pathlib import Path

from omni_vehicle_ros.bags.mcap.file_reader import RecordedMessage
from omni_vehicle_ros.bags.source import open_source
from omni_vehicle_ros.errors import BagError, MessageError
from omni_vehicle_ros.interface import ANYONE, DRIVER, TOPICS
from omni_vehicle_ros.messages import decode
from omni_vehicle_ros.scenarios.scenario import Scenario
from omni_vehicle_ros.scenarios.script import Message

COMMANDS = {row.name: row.type for row in TOPICS if {DRIVER, ANYONE} <= {*row.publishers}}
"""What a driver, or anyone, tells a vehicle: type by topic, relative to its namespace."""


def command_of(topic: str) -> tuple[str, str] | None:
    """Return the namespace of a vehicle, and which command to it a topic, given by its full name, is, if any."""
    for name in sorted(COMMANDS, key=len, reverse=True):  # cmd_vel is the end of another one, too
        if topic.endswith(f'/{name}'):
            return topic.removesuffix(f'/{name}'), name
    return None


class RecordedCommands:
    """The commands of a vehicle's bag, cycle by cycle; a bag of any size takes no more memory than a small one.

    Each is said in the cycle at which it was recorded, in simulated time, as the same bytes as long as it holds
    nothing but what the vehicle uses.

    Parameters
    ----------
    bag
        A bag of a run: its messages were recorded at their simulated time.
    scenario
        Gives control period and end.

    Attributes
    ----------
    namespace
        Of the vehicle that was driven.
    has_clock
        Whether it owned /clock, as most do; only ``metadata.yaml`` tells of one that did not.
    trouble
        Why the bag gives no more commands than it does, if it is damaged.

    Raises
    ------
    BagError
        Here and in `messages`: the bag can't be read, has no commands, those of several vehicles, or times that are
        not simulated.
    """

    def __init__(self, bag: Path, scenario: Scenario) -> None:
        self.trouble = ''
        self._bag = bag
        self._source = open_source(bag)
        told = self._source.topics
        self.has_clock = '/clock' in told or not told
        self._period = round(scenario.plant.control_period * 1e9)
        self.namespace = ''
        self._known = False
        for found in filter(None, map(command_of, self._source.topics)):
            self._check_namespace(found[0])
        self._messages = self._commands()
        self._next = next(self._messages, None)
        if self._next is None:
            raise BagError(f'{bag} holds no commands: {", ".join(COMMANDS)}')
        end = scenario.cycles * self._period
        if self._next[0] > end:
            raise BagError(
                f'{bag}: its first command comes at {self._next[0] / 1e9:.3f} s, after the end at {end / 1e9:g} s; '
                'commands are taken from the bag of a run, which was recorded at simulated time'
            )

    def messages(self, cycle: int) -> list[Message]:
        """Return what was said since the cycle before."""
        said = []
        while self._next is not None and self._next[0] <= cycle * self._period:
            said.append(self._next[1])
            self._next = next(self._messages, None)
        return said

    def _commands(self) -> Iterator[tuple[int, Message]]:
        for message in self._source:
            found = command_of(message.topic)
            if found is not None:
                self._check_namespace(found[0])
                yield message.log_time, self._decode(found[1], message)
        self.trouble = '; '.join(self._source.damage)

    def _check_namespace(self, namespace: str) -> None:
        if self._known and namespace != self.namespace:
            vehicles = ', '.join(sorted(name or '/' for name in (self.namespace, namespace)))
            raise BagError(f'{self._bag} holds commands of several vehicles: {vehicles}')
        self.namespace, self._known = namespace, True

    def _decode(self, name: str, message: RecordedMessage) -> Message:
        if message.type_name != COMMANDS[name]:
            raise BagError(f'{self._bag}: topic {message.topic} has the type {message.type_name}, not {COMMANDS[name]}')
        try:
            return name, decode(message.type_name, message.data)
        except MessageError as error:
            raise BagError(f'{self._bag}: topic {message.topic}: {error}') from error
