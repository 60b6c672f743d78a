"""Claims 7 to 10, about traction and brake (thesis sec. 4.3)."""

import math

import numpy as np

from omni_vehicle_ros.thesis.claims.balance import PulledTurn
from omni_vehicle_ros.thesis.claims.claim import Claim, Fact, Part, Verdict, fact, verdict
from omni_vehicle_ros.thesis.tasks import Recording, Results
from omni_vehicle_ros.thesis.traction import (
    ACTING,
    BRAKE,
    FREE,
    ROLLING,
    SEEN,
    SETTLED,
    START,
    TRACTION,
    TURN_RADIUS,
    TURNING,
    Difference,
    at,
    difference,
    with_circle,
    without_circle,
)
from omni_vehicle_ros.thesis.words import listed, number, percent, wheel_words
from omni_vehicle_ros.wheels import WHEELS

FORCE, CLAIMED_SPEED = 500.0, 3.1
_LARGEST = 'largest change of the front left slip'
PULLED = PulledTurn(with_circle(TRACTION), TURN_RADIUS, 2.8, (-FORCE, 0.0, FORCE))
"""Force of each wheel [N], the speed after it [m/s], and the turn at about the speed at which traction begins."""


def _speed_by_traction(results: Results) -> Verdict:
    recording = results[with_circle(TRACTION)]
    speed = float(recording.vx[at(recording, TURNING)])
    exact = 4.0 * FORCE * (ROLLING - START) / recording.scenario.vehicle.mass
    why = 'Rolling straight on costs nothing: the momentum is force times time.'
    facts = [fact('speed on the straight', speed, 'm/s'), fact('4 F t / m', exact, 'm/s')]
    return verdict([Part(f'{number(CLAIMED_SPEED)} m/s', abs(speed - CLAIMED_SPEED) < 0.05, why)], facts)


def _change(recording: Recording) -> list[tuple[float, float]]:
    """Return the slip of every wheel when the force begins and when it ends [rad], as sizes."""
    before, after = at(recording, ACTING), at(recording, FREE)
    return [(abs(float(slip[before])), abs(float(slip[after]))) for slip in recording.side_slip.T]


def _grown(pair: tuple[float, float]) -> bool:
    return pair[1] > pair[0]


def _same_speed(results: Results, row: int) -> list[bool]:
    """Tell for every wheel whether a force makes its slip larger at the same speed."""
    found = results[PULLED]
    return [bool(abs(slip) > abs(free)) for slip, free in zip(found[row], found[1], strict=True)]


def _names(wheels: list[bool]) -> str:
    return listed([wheel_words(wheel) for wheel, there in zip(WHEELS, wheels, strict=True) if there]) or 'none'


def _slip_by_traction(results: Results) -> Verdict:
    recording = results[with_circle(TRACTION)]
    grown, pulled = [_grown(pair) for pair in _change(recording)], _same_speed(results, 2)
    rows = recording.rows(ACTING, FREE)
    settled = all(recording.step(wheel, ACTING, FREE).settling_time is not None for wheel in range(4))
    speeds = recording.vx[rows]
    parts = [
        Part(
            'every slip, while the speed grows',
            all(grown),
            f'The speed goes from {number(float(speeds[0]))} to {number(float(speeds[-1]))} m/s, and the side force '
            'with its square.',
            reading=True,
        ),
        Part(
            'every slip at the same speed',
            all(pulled),
            f'There traction raises the slip of {_names(pulled)} and lowers the others: wheels that are turned in '
            'pull the nose inward and relieve their tyres, those that are turned out do the opposite.',
            reading=True,
        ),
        Part(
            'the settling time',
            settled,
            'While the speed grows no slip settles, and there is no settling time to speak of.',
            reading=True,
        ),
    ]
    return verdict(parts, [*_change_facts(recording), *_pulled_facts(results, 2)])


def _change_facts(recording: Recording) -> list[Fact]:
    changes = [tuple(map(math.degrees, pair)) for pair in _change(recording)]
    at = f'at {number(ACTING)} and {number(FREE)} s'
    return [Fact(wheel_words(wheel), change, '°', at) for wheel, change in zip(WHEELS, changes, strict=True)]


