"""Claims 16 and 17, about the gains of the side-slip controller (thesis sec. 5.2)."""

import math

import numpy as np

from omni_vehicle_ros.thesis.claims.claim import Claim, Fact, Part, Verdict, fact, percent_of, verdict
from omni_vehicle_ros.thesis.side_slip_control import FIRST_GAINS, SECOND_GAINS, runs
from omni_vehicle_ros.thesis.tasks import Recording, Results
from omni_vehicle_ros.thesis.words import listed, number, percent, sentence, wheel_words
from omni_vehicle_ros.wheels import WHEELS, PerWheel

FRONT_LEFT, FRONT_RIGHT, REAR_LEFT, REAR_RIGHT = range(4)
SIMILAR, CLOSE = 0.2, 0.05
"""By what share slips and paths may differ that are similar, and those that are close."""

_FORMS = ('solved exactly', 'with real actuators')
_COMPARED = 'without and with control'
_NOTHING = 1e-3  # of the steady slip: an overshoot that is none

Pair = tuple[Recording, Recording]


def _pairs(results: Results, gains: PerWheel) -> tuple[Pair, Pair]:
    """Return the runs without control and with it, solved exactly and with real actuators."""
    exact_off, exact_on, real_off, real_on = (results[task] for task in runs(gains))
    return (exact_off, exact_on), (real_off, real_on)


def _value(recording: Recording, wheel: int, figure: str) -> float:
    value = getattr(recording.step(wheel), figure)
    return math.nan if value is None else abs(value)


def _improved(pair: Pair, wheels: tuple[int, ...], figure: str) -> bool:
    """Tell whether control makes a figure smaller at some wheels; where there was next to none it may stay so."""
    values = [(_value(pair[0], wheel, figure), _value(pair[1], wheel, figure)) for wheel in wheels]
    return all(after < before or after <= _NOTHING for before, after in values)


def _parts(words: str, figure: str, pairs: tuple[Pair, Pair], wheels: tuple[int, ...], why: str) -> list[Part]:
    """Return the part of a claim about a figure: one, or one for each form of the controller if they differ."""
    better = [[wheel for wheel in wheels if _improved(pair, (wheel,), figure)] for pair in pairs]
    found = [len(improved) == len(wheels) for improved in better]
    if all(found):
        return [Part(words, True, why)]
    where = '; '.join(f'{form} better at {_names(improved)}' for form, improved in zip(_FORMS, better, strict=True))
    explained = f'{why} {sentence(where)}.'.strip()
    if not any(found):
        return [Part(words, False, explained)]
    return [
        Part(f'{words} {form}', good, explained if i == 0 else '')
        for i, (form, good) in enumerate(zip(_FORMS, found, strict=True))
    ]


def _names(wheels: list[int]) -> str:
    return listed([wheel_words(WHEELS[wheel]) for wheel in wheels]) or 'none'


def _radius(recording: Recording) -> float:
    return float(recording.metrics['path']['radius'] or math.nan)


def _from_path(pair: Pair) -> float:
    """Return how far the vehicle with control comes from the path of the one without [m]."""
    off, on = pair
    distances = np.hypot(on.x[:, np.newaxis] - off.x, on.y[:, np.newaxis] - off.y)
    return float(distances.min(axis=1).max())


def _wider(pair: Pair) -> str:
    off, on = pair
    slip = [float(np.mean(found.side_slip[-1])) for found in pair]
    force = [float(found.vx[-1] * found.yaw_rate[-1]) for found in pair]
    angle = [math.degrees(float(found.steer_angle[-1, FRONT_LEFT])) for found in (off, on)]
    return (
        f'What it does is to steer less, at the front left wheel {number(angle[1])}° in place of '
        f'{number(angle[0])}°: the lateral acceleration falls by {percent(1.0 - force[1] / force[0])}, and the mean '
        f'slip of the four tyres by {percent(1.0 - slip[1] / slip[0])}.'
    )


_SOFTER = (
    'To the vehicle a controlled tyre is one of 1 / (1 + K) of its stiffness: lateral speed and yaw rate are '
    'damped less and take longer.'
)


