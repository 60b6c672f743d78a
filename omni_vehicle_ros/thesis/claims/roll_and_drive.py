"""Claims 14 and 15, about roll and about the number of driven wheels (thesis sec. 4.5 and 4.6)."""

import math
from typing import NamedTuple

import numpy as np

from omni_vehicle_ros.analysis.signals import Array
from omni_vehicle_ros.thesis.claims.claim import Claim, Fact, Part, Verdict, fact, verdict
from omni_vehicle_ros.thesis.drive import FOUR, FRONT, REAR, TURN, driven, end
from omni_vehicle_ros.thesis.roll import LOAD_TRANSFER, ROLL_STEER, SPEEDS, tasks, with_and_without
from omni_vehicle_ros.thesis.slip_maps import RADII
from omni_vehicle_ros.thesis.tasks import Recording, Results
from omni_vehicle_ros.thesis.words import number, percent

NEGLIGIBLE, SMALL = 0.01, 0.25
"""Share of the slip that may be neglected; share of the largest effect that is small beside it."""

_HALF = 250.0  # N on each of four wheels: as much as 500 N on two


class _Change(NamedTuple):
    """What an effect does to the slips at one speed [rad], and which share of the slip without it that is.

    ``tight`` and ``wide``: the change in the tightest and in the widest turn, shape (4,); ``tight_share`` and
    ``wide_share``: the shares; ``tight_radius`` [m]; ``all``: the change in every turn, shape (radii, 4).
    """

    tight_radius: float
    tight: Array
    wide: Array
    tight_share: Array
    wide_share: Array
    all: Array


def _change(results: Results, effect: str, speed: int) -> _Change:
    one, other = with_and_without(results, effect, speed)
    both = np.flatnonzero(np.isfinite(one[:, 0]) & np.isfinite(other[:, 0]))
    change = one - other
    tight, wide = int(both[0]), int(both[-1])
    return _Change(
        RADII[tight], change[tight], change[wide], change[tight] / other[tight], change[wide] / other[wide], change
    )


def _grows(slow: _Change, fast: _Change) -> bool:
    """Tell whether an effect is larger at the higher speed, in the tightest turn that there is at both."""
    row = RADII.index(max(slow.tight_radius, fast.tight_radius))
    return _largest(fast.all[row]) > _largest(slow.all[row])


def _largest(values: Array) -> float:
    return float(np.max(np.abs(values)))


def _roll(results: Results) -> Verdict:
    load = [_change(results, LOAD_TRANSFER, speed) for speed in SPEEDS]
    steer = [_change(results, ROLL_STEER, speed) for speed in SPEEDS]
    parts = [
        Part(
            f'load transfer (neglected: {percent(NEGLIGIBLE)} of the slip)',
            all(_largest(change.tight_share) > NEGLIGIBLE >= _largest(change.wide_share) for change in load),
            "Dugoff's tyre does not feel its load in its linear region: at 10 m load transfer does nothing at all.",
        ),
        Part(
            'the higher speed',
            _grows(*load) and _grows(*steer),
            'Both effects come from the lateral acceleration.',
        ),
        Part(
            f'roll steer in degrees (at 10 m less than {percent(SMALL)} of the most)',
            all(_largest(change.wide) < SMALL * _largest(change.tight) for change in steer),
            'Roll steer is largest where the lateral acceleration is.',
            reading=True,
        ),
        Part(
            f'roll steer as a share of the slip (neglected: {percent(NEGLIGIBLE)})',
            all(_largest(change.wide_share) <= NEGLIGIBLE for change in steer),
            'But so is the slip: at 10 m roll steer still changes a slip by up to '
            f'{percent(max(_largest(change.wide_share) for change in steer))} of it, as at any large radius.',
            reading=True,
        ),
    ]
    return verdict(parts, [*_change_facts(LOAD_TRANSFER, load), *_change_facts(ROLL_STEER, steer)])


def _change_facts(effect: str, found: list[_Change]) -> list[Fact]:
    facts = []
    for speed, change in zip(SPEEDS, found, strict=True):
        radii = f'{number(change.tight_radius)} and {number(RADII[-1])} m'
        words = f'largest change by {effect} at {speed} km/h, in turns of {radii}'
        facts.append(Fact(words, (math.degrees(_largest(change.tight)), math.degrees(_largest(change.wide))), '°'))
    return facts


def _driven_wheels(results: Results) -> Verdict:
    four, front, rear, half = (
        results[task]
        for task in (driven(TURN, FOUR), driven(TURN, FRONT), driven(TURN, REAR), driven(TURN, FOUR, force=_HALF))
    )
    speeds, slips = ([figure(found) for found in (four, front, rear, half)] for figure in (_speed, _slip))
    parts = [
        Part(
            'the same force on each driven wheel',
            speeds[0] > max(speeds[1:3]) and slips[0] > max(slips[1:3]),
            'Four driven wheels then pull twice as hard; the slip grows with the square of the speed.',
            reading=True,
        ),
        Part(
            'the same force in total',
            speeds[3] > max(speeds[1:3]) and slips[3] > max(slips[1:3]),
            'Then four-wheel drive is as fast as the others, and its front left slip lies between theirs.'
            if min(slips[1:3]) <= slips[3] <= max(slips[1:3])
            else 'Then four-wheel drive is about as fast as the others.',
            reading=True,
        ),
    ]
    drives = (
        *(f'{wheels} with 500 N each' for wheels in ('four wheels', 'front wheels', 'rear wheels')),
        f'four wheels with {number(_HALF)} N each',
    )
    facts = [
        entry
        for drive, speed, slip in zip(drives, speeds, slips, strict=True)
        for entry in (
            fact('speed after the traction', speed, 'm/s', drive), fact('front left slip', slip, '°', drive)
        )
    ]
    return verdict(parts, facts)


def _speed(recording: Recording) -> float:
    return float(recording.vx[end(TURN, recording)])


def _slip(recording: Recording) -> float:
    return math.degrees(float(recording.side_slip[end(TURN, recording), 0]))


CLAIMS = (
    Claim(
        14,
        'Load transfer and roll steer matter at a small radius and a high speed only.',
        'sec. 4.5',
        tuple(dict.fromkeys((*tasks(LOAD_TRANSFER), *tasks(ROLL_STEER)))),
        _roll,
    ),
    Claim(
        15,
        'Four-wheel drive is faster, and less stable in a turn, than two-wheel drive.',
        'sec. 4.6',
        (driven(TURN, FOUR), driven(TURN, FRONT), driven(TURN, REAR), driven(TURN, FOUR, force=_HALF)),
        _driven_wheels,
    ),
)
