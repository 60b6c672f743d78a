"""Claims 11 to 13, about bank, wind and friction (thesis sec. 4.4)."""

import math
from collections.abc import Iterable
from dataclasses import replace
from typing import Any

from scipy.optimize import brentq

from omni_vehicle_ros.analysis.signals import StepMetrics
from omni_vehicle_ros.model.body import Environment
from omni_vehicle_ros.model.steady_turn import steady_turn
from omni_vehicle_ros.parameters import VehicleParameters
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
from omni_vehicle_ros.thesis.disturbances import (
    BEGIN,
    CENTRES,
    END,
    FAST,
    FRICTION_RADIUS,
    FRICTION_SPEED,
    FRICTIONS,
    SLOW,
    WIND,
    friction,
)
from omni_vehicle_ros.thesis.tasks import Results, Run, km_per_h, run
from omni_vehicle_ros.thesis.words import number, percent

BANK, SIMILAR, EQUAL = 0.01, 0.2, 0.02
"""Bank [rad]; by how much similar and equal values may differ."""

HELD = 6.0
"""How long bank and wind act for the claims [s]: long enough for every response."""

_LINEAR_SPEED = 10  # km/h
_CONSTANT_CY: dict[str, Any] = {
    'vehicle.airflow_angles': [0.01, 0.3455],
    'vehicle.side_force_coefficients': [0.58, 0.58],
}

Steps = list[StepMetrics]


def held_bank(angle: float, speed: int) -> Run:
    """Return a run over a bank [rad] that begins at once and does not end, at a speed [km/h]."""
    return run('bank', bank=angle, speed=km_per_h(speed), duration=HELD, **{'plant.bank': angle})


def held_wind(speed: int, centre: float = 0.0, **settings: Any) -> Run:
    """Return a run in a wind that begins at once and does not end, at a speed [km/h]; its aerodynamic centre [m]."""
    held = {'plant.wind': WIND, **settings}
    return run('wind', wind=WIND, speed=km_per_h(speed), aerodynamic_centre=centre, duration=HELD, **held)


def _steps(results: Results, task: Run) -> Steps:
    recording = results[task]
    return [recording.step(wheel) for wheel in range(4)]


def _ratios(one: Steps, other: Steps, figure: str) -> list[float]:
    return [getattr(b, figure) / getattr(a, figure) for a, b in zip(one, other, strict=True)]


def _larger(one: Steps, other: Steps, figure: str) -> bool:
    return all(abs(getattr(b, figure)) > abs(getattr(a, figure)) for a, b in zip(one, other, strict=True))


def _near(values: Iterable[float], aim: float, tolerance: float) -> bool:
    return all(abs(value / aim - 1.0) <= tolerance for value in values)


def _response_facts(words: str, one: Steps, other: Steps) -> list[Fact]:
    """Return the figures of two responses, of the left tyres."""
    left = ('front left', 0), ('rear left', 2)
    return [entry for name, i in left for entry in response_facts(f'{name} {words}', one[i], other[i])]


def _held_fact(what: str) -> Fact:
    """Return how long a disturbance acts, which is longer than in the figures: there not every slip settles."""
    return fact(f'the {what} is held for (in the figures {number(END - BEGIN)} s)', HELD, 's')


def _bank(results: Results) -> Verdict:
    slow, fast, double = (
        _steps(results, task) for task in (held_bank(BANK, SLOW), held_bank(BANK, FAST), held_bank(2.0 * BANK, FAST))
    )
    share = _ratios(slow, fast, 'steady_state')
    twice = [_ratios(fast, double, figure) for figure in ('steady_state', 'overshoot', 'settling_time')]
    parts = [
        Part(
            'more overshoot and a longer settling time when faster',
            _larger(slow, fast, 'overshoot') and _larger(slow, fast, 'settling_time'),
            'The tyres damp lateral speed and yaw rate the less the faster the vehicle is.',
        ),
        Part(
            f'a similar value (within {percent(SIMILAR)})',
            _near(share, 1.0, SIMILAR),
            _share_in_words(results, share[0]),
        ),
        Part(
            'front above rear',
            _larger(slow[2:], slow[:2], 'steady_state') and _larger(fast[2:], fast[:2], 'steady_state'),
            'Their moments about the centre of gravity balance, and the front axle is nearer to it.',
        ),
        Part(
            f'twice the bank, twice the slip and the same dynamics (within {percent(EQUAL)})',
            _near(twice[0], 2.0, EQUAL) and _near((*twice[1], *twice[2]), 1.0, EQUAL),
            'At slips of a tenth of a degree everything is linear.',
        ),
    ]
    facts = [_held_fact('bank'), *_response_facts(f'at {SLOW} and {FAST} km/h', slow, fast)]
    return verdict(parts, [*facts, fact('slip on twice the bank, as a multiple of that on the bank', twice[0][0])])


def _share_in_words(results: Results, share: float) -> str:
    vehicle = results[held_bank(BANK, SLOW)].scenario.vehicle
    plain = replace(vehicle, front_roll_steer=0.0, rear_roll_steer=0.0)
    road = Environment(bank=BANK)
    slow, fast = (abs(_straight(plain, km_per_h(speed), road)) for speed in (SLOW, FAST))
    held = [1.0 / (1.0 + _stability_factor(vehicle) * km_per_h(speed) ** 2) for speed in (SLOW, FAST)]
    return (
        f'At {FAST} km/h the slip is {percent(share)} of that at {SLOW} km/h: the vehicle yields to the bank, and '
        'the turn takes over a part of the force. Of m g sin b the tyres hold 1 / (1 + A v²), A = m (lr \u2212 lf) '
        f'/ (2 C l²): {percent(held[0])} at {SLOW} km/h and {percent(held[1])} at {FAST} km/h, which is '
        f'{percent(held[1] / held[0])} of the former. So it is in the model without roll steer '
        f'({percent(fast / slow)}); roll steer takes off the rest.'
    )


