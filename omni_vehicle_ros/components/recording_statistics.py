"""How a recording goes: messages, bytes, rates and losses of each topic."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

SECOND = 1_000_000_000


@dataclass
class TopicStatistics:
    """What is known about one topic.

    Losses are known by the gaps in the numbers that the middleware gives the messages of a publisher, so only while
    there is one publisher: which of several a message came from is not told. A look at the publishers comes after the
    messages, so the gaps since the last look count only if the publisher was alone at both.
    """

    count: int = 0
    size: int = 0
    lost: int = 0
    publishers: frozenset[str] = frozenset()
    unknown: bool = False
    """Whether messages came at a time for which losses can't be known."""
    _last: int | None = None
    _gaps: int = 0
    _fresh: int = 0
    _said: tuple[int, int] = field(default=(0, 0))

    def add(self, size: int, number: int | None) -> None:
        """Count a message of ``size`` bytes, to which its publisher gave ``number``, if known."""
        self.count += 1
        self.size += size
        self._fresh += 1
        if number is None:
            self.unknown = True
            return
        if self._last is not None and number > self._last + 1:
            self._gaps += number - self._last - 1
        self._last = number

    def look(self, publishers: Iterable[str]) -> None:
        """Take note of who publishes now."""
        now = frozenset(publishers)
        if now == self.publishers and len(now) == 1:
            self.lost += self._gaps
        elif self._fresh and (len(now) > 1 or len(self.publishers) > 1):
            self.unknown = True
        if now != self.publishers:
            self._last = None
        self._gaps = self._fresh = 0
        self.publishers = now

    def rates(self, seconds: float) -> tuple[float, float]:
        """Return messages and bytes per second since this was last asked, ``seconds`` ago."""
        count, size = self._said
        self._said = self.count, self.size
        return (self.count - count) / seconds, (self.size - size) / seconds


class RecordingStatistics:
    """The statistics of all topics.

    Attributes
    ----------
    topics
        By full name.
    """

    def __init__(self) -> None:
        self.topics: dict[str, TopicStatistics] = {}
        self._reported = 0
        self._lost = 0

    @property
    def count(self) -> int:
        """Messages."""
        return sum(topic.count for topic in self.topics.values())

    @property
    def lost(self) -> int:
        """Messages that are known to be lost."""
        return sum(topic.lost for topic in self.topics.values())

    @property
    def unknown(self) -> list[str]:
        """Topics whose losses are not known, or not for all of the time."""
        return sorted(name for name, topic in self.topics.items() if topic.unknown)

    def values(self, now: int, skipped: Mapping[str, str]) -> tuple[tuple[str, str], ...]:
        """Return all there is to say at ``now`` [ns], with rates since this was last asked.

        Parameters
        ----------
        now
            The present.
        skipped
            Why topics aren't recorded, by topic.
        """
        seconds = max(now - self._reported, 1) / SECOND if self._reported else 1.0
        self._reported = now
        values = [('messages', str(self.count)), ('bytes', str(sum(one.size for one in self.topics.values())))]
        values += [('losses', _losses(self.lost, bool(self.unknown)))]
        values += [(topic, _describe(one, seconds)) for topic, one in sorted(self.topics.items())]
        values += [(topic, f'not recorded: {reason}') for topic, reason in sorted(skipped.items())]
        return tuple(values)

    def fresh_losses(self) -> int:
        """Return the messages lost since this was last asked."""
        fresh, self._lost = self.lost - self._lost, self.lost
        return fresh

    def summary(self) -> str:
        """Return the end of the recording in words."""
        unknown = self.unknown
        tail = f'; losses not known on {", ".join(unknown)}' if unknown else ''
        return f'recorded {self.count} messages, {self.lost} lost{tail}'


def _describe(topic: TopicStatistics, seconds: float) -> str:
    messages, size = topic.rates(seconds)
    return f'{messages:.1f} messages/s, {size:.0f} B/s, {topic.count} messages, {_losses(topic.lost, topic.unknown)}'


def _losses(lost: int, unknown: bool) -> str:
    """Return the losses, and whether there may be more."""
    return f'{lost} lost as far as can be known' if unknown else f'{lost} lost'
