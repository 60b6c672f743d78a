"""Which topics a recorder takes, and what it asks of their publishers."""

import re
from collections.abc import Callable, Iterable
from typing import NamedTuple

from omni_vehicle_ros.bags.metadata import OfferedQos
from omni_vehicle_ros.parameters import RecorderParameters

CLOCK = '/clock'


class Request(NamedTuple):
    """What a subscription asks for."""

    reliable: bool
    latched: bool


class TopicChoice:
    """Chooses among the topics of a graph.

    Hidden topics, of whose name a part begins with ``_``, are taken by their name only. The clock is taken with any
    others, as without it nobody can tell which simulated time they belong to.

    Parameters
    ----------
    parameters
        The rules.
    resolve
        Gives the full name of a topic.

    Attributes
    ----------
    named
        Full names of the topics that are chosen by name.
    """

    def __init__(self, parameters: RecorderParameters, resolve: Callable[[str], str]) -> None:
        self._all = parameters.all
        self._names = {resolve(name) for name in parameters.topics} | {CLOCK}
        self._regex = re.compile(parameters.regex) if parameters.regex else None
        self._without = [re.compile(pattern) for pattern in parameters.exclude]
        self._without_names = {resolve(name) for name in parameters.exclude if _NAME.fullmatch(name)}
        self.named = {topic for topic in map(resolve, parameters.topics) if self.takes(topic)}

    def takes(self, topic: str) -> bool:
        """Whether a topic, given by its full name, is to be recorded."""
        if topic in self._without_names or any(pattern.fullmatch(topic) for pattern in self._without):
            return False
        if topic in self._names:
            return True
        if any(part.startswith('_') for part in topic.split('/')):
            return False
        return self._all or (self._regex is not None and self._regex.search(topic) is not None)


_NAME = re.compile(r'[\w/~]+', re.ASCII)


def request_for(offers: Iterable[OfferedQos]) -> Request:
    """Return the most that all publishers can give, as rosbag2 does: whatever one of them lacks isn't asked for."""
    offers = list(offers)
    return Request(
        all(offer.reliability == 'reliable' for offer in offers),
        all(offer.durability == 'transient_local' for offer in offers),
    )


def weaker(before: Request, now: Request) -> Request:
    """Return what both ask for: a subscription may have to ask for less, but never needs to ask for more again."""
    return Request(before.reliable and now.reliable, before.latched and now.latched)
