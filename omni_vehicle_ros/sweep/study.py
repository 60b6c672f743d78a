"""A study: a scenario, what is varied in it, and which of its turns are driven together."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from scipy.stats import qmc

from omni_vehicle_ros import __version__
from omni_vehicle_ros.errors import OmniVehicleError, RunError, ScenarioError
from omni_vehicle_ros.model.state import Vector
from omni_vehicle_ros.scenarios import Scenario, yaml_text
from omni_vehicle_ros.scenarios.library import find_scenario
from omni_vehicle_ros.scenarios.loading import build_scenario
from omni_vehicle_ros.scenarios.scenario import make_scenario
from omni_vehicle_ros.scenarios.settings import Setting, read_override
from omni_vehicle_ros.sweep.axes import Axis, listed_axis, read_axis

SAMPLINGS = ('random', 'latin')
MOST_TURNS = 10**9
LARGEST_CHUNK, SMALLEST_CHUNK, CHUNKS = 4096, 64, 64
"""Turns of a chunk, and how many chunks there are between these."""


@dataclass(frozen=True)
class Study:
    """What a sweep does; small enough to be sent to another process.

    Turns are numbered: the last axis of the grid changes slower than the samples, and faster than the axis before it.
    Every point of the grid meets the same samples, so that what differs between points is not chance.

    Attributes
    ----------
    name, tree
        Of the scenario, and the mapping of its file.
    settings
        What ``--set`` sets.
    axes
        What is varied.
    samples
        How many are drawn, 1 if there is no distribution.
    sampling, seed
        How: independent, or as a Latin hypercube, which fills each distribution evenly (McKay et al. 1979).
    """

    name: str
    tree: dict[str, Any]
    settings: tuple[Setting, ...]
    axes: tuple[Axis, ...]
    samples: int = 1
    sampling: str = 'random'
    seed: int = 0

    @property
    def grid(self) -> tuple[int, ...]:
        """How many values each axis has that is no distribution."""
        return tuple(len(axis.values) for axis in self.axes if axis.distribution is None)

    @property
    def turns(self) -> int:
        """How many there are."""
        return math.prod(self.grid) * self.samples

    @property
    def chunk(self) -> int:
        """How many turns are driven together; never a matter of who drives them."""
        even = -(-self.turns // CHUNKS)
        return min(max(8 * -(-even // 8), SMALLEST_CHUNK), LARGEST_CHUNK)

    @property
    def chunks(self) -> int:
        """How many chunks there are."""
        return -(-self.turns // self.chunk)

    @property
    def summary(self) -> str:
        """First line of the scenario's description."""
        return str(self.tree.get('description', '')).partition('\n')[0]

    def numbers(self, chunk: int) -> range:
        """Return the numbers of the turns of a chunk."""
        return range(chunk * self.chunk, min((chunk + 1) * self.chunk, self.turns))

    def points(self, numbers: Sequence[int]) -> list[tuple[Any, ...]]:
        """Return the values of all axes for some turns."""
        places = np.asarray(numbers)
        grid = iter(np.unravel_index(places // self.samples, self.grid) if self.grid else ())
        drawn_axes = sum(axis.distribution is not None for axis in self.axes)
        shares = _shares(self.samples, drawn_axes, self.sampling, self.seed)
        drawn = iter(shares[places % self.samples].T)
        columns: list[list[Any]] = []
        for axis in self.axes:
            if axis.distribution is None:
                columns.append([axis.values[place] for place in next(grid)])
            else:
                columns.append(axis.distribution.quantiles(next(drawn)).tolist())
        return list(zip(*columns, strict=True))

    @property
    def corners(self) -> list[tuple[Any, ...]]:
        """Points that have the first value of all axes but one, and of that the last; a median for a distribution."""
        ends = [_ends(axis) for axis in self.axes]
        first = tuple(low for low, _ in ends)
        return [first, *((*first[:i], high, *first[i + 1 :]) for i, (_, high) in enumerate(ends) if high != first[i])]

    def scenario(self, point: Sequence[Any]) -> Scenario:
        """Return the scenario of one turn.

        Raises
        ------
        ScenarioError
            Names the values that don't go together.
        """
        varied = [axis.setting_of(value) for axis, value in zip(self.axes, point, strict=True)]
        try:
            return make_scenario(self.name, self.tree, [*self.settings, *varied])
        except OmniVehicleError as error:
            values = ', '.join(f'{axis.name}={value}' for axis, value in zip(self.axes, point, strict=True))
            raise ScenarioError(f'{self.name} with {values}: {error}') from None

    def as_json(self) -> dict[str, Any]:
        """Return all that the numbers in the results depend on."""
        return {
            'version': __version__,
            'scenario': self.name,
            'tree': self.tree,
            'settings': dict(self.settings),
            'axes': {axis.name: axis.distribution or axis.values for axis in self.axes},
            'samples': self.samples,
            'sampling': self.sampling,
            'seed': self.seed,
            'turns': self.turns,
            'chunk': self.chunk,
        }


def _ends(axis: Axis) -> tuple[Any, Any]:
    if axis.distribution is None:
        return axis.values[0], axis.values[-1]
    median = float(axis.distribution.quantiles(np.array([0.5]))[0])
    return median, median


@lru_cache(maxsize=1)
def _shares(samples: int, axes: int, sampling: str, seed: int) -> Vector:
    """Return numbers from 0 to 1, shape (samples, axes)."""
    if sampling == 'latin' and axes:
        return np.asarray(qmc.LatinHypercube(axes, rng=np.random.default_rng(seed)).random(samples))
    return np.random.default_rng(seed).random((samples, axes))


def read_study(
    scenario: str,
    vary: Sequence[str],
    settings: Sequence[str] = (),
    samples: int | None = None,
    sampling: str = SAMPLINGS[0],
    seed: int = 0,
) -> Study:
    """Return the study that a user asks for; without ``vary`` that of the scenario's own.

    Raises
    ------
    OmniVehicleError
        One line: a name, a value or a number that can't be.
    """
    name, path = find_scenario(scenario)
    try:
        tree = yaml_text.parse(path.read_bytes())
        base = build_scenario(name, tree, settings)
    except OSError as error:
        raise ScenarioError(f'{path}: {error.strerror}') from None
    except ScenarioError as error:
        raise ScenarioError(f'{path}: {error}') from None
    axes = tuple(read_axis(text, base, tree) for text in vary)
    axes = axes or tuple(listed_axis(axis, values, tree) for axis, values in base.vary.items())
    if not axes:
        example = next(iter(base.values), 'mass')
        raise RunError(f'{name} says nothing that is varied: say it by --vary, such as --vary {example}=1,2,3')
    overrides = tuple(map(read_override, settings))
    _check_names(axes, overrides)
    study = Study(name, tree, overrides, axes, _samples(axes, samples), sampling, seed)
    if study.turns > MOST_TURNS:
        raise RunError(f'{study.turns} turns are more than {MOST_TURNS}; take fewer values or samples')
    return study


def _samples(axes: Sequence[Axis], samples: int | None) -> int:
    drawn = [axis for axis in axes if axis.distribution is not None]
    if samples is None:
        if drawn:
            raise RunError(f'{drawn[0].name} is drawn from a distribution: say how often, by --samples')
        return 1
    if not drawn:
        raise RunError('--samples: nothing is drawn; give a distribution, such as --vary friction=normal(0.8,0.05)')
    if samples < 1:
        raise RunError(f'--samples: {samples} must be 1 or more')
    return samples


def _check_names(axes: Sequence[Axis], settings: Sequence[Setting]) -> None:
    fixed = {name for name, _ in settings}
    for number, axis in enumerate(axes):
        if axis.setting in fixed:
            raise RunError(f'{axis.name} is both set and varied; leave one out')
        if any(axis.setting == other.setting for other in axes[:number]):
            raise RunError(f'{axis.name} is varied twice')
