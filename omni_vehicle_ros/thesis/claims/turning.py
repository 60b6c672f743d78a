"""Claims 3 to 6, about turning (thesis sec. 4.2)."""

import math

import numpy as np
import numpy.typing as npt

from omni_vehicle_ros.analysis.signals import Array
from omni_vehicle_ros.thesis.claims.claim import (
    Claim,
    Fact,
    Part,
    Verdict,
    fact,
    kilometres_per_hour,
    response_facts,
    verdict,
)
from omni_vehicle_ros.thesis.simple_turning import LIMIT, LOSS_RADII, TURN_SPEEDS, loss, ratios, turn
from omni_vehicle_ros.thesis.slip_maps import FAST, MAP, SPEEDS, falls_with_radius, rises_with_speed, turnover
from omni_vehicle_ros.thesis.steady import SlipMap, SlipMapTask
from omni_vehicle_ros.thesis.tasks import Recording, Results, km_per_h, run
from omni_vehicle_ros.thesis.words import listed, number, wheel_words
from omni_vehicle_ros.wheels import WHEELS

TIGHT = SlipMapTask(run('turning_map'), tuple((np.arange(73, 200, 3) / 100.0).tolist()), tuple(map(km_per_h, (2, 4))))
RIGHT = SlipMapTask(run('turning_map'), (-5.0,), tuple(map(km_per_h, SPEEDS)))
"""Turns tighter than those of the thesis, and to the right."""

_SIDES = (MAP, FAST), (RIGHT,)


def _speed_in_a_small_turn(results: Results) -> Verdict:
    slow, fast, beyond = (results[turn(speed)] for speed in TURN_SPEEDS)
    (limit,) = results[LIMIT]
    excess = [_undershoot(found) for found in (slow, fast)]
    parts = [
        Part('slip', _all_grow(slow, fast, 'steady_state'), 'A higher speed takes more side force, and so more slip.'),
        Part(
            'settling time',
            _all_grow(slow, fast, 'settling_time'),
            'The tyres damp the motion the less the faster it is.',
        ),
        Part(
            'overshoot',
            _all_grow(slow, fast, 'overshoot'),
            f'The front left slip passes its steady value by {number(excess[0])}° and {number(excess[1])}°, a '
            'smaller share of a larger slip.',
        ),
        Part(
            f'a steady state at {TURN_SPEEDS[2]} km/h',
            bool(beyond.metrics['steady']['reached']),
            'There the vehicle spins at a held speed: at 2 m the steady turn that slow driving leads to ends at '
            f'{number(kilometres_per_hour(limit.speed))} km/h.',
        ),
    ]
    return verdict(parts, _turn_facts(slow, fast))


def _all_grow(slow: Recording, fast: Recording, figure: str) -> bool:
    return all(abs(getattr(fast.step(i), figure)) > abs(getattr(slow.step(i), figure)) for i in range(4))


def _undershoot(recording: Recording) -> float:
    step = recording.step(0)
    return math.degrees((step.overshoot or 0.0) * abs(step.steady_state or 0.0))


def _turn_facts(slow: Recording, fast: Recording) -> list[Fact]:
    at = f'at {TURN_SPEEDS[0]} and {TURN_SPEEDS[1]} km/h'
    return [
        entry
        for i, wheel in enumerate(WHEELS)
        for entry in response_facts(f'{wheel_words(wheel)} {at}', slow.step(i), fast.step(i))
    ]


def _worst(slips: Array) -> npt.NDArray[np.intp]:
    """Return the wheel with the largest slip in each row that has one, shape (n,)."""
    rows = slips.reshape(-1, 4)
    worst: npt.NDArray[np.intp] = np.argmax(np.abs(rows[np.isfinite(rows[:, 0])]), axis=1)
    return worst


def _front_left_is_worst(results: Results) -> Verdict:
    wide, right = (_worst(np.vstack([results[task].side_slip.reshape(-1, 4) for task in tasks])) for tasks in _SIDES)
    tight = results[TIGHT]
    others = tight.radius[np.any(np.argmax(np.abs(tight.side_slip), axis=2) != 0, axis=1)]
    last = float(others[-1]) if len(others) else None
    first = results[turn(TURN_SPEEDS[1])].side_slip[1]
    step = int(np.argmax(np.abs(first)))
    parts = [
        Part(
            f'steady left turns of 2 m and more (up to {number(kilometres_per_hour(results[FAST].speed[-1]))} km/h)',
            bool(np.all(wide == 0)),
            'The front axle, nearer to the centre of gravity, carries more of the side force; both its wheels move '
            'outward alike, and at the left one, which is slower, that makes the larger angle. '
            f'{_at_the_limit(results)}',
            reading=True,
        ),
        Part(
            'tighter ones',
            last is None,
            f'Up to {number(last)} m an outer wheel has the largest slip: the inner wheels are turned so far that '
            'moving outward is rather along their heading.',
            reading=True,
        ),
        Part(
            'right turns', bool(np.all(right == 0)), f'They are mirrored: {_name(right[0])} is the worst.', reading=True
        ),
        Part(
            'the moment after the steering step',
            step == 0,
            f'The slip begins as the steer angle, which is largest at the {_name(step)}, the axle that is farther '
            'away.',
            reading=True,
        ),
    ]
    facts = [
        fact('looked at', float(len(wide)), group='steady left turns'),
        fact('with front left worst', float(np.sum(wide == 0)), group='steady left turns'),
        fact('another wheel is the worst up to a radius of', last, 'm'),
        fact(_name(step), abs(math.degrees(float(first[step]))), '°', 'at 2 m just after the step'),
        fact('front left', abs(math.degrees(float(first[0]))), '°', 'at 2 m just after the step'),
    ]
    return verdict(parts, facts)


