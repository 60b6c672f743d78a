"""What a claim of the thesis is, and how it is judged: part by part, by figures that were computed."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import groupby
from typing import Any, NamedTuple

from omni_vehicle_ros.analysis.signals import StepMetrics
from omni_vehicle_ros.thesis.tasks import Results, Task
from omni_vehicle_ros.thesis.words import HARD_SPACE, listed, number

REPRODUCED, DEPENDS, NOT_REPRODUCED = 'reproduced', 'depends on the reading', 'not reproduced'
WORDS = (REPRODUCED, DEPENDS, NOT_REPRODUCED)
"""What a verdict can be."""

_CHANGE = 2  # values: before and after
_NOTHING = 0.05  # percent


class Fact(NamedTuple):
    """Figures that were computed: what they are, the values, and the unit.

    Two values are those before and after; a value is None where there is none. ``group`` says what figures that
    follow each other are about together.
    """

    name: str
    values: tuple[float | None, ...]
    unit: str = ''
    group: str = ''

    def __str__(self) -> str:
        """Return it in words."""
        unit = self.unit if self.unit in ('', '°') else f'{HARD_SPACE}{self.unit}'
        between = ' → ' if len(self.values) == _CHANGE else ', '
        values = between.join(map(number, self.values))
        return f'{self.name}{" " if self.group else ": "}{values}{unit}'


def fact(name: str, value: float | None, unit: str = '', group: str = '') -> Fact:
    """Return a figure."""
    return Fact(name, (value,), unit, group)


class Part(NamedTuple):
    """One of the things that a claim says, or one way to read it.

    Attributes
    ----------
    words
        What part of the claim it is.
    holds
        Whether it bears out.
    why
        What in the physics makes it so; empty if that has been said.
    reading
        Whether it is one way to read the claim among others; else the claim says it in any case.
    """

    words: str
    holds: bool
    why: str = ''
    reading: bool = False


class Verdict(NamedTuple):
    """How a claim bears out, part by part, and the figures that say so."""

    parts: tuple[Part, ...]
    facts: tuple[Fact, ...]

    @property
    def word(self) -> str:
        """One of `WORDS`.

        A claim is reproduced if all its parts hold. It depends on the reading if some readings fail and others hold,
        and it is not reproduced if something fails that it says in any case, or all.
        """
        if all(part.holds for part in self.parts):
            return REPRODUCED
        said = all(part.holds for part in self.parts if not part.reading)
        return DEPENDS if said and any(part.holds for part in self.parts) else NOT_REPRODUCED

    @property
    def figures(self) -> list[str]:
        """The facts in words: a line each, those of a group in one."""
        groups = [(group, list(map(str, facts))) for group, facts in groupby(self.facts, lambda entry: entry.group)]
        return [line for group, words in groups for line in ([f'{group}: {", ".join(words)}'] if group else words)]

    def __str__(self) -> str:
        """Return the verdict in words, with what it hangs on."""
        good, bad = ([part.words for part in self.parts if part.holds is holds] for holds in (True, False))
        said = [f'yes for {listed(good)}'] if good else []
        return f'{self.word}: {"; ".join([*said, f"no for {listed(bad)}"])}' if bad else self.word


@dataclass(frozen=True)
class Claim:
    """A claim of the thesis.

    Attributes
    ----------
    number
        In our list.
    text
        What is claimed, in our words.
    where
        In the thesis.
    needs
        What has to be computed first.
    judge
        Judges it.
    """

    number: int
    text: str
    where: str
    needs: tuple[Task[Any], ...]
    judge: Callable[[Results], Verdict]


def response_facts(group: str, one: StepMetrics, other: StepMetrics) -> list[Fact]:
    """Return the figures of two responses, beside each other."""
    pair = one, other
    return [
        Fact('slip', tuple(degrees_of(step.steady_state) for step in pair), '°', group),
        Fact('overshoot', tuple(percent_of(step.overshoot) for step in pair), '%', group),
        Fact('settling time', tuple(step.settling_time for step in pair), 's', group),
    ]


def verdict(parts: list[Part], facts: list[Fact]) -> Verdict:
    """Return the verdict on a claim by its parts, with the figures that say so."""
    return Verdict(tuple(parts), tuple(facts))


def kilometres_per_hour(speed: float | None) -> float | None:
    """Return a speed [m/s] in km/h."""
    return None if speed is None else 3.6 * speed


def degrees_of(angle: float | None) -> float | None:
    """Return an angle [rad] in degrees."""
    return None if angle is None else math.degrees(angle)


def percent_of(share: float | None) -> float | None:
    """Return a share in percent; 0 for next to nothing."""
    if share is None:
        return None
    return 100.0 * share if abs(100.0 * share) >= _NOTHING else 0.0