def _pulled_facts(results: Results, row: int) -> list[Fact]:
    found, force = np.degrees(results[PULLED]), PULLED.forces[row]
    at = f'at {number(PULLED.speed)} m/s without and with {number(force)} N'
    return [
        Fact(wheel_words(wheel), (float(found[1, i]), float(found[row, i])), '°', at)
        for i, wheel in enumerate(WHEELS)
    ]


def _friction_circle(results: Results) -> Verdict:
    (pulled, afterwards), (braked, _) = (_circle(results, name) for name in (TRACTION, BRAKE))
    parts = [
        Part(
            'the largest change while traction acts',
            pulled.slip > 0.0,
            'Traction takes capacity from the tyre, but a tyre in its linear region does not feel its capacity: '
            f'nothing changes until {number(pulled.begin)} s. At most it is {percent(pulled.share)} of the slip.',
            reading=True,
        ),
        Part(
            'the largest change while a brake acts',
            braked.slip > 0.0,
            f'Here it is {percent(braked.share)}, before the vehicle has become slow.',
            reading=True,
        ),
        Part('the time after the traction', afterwards.slip > 0.0, _afterwards(results, afterwards), reading=True),
    ]
    facts = [
        fact(f'by {name} from {number(ACTING)} to {number(FREE)} s', math.degrees(change.slip), '°', _LARGEST)
        for name, change in (('traction', pulled), ('a brake', braked))
    ]
    later = f'after the traction from {number(FREE + SETTLED)} s on'
    facts.append(fact(later, math.degrees(afterwards.slip), '°', _LARGEST))
    return verdict(parts, facts)


def _circle(results: Results, scenario: str) -> tuple[Difference, Difference]:
    """Return what the friction circle does to the front left slip while a force acts, and afterwards."""
    one, other = results[with_circle(scenario)], results[without_circle(scenario)]
    return difference(one, other, ACTING, FREE), difference(one, other, FREE + SETTLED, float(one.time[-1]))


def _afterwards(results: Results, after: Difference) -> str:
    runs = [results[task] for task in (with_circle(TRACTION), without_circle(TRACTION))]
    speeds = [float(found.vx[at(found, FREE)]) for found in runs]
    return (
        f'From {number(FREE + SETTLED)} s on the slip with it is {after} at most: the larger slip has braked the '
        f'vehicle, to {number(speeds[0], 4)} in place of {number(speeds[1], 4)} m/s when the traction ends.'
    )


def _slip_by_brake(results: Results) -> Verdict:
    recording = results[with_circle(BRAKE)]
    grown, braked = [_grown(pair) for pair in _change(recording)], _same_speed(results, 0)
    rows = recording.rows(ACTING, FREE)
    sizes = np.abs(recording.side_slip[rows])
    rises = (sizes.max(axis=0) - sizes[0]) > SEEN
    parts = [
        Part(
            'every slip, as the speed falls',
            not any(grown),
            'The side force falls with the square of the speed.',
            reading=True,
        ),
        Part(
            'the first moment',
            not any(rises),
            f'The slip of {_names(rises.tolist())} rises a little before the speed has fallen.',
            reading=True,
        ),
        Part(
            'every slip at the same speed',
            not any(braked),
            f'There a brake raises the slip of {_names(braked)}: wheels that are turned in push the nose outward as '
            'they brake.',
            reading=True,
        ),
    ]
    return verdict(parts, [*_change_facts(recording), *_pulled_facts(results, 0)])


_BOTH = tuple(task(name) for name in (TRACTION, BRAKE) for task in (with_circle, without_circle))
CLAIMS = (
    Claim(
        7,
        'A force of 500 N on each of four wheels for 2 s from rest gives 3.1 m/s.',
        'sec. 4.3.1',
        (with_circle(TRACTION),),
        _speed_by_traction,
    ),
    Claim(
        8,
        'Traction in a turn raises every slip, with a longer settling time.',
        'sec. 4.3.1',
        (with_circle(TRACTION), PULLED),
        _slip_by_traction,
    ),
    Claim(
        9,
        'The friction circle raises the front left slip, under traction and brake.',
        'sec. 4.3',
        _BOTH,
        _friction_circle,
    ),
    Claim(10, 'A brake in a turn lowers every slip.', 'sec. 4.3.2', (with_circle(BRAKE), PULLED), _slip_by_brake),
)
