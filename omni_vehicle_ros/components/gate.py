"""Decides when a component may act: when all that belongs to the cycle has come in."""

from collections import Counter
from collections.abc import Collection, Iterable


class Gate:
    """The inputs of one component, cycle by cycle.

    A cycle opens with the stamp of the beat. It is complete when every source has answered with that stamp or
    a later one, and when every message that the driver says it published has come in (`announce`).
    A source that misses a cycle is lost, and is not waited for again before it answers again.

    Parameters
    ----------
    sources
        Topics that answer in every cycle.
    previous
        Topics whose answers to a cycle belong to the next one. None is awaited in the first cycle.
    patient
        Whether a lost source is awaited again with any answer, so that it can catch up; else only with one to the
        latest cycle. Sources that are always late by a cycle would keep an impatient component waiting for ever.
    """

    def __init__(self, sources: Iterable[str], previous: Iterable[str] = (), *, patient: bool = True) -> None:
        self._patient = patient
        self.lost: set[str] = set()
        previous = tuple(previous)
        self._previous = set(previous)
        self._answered = dict.fromkeys((*sources, *previous), -1)
        self._earlier: dict[str, int] = {}
        self._latest = -1
        self._open: int | None = None
        self._before = -1
        self._awaited: set[str] = set()
        self._heard: Counter[str] = Counter()
        self._announced: Counter[str] = Counter()

    def open(self, stamp: int) -> None:
        """Begin the cycle of ``stamp`` [ns]; one that is still open is skipped and its late sources are lost.

        A stamp before the last one is that of a clock that went back: no answer from before counts any more.
        """
        if self._open is not None and stamp != self._open:
            self.give_up()
            self.close()
        if stamp < self._latest:
            self._answered = {
                source: stamp if self._earlier.get(source) == stamp else -1 for source in self._answered
            }
            self._before = -1
        self._earlier.clear()
        self._open = self._latest = stamp
        self._awaited = {*self._lacking()} - self.lost

    def answer(self, source: str, stamp: int) -> None:
        """Note that a source has answered for ``stamp`` [ns]; one that is not of this gate is no matter."""
        if source in self._answered:
            self.hear(source, stamp)

    def hear(self, topic: str, stamp: int) -> None:
        """Note a message: an answer for ``stamp`` [ns], or one that may be announced."""
        last = self._answered.get(topic)
        if last is None:
            self._heard[topic] += 1
            return
        if stamp <= last:
            self._earlier[topic] = stamp
            return
        self._answered[topic] = stamp
        if self.lost and (self._patient or stamp >= self._latest):
            self.lost.discard(topic)
        if self._open is None:
            return
        if stamp >= (self._before if topic in self._previous else self._open):
            self._awaited.discard(topic)
        elif topic not in self.lost:
            self._awaited.add(topic)

    def announce(self, topics: Iterable[str]) -> None:
        """Note that one message more has been published on each of ``topics``."""
        self._announced.update(topics)

    def missing(self) -> tuple[str, ...]:
        """Return the sources that have not answered for the open cycle, lost ones included."""
        if self._open is None or not (self._awaited or self.lost):
            return ()
        return tuple(self._lacking())

    def absent(self) -> str:
        """Say what the open cycle lacks."""
        sources = [source for source in self.missing() if source not in self.lost]
        topics = [topic for topic, count in self._announced.items() if self._heard[topic] < count]
        return ', '.join(sources + topics) or 'nothing'

    def ready(self) -> int | None:
        """Return the stamp [ns] of the open cycle if it is complete, else None."""
        if self._open is None or self._awaited:
            return None
        for topic, count in self._announced.items():
            if self._heard[topic] < count:
                return None
        return self._open

    def awaits_only(self, sources: Collection[str]) -> bool:
        """Whether the open cycle lacks answers of these and of no other sources."""
        return self._open is not None and bool(self._awaited) and self._awaited.issubset(sources)

    @property
    def waiting(self) -> bool:
        """Whether a cycle is open."""
        return self._open is not None

    def close(self) -> None:
        """End the open cycle: the component has acted."""
        if self._open is not None:
            self._before = self._open
        self._open = None

    def give_up(self) -> None:
        """Stop waiting for what is not there: it is lost until it answers again."""
        self.lost.update(self.missing())
        self._awaited.clear()
        self.forget_announced()

    def give_up_on(self, sources: Iterable[str]) -> None:
        """Stop waiting for some sources: they are lost until they answer again."""
        gone = self._answered.keys() & set(sources)
        self.lost |= gone
        self._awaited -= gone

    def forget_announced(self) -> None:
        """Stop waiting for what was announced: who has announced it says no more."""
        self._heard, self._announced = Counter(), Counter()

    def give_up_previous(self) -> None:
        """Stop waiting for answers to the cycle before: when that is over, they have been said or never will be."""
        self.lost |= self._awaited & self._previous
        self._awaited -= self._previous

    def _lacking(self) -> list[str]:
        """Return the sources that have not answered for the open cycle."""
        due, before = self._latest, self._before
        return [
            source for source, stamp in self._answered.items()
            if stamp < (before if source in self._previous else due)
        ]