def _stability_factor(vehicle: VehicleParameters) -> float:
    """Return the stability factor of the linear vehicle without roll steer [s2/m2] (Abe, ch. 3)."""
    arms = vehicle.cg_to_rear_axle - vehicle.cg_to_front_axle
    return vehicle.mass * arms / (2.0 * vehicle.cornering_stiffness * vehicle.wheelbase**2)


def _straight(vehicle: VehicleParameters, speed: float, environment: Environment) -> float:
    """Return the steady slip of the front left tyre with all wheels straight ahead [rad], NaN if there is none."""
    turn = steady_turn(vehicle, math.inf, speed, environment)
    return math.nan if turn is None else turn.side_slip[0]


def _wind(results: Results) -> Verdict:
    slow, fast = (_steps(results, held_wind(speed)) for speed in (SLOW, FAST))
    constant = [_steps(results, held_wind(speed, **_CONSTANT_CY)) for speed in (SLOW, FAST)]
    centres = {
        speed: [abs(_steps(results, held_wind(speed, centre))[0].steady_state or math.nan) for centre in CENTRES]
        for speed in (SLOW, FAST)
    }
    parts = [
        Part(
            'worse when faster',
            all(
                _larger(one, other, figure)
                for one, other in ((slow, fast), constant)
                for figure in ('steady_state', 'overshoot', 'settling_time')
            ),
            'The force grows with the square of the airspeed, by more than Cy falls with the angle of the airflow; '
            'with one Cy of 0.58 for all angles even more.',
        ),
        *(
            Part(f'the aerodynamic centre at {speed} km/h', middle < ahead and behind < middle, why, reading=True)
            for (speed, (middle, ahead, behind)), why in zip(
                centres.items(), (_FRONT_LOADED, _centre_in_words(results)), strict=True
            )
        ),
    ]
    facts = [_held_fact('wind'), *_response_facts(f'at {SLOW} and {FAST} km/h', slow, fast)]
    shown = ', '.join(number(CENTRES[i]) for i in (2, 0, 1))
    facts += [
        Fact(f'front left at {speed} km/h with lw = {shown} m', tuple(map(math.degrees, (behind, middle, ahead))), '°')
        for speed, (middle, ahead, behind) in centres.items()
    ]
    return verdict(parts, facts)


_FRONT_LOADED = (
    'A wind that acts farther ahead takes more force from the front tyres, one that acts farther behind less: their '
    'moments about the centre of gravity balance.'
)


def _centre_in_words(results: Results) -> str:
    vehicle = results[held_wind(SLOW)].scenario.vehicle
    ahead = replace(vehicle, aerodynamic_centre=CENTRES[1])
    road = Environment(wind=WIND)

    def gain(speed: float) -> float:
        return abs(_straight(ahead, speed, road)) - abs(_straight(vehicle, speed, road))

    turning = brentq(gain, km_per_h(SLOW), km_per_h(FAST))
    return (
        'That wind also turns the vehicle away from it, the more the faster it drives, and the turn relieves all '
        f'tyres. From {number(kilometres_per_hour(turning))} km/h on this is more: there lw > 0 makes the front left '
        'slip smaller.'
    )


def _friction(results: Results) -> Verdict:
    dry, snow = (_steps(results, friction(coefficient)) for coefficient in FRICTIONS)
    vehicle = results[friction(FRICTIONS[0])].scenario.vehicle
    slow = [
        turn.side_slip[0]
        for coefficient in FRICTIONS
        if (
            turn := steady_turn(
                vehicle, FRICTION_RADIUS, km_per_h(_LINEAR_SPEED), Environment(friction=(coefficient,) * 4)
            )
        )
    ]
    why = (
        'Less friction bends the curve of the tyre earlier. It makes no difference as long as all tyres are in '
        f'their linear region: at {_LINEAR_SPEED} km/h the slips differ by '
        f'{number(math.degrees(slow[1] - slow[0]))}°.'
    )
    parts = [
        Part('slip', _larger(dry, snow, 'steady_state'), why),
        Part(
            'overshoot',
            _larger(dry, snow, 'overshoot'),
            'Where the curve of a tyre is bent, more slip gives less force than before: lateral speed and yaw rate are '
            'damped less.',
        ),
        Part('settling time', _larger(dry, snow, 'settling_time'), 'For the same reason.'),
    ]
    roads = ' and '.join(map(number, FRICTIONS))
    return verdict(parts, _response_facts(f'on friction {roads} at {FRICTION_SPEED} km/h', dry, snow))


CLAIMS = (
    Claim(
        11,
        'Bank: faster means more overshoot and a longer settling time, but a similar slip; front tyres slip more '
        'than rear ones; twice the bank makes twice the slip and leaves the dynamics.',
        'sec. 4.4.1',
        (held_bank(BANK, SLOW), held_bank(BANK, FAST), held_bank(2.0 * BANK, FAST)),
        _bank,
    ),
    Claim(
        12,
        'Wind: worse when faster; for the front left tyre an aerodynamic centre ahead (lw > 0) is worse, one '
        'behind (lw < 0) better.',
        'sec. 4.4.2',
        tuple(
            task
            for speed in (SLOW, FAST)
            for task in (*(held_wind(speed, centre) for centre in CENTRES), held_wind(speed, **_CONSTANT_CY))
        ),
        _wind,
    ),
    Claim(
        13,
        'A friction of 0.5 gives more slip, overshoot and a longer settling time than one of 0.9.',
        'sec. 4.4.3',
        tuple(map(friction, FRICTIONS)),
        _friction,
    ),
)