def _at_the_limit(results: Results) -> str:
    """Return where another tyre is the worst at the limit speed itself, in words."""
    found = results[FAST]
    worst = np.argmax(np.abs(found.mesh_slip[:, -1]), axis=1)
    others = np.flatnonzero(worst != 0)
    if not len(others):
        return 'That is so up to the limit speed.'
    radii = listed([number(radius) for radius in found.radius[others].tolist()])
    return f'At the limit speed itself, at {radii} m, {_name(worst[others[0]])} is the worst.'


def _name(wheel: int) -> str:
    return wheel_words(WHEELS[int(wheel)])


def _speed_and_radius(results: Results) -> Verdict:
    wide, tight = results[MAP], results[TIGHT]
    faster, wider = _ordered(wide)
    narrow = [_name(i) for i in range(4) if not falls_with_radius(tight.side_slip[:, :, i])]
    parts = [
        Part(
            f'the speed (up to the {SPEEDS[-1]} km/h of the thesis)',
            all(faster),
            'The side force that a turn takes grows with the square of the speed.',
        ),
        _higher_speeds(results[FAST]),
        Part('the radius from 2 m on', all(wider), 'The side force falls with the radius.', reading=True),
        Part(
            'the radius below',
            not narrow,
            f'There the slip of {listed(narrow)} grows with the radius: near the nearest centre the inner wheels, '
            'at 90°, hardly move across their heading.'
            if narrow
            else 'It does so there, too.',
            reading=True,
        ),
    ]
    count = int(np.sum(np.isfinite(wide.side_slip[:, :, 0])))
    ends = tuple(math.degrees(float(tight.side_slip[row, -1, 0])) for row in (0, -1))
    facts = [
        fact('steady turns looked at', float(count)),
        fact('points of the map past the limit', float(wide.side_slip[:, :, 0].size - count)),
        Fact(f'front left at 4 km/h, {number(tight.radius[0])} to {number(tight.radius[-1])} m', ends, '°'),
    ]
    return verdict(parts, facts)


def _higher_speeds(found: SlipMap) -> Part:
    """Return what becomes of it up to the limit of each radius, at speeds that the thesis does not go to."""
    words, first = f'higher speeds (up to {number(kilometres_per_hour(found.speed[-1]))} km/h)', turnover(found)
    slower = found.speed <= (found.speed[-1] if first is None else first.speed)
    wider = all(falls_with_radius(found.side_slip[:, slower, i]) for i in range(4))
    both = 'Both hold' if wider else 'The slip grows with the speed'
    if first is None:
        return Part(words, wider, f'{both} at all radii from 2 m on.', reading=True)
    why = (
        f'{both} up to {number(kilometres_per_hour(first.speed))} km/h, or to the limit speed where that is lower. '
        f'Beyond, in turns of {number(first.radius)} m and more, the vehicle comes to where it only runs wide, and the '
        f'slip of {_name(first.wheel)} is the first to fall with the speed.'
    )
    return Part(words, False, why, reading=True)


def _ordered(found: SlipMap) -> tuple[list[bool], list[bool]]:
    slips = [found.side_slip[:, :, i] for i in range(4)]
    return [rises_with_speed(values) for values in slips], [falls_with_radius(values) for values in slips]


def _speed_loss(results: Results) -> Verdict:
    small, wide = (results[loss(radius)] for radius in (5.0, 10.0))
    kept = [float(found.vx[-1] / found.vx[0]) for found in (small, wide)]
    shares = np.array([results[ratios(radius)] for radius in LOSS_RADII])
    parts = [
        Part(
            'less at 10 m than at 5 m', kept[0] < kept[1] < 1.0, 'Side forces of turned wheels have a part that brakes.'
        ),
        Part(
            'radius',
            bool(np.all(np.diff(shares, axis=0) > 0.0)),
            'In a tighter turn both force and steer angle are larger.',
        ),
        Part('initial speed', bool(np.all(np.diff(shares, axis=1) < 0.0)), 'A faster one takes a larger force.'),
    ]
    facts = [
        Fact('share of 6.2 m/s left after 10 s at 5 and 10 m', (100.0 * kept[0], 100.0 * kept[1]), '%'),
        fact('points of the map', float(shares.size)),
    ]
    return verdict(parts, facts)


CLAIMS = (
    Claim(
        3,
        'At a turn radius of 2 m slip, settling time and overshoot grow with the speed (6, 10, 14 km/h).',
        'sec. 4.2',
        (*map(turn, TURN_SPEEDS), LIMIT),
        _speed_in_a_small_turn,
    ),
    Claim(
        4,
        'The front left tyre is always the worst.',
        'sec. 4.2',
        (MAP, FAST, RIGHT, TIGHT, turn(TURN_SPEEDS[1])),
        _front_left_is_worst,
    ),
    Claim(
        5,
        'The slip of every tyre grows with the speed and falls with the turn radius.',
        'sec. 4.2',
        (MAP, FAST, TIGHT),
        _speed_and_radius,
    ),
    Claim(
        6,
        'A vehicle loses speed in a turn, less at 10 m than at 5 m; what is left falls with the initial speed and '
        'rises with the radius.',
        'sec. 4.2',
        (loss(5.0), loss(10.0), *map(ratios, LOSS_RADII)),
        _speed_loss,
    ),
)