def _facts(pairs: tuple[Pair, Pair], wheels: tuple[int, ...]) -> list[Fact]:
    """Return the steady slips of all wheels, then, form by form, how some wheels settle and where the vehicle goes."""
    facts = []
    for wheel, name in enumerate(map(wheel_words, WHEELS)):
        slips = tuple(math.degrees(_value(found, wheel, 'steady_state')) for found in pairs[0])
        facts.append(Fact(name, slips, '°', f'slip {_COMPARED}'))
    for form, pair in zip(_FORMS, pairs, strict=True):
        for wheel in wheels:
            group = f'{wheel_words(WHEELS[wheel])} {_COMPARED}, {form}'
            shares = tuple(percent_of(_value(found, wheel, 'overshoot')) for found in pair)
            times = tuple(_value(found, wheel, 'settling_time') for found in pair)
            facts += [Fact('overshoot', shares, '%', group), Fact('settling time', times, 's', group)]
        group = f'path {_COMPARED}, {form}'
        facts.append(Fact('radius', tuple(map(_radius, pair)), 'm', group))
        facts.append(fact('farthest from that without', _from_path(pair), 'm', group))
    return facts


def _growth(pair: Pair, wheel: int) -> float:
    """Return by which share of itself control makes the steady slip of a wheel larger."""
    before, after = (_value(found, wheel, 'steady_state') for found in pair)
    return after / before - 1.0


def _growths(pairs: tuple[Pair, Pair], wheel: int) -> str:
    exact, real = (_change(_growth(pair, wheel)) for pair in pairs)
    return exact if exact == real else f'{exact} ({real} with real actuators)'


def _change(share: float) -> str:
    return f'{"larger" if share > 0.0 else "smaller"} by {percent(abs(share))}'


def _change_of_radius(pair: Pair) -> float:
    return _radius(pair[1]) / _radius(pair[0]) - 1.0


def _first_gains(results: Results) -> Verdict:
    pairs, wheels = _pairs(results, FIRST_GAINS), (FRONT_LEFT, FRONT_RIGHT, REAR_LEFT)
    change = _change_of_radius(pairs[0])
    parts = [
        *_parts(
            'the steady slip of front left, front right and rear left', 'steady_state', pairs, wheels, _wider(pairs[0])
        ),
        *_parts('their overshoot', 'overshoot', pairs, wheels, _SOFTER),
        *_parts('their settling time', 'settling_time', pairs, wheels, ''),
        Part(
            f'a similar slip rear right (within {percent(SIMILAR)})',
            all(abs(_growth(pair, REAR_RIGHT)) <= SIMILAR for pair in pairs),
            f'It becomes {_growths(pairs, REAR_RIGHT)}.',
        ),
        Part(
            f'a path that changes greatly (by more than {percent(SIMILAR)})',
            abs(change) > SIMILAR,
            f'It is wider by {percent(change)}.',
        ),
    ]
    return verdict(parts, _facts(pairs, wheels))


def _second_gains(results: Results) -> Verdict:
    pairs, wheels = _pairs(results, SECOND_GAINS), (FRONT_LEFT, REAR_LEFT)
    first, change = _change_of_radius(_pairs(results, FIRST_GAINS)[0]), _change_of_radius(pairs[0])
    parts = [
        *_parts('the steady slip of front left and rear left', 'steady_state', pairs, wheels, _wider(pairs[0])),
        *_parts('their overshoot', 'overshoot', pairs, wheels, _SOFTER),
        *_parts('their settling time', 'settling_time', pairs, wheels, ''),
        Part(
            f'only front right worse (by more than {percent(CLOSE)})',
            all(_growth(pair, FRONT_RIGHT) > CLOSE >= _growth(pair, REAR_RIGHT) for pair in pairs),
            'The front right tyre takes over what the front left one gives up: its slip '
            f'becomes {_growths(pairs, FRONT_RIGHT)}, that of rear right {_growths(pairs, REAR_RIGHT)}.',
        ),
        Part(
            'a path closer than with (5, 5, 0, 0)',
            abs(change) < abs(first),
            f'It is wider by {percent(change)}, in place of {percent(first)}: front right is steered back less.',
        ),
        Part(
            f'a path quite close to that without control (within {percent(CLOSE)} of its radius)',
            abs(change) <= CLOSE,
            f'{percent(change)} is more than that.',
        ),
    ]
    return verdict(parts, _facts(pairs, wheels))


_BOTH = tuple(dict.fromkeys((*runs(FIRST_GAINS), *runs(SECOND_GAINS))))
CLAIMS = (
    Claim(
        16,
        'The gains (5, 5, 0, 0) improve front left, front right and rear left in steady state, overshoot and '
        'settling time; rear right stays similar; the path changes greatly.',
        'sec. 5.2',
        runs(FIRST_GAINS),
        _first_gains,
    ),
    Claim(
        17,
        'The gains (5, 1, 0, 0) improve front left and rear left in steady state, overshoot and settling time and '
        'worsen front right only; the path is quite close to that without control.',
        'sec. 5.2',
        _BOTH,
        _second_gains,
    ),
)
