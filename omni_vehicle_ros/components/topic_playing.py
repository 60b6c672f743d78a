"""Which topics of a bag to play, and with what quality of service."""

from collections.abc import Collection, Sequence

from omni_vehicle_ros.bags.metadata import INFINITE, OfferedQos
from omni_vehicle_ros.bags.source import CDR, TopicFacts
from omni_vehicle_ros.components.recorded_commands import COMMANDS, command_of
from omni_vehicle_ros.errors import BagError
from omni_vehicle_ros.interface import resolve
from omni_vehicle_ros.parameters import did_you_mean

UNKNOWN_DEPTH = 100
"""Depth of the history of a publisher whose own isn't known: rosbag2 can't see it of publishers over Fast DDS."""

LARGEST_DEPTH = 1000


class TopicPlaying:
    """Chooses among the topics of a bag.

    Parameters
    ----------
    topics
        Names, with or without the leading slash; all if there are none.
    commands_only
        Only what a driver, or anyone, tells a vehicle.
    """

    def __init__(self, topics: Sequence[str] = (), *, commands_only: bool = False) -> None:
        self._names = {resolve(name, '') for name in topics}
        self._commands_only = commands_only

    def plays(self, topic: str) -> bool:
        """Whether a topic, given by its full name, is to be played."""
        if self._commands_only and command_of(topic) is None:
            return False
        return not self._names or topic in self._names

    def check(self, bag: str, known: Collection[str]) -> None:
        """Check that there is what was asked for, as far as that is known.

        Raises
        ------
        BagError
            The bag doesn't have a topic, or nothing of what is asked for.
        """
        for name in sorted(self._names - {*known}):
            raise BagError(f'{bag} has no topic {name}{did_you_mean(name, sorted(known))}')
        if not any(map(self.plays, known)):
            what = f'no commands: {", ".join(COMMANDS)}' if self._commands_only else 'no messages'
            raise BagError(f'{bag} holds {what}')


def unplayable(facts: TopicFacts, type_hash: str) -> str:
    """Return why messages can't be published as the type that is installed, which has ``type_hash``; empty if they can.

    Either hash may be unknown, which is empty.
    """
    if facts.encoding != CDR:
        return f'its messages are {facts.encoding or "not encoded"}, not {CDR}'
    if type_hash.startswith('RIHS01_') and facts.type_hash.startswith('RIHS01_') and type_hash != facts.type_hash:
        return f'it was recorded with another definition of {facts.type_name} than the installed one'
    return ''


def combined_offer(offers: Sequence[OfferedQos]) -> OfferedQos:
    """Return what one publisher has to offer in the place of several, so that all who listened to one of them hear it.

    Durations and liveliness are kept only where all agree. A latched topic keeps as many messages as all its
    publishers did.
    """
    if not offers:
        return OfferedQos(depth=UNKNOWN_DEPTH)
    first = offers[0]
    same = all(one._replace(depth=0) == first._replace(depth=0) for one in offers)
    common = first if same else OfferedQos()
    reliable = any(one.reliability != 'best_effort' for one in offers)
    latched = any(one.durability == 'transient_local' for one in offers)
    known = all(one.depth > 0 and one.history == 'keep_last' for one in offers)
    depth = sum(one.depth for one in offers) if known else UNKNOWN_DEPTH
    return common._replace(
        history='keep_all' if any(one.history == 'keep_all' for one in offers) else 'keep_last',
        depth=min(depth, LARGEST_DEPTH),
        reliability='reliable' if reliable else 'best_effort',
        durability='transient_local' if latched else 'volatile',
        liveliness=common.liveliness if common.liveliness == 'manual_by_topic' else 'automatic',
        deadline=common.deadline or INFINITE,
        lifespan=common.lifespan or INFINITE,
        liveliness_lease_duration=common.liveliness_lease_duration or INFINITE,
    )


def latched_depth(offers: Sequence[OfferedQos]) -> int:
    """Return how many messages of a topic someone who comes late gets; 0 if it isn't latched.

    Of publishers whose depth isn't known it is the last one.
    """
    latched = [one for one in offers if one.durability == 'transient_local']
    depths = [one.depth if one.history == 'keep_last' and one.depth > 0 else 1 for one in latched]
    return min(sum(depths), LARGEST_DEPTH)
