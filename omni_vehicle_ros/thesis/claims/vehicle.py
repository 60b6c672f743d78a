"""Claims 1 and 2, about what the vehicle can do at all (thesis sec. 2.2.4 and 3.2.1)."""

import math

from omni_vehicle_ros.model.constants import constants
from omni_vehicle_ros.model.kinematics import Icr, steer_angles, twist_of_icr
from omni_vehicle_ros.model.steady_turn import Limit
from omni_vehicle_ros.parameters import VehicleParameters
from omni_vehicle_ros.thesis.claims.claim import Claim, Part, Verdict, fact, kilometres_per_hour, verdict
from omni_vehicle_ros.thesis.simple_turning import HIGHEST
from omni_vehicle_ros.thesis.steady import Limits
from omni_vehicle_ros.thesis.tasks import Results, run
from omni_vehicle_ros.thesis.words import number

FRICTION, STICKY_FRICTION = 0.9, 2.0
NEAREST, CLAIMED_NEAREST = 0.73, 0.718  # m

TIGHTEST = Limits(run('turning_map'), (NEAREST,), HIGHEST)
STICKY = Limits(run('turning_map', **{'plant.friction': [STICKY_FRICTION] * 4}), (10.0,), HIGHEST)
"""Turns about next to the nearest centre, and on an impossible road."""


def nearest_icr(vehicle: VehicleParameters, x: float = 0.0) -> float:
    """Return how near to the vehicle's axis an ICR may come for wheels within 90 deg [m].

    Parameters
    ----------
    vehicle
        Its geometry.
    x
        Of the ICR, ahead of the centre of gravity [m].
    """

    def reached(y: float) -> bool:
        twist = twist_of_icr(Icr(x, y), 1.0)
        return all(steer_angles(twist, (0.0, 0.0, 0.0, 0.0), math.pi, vehicle, 'road').reachable)

    low, high = 1e-6, 10.0
    while high - low > 1e-6:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if reached(middle) else (middle, high)
    return high


def _nearest(results: Results) -> Verdict:
    vehicle = run('turning_map').load().vehicle
    found, beside_front = nearest_icr(vehicle), nearest_icr(vehicle, vehicle.cg_to_front_axle)
    (limit,) = results[TIGHTEST]
    why = (
        'There the inner wheels stand at 90°. That is so wherever the centre lies ahead or behind: '
        f'{number(beside_front)} m beside the front axle, too. Wheels that may turn by 180° less and roll backward '
        'reach every centre.'
    )
    facts = [
        fact('nearest centre', found, 'm'),
        fact(f'limit speed of a turn about one at {number(NEAREST)} m', kilometres_per_hour(limit.speed), 'km/h'),
    ]
    return verdict([Part(f'{number(CLAIMED_NEAREST)} m', abs(found - CLAIMED_NEAREST) < 5e-4, why)], facts)


def _negative_load(results: Results) -> Verdict:
    vehicle = run('turning_map').load().vehicle
    model = constants(vehicle)
    front, rear = model.front_load / model.front_transfer, model.rear_load / model.rear_transfer
    lift, grip = min(front, rear), FRICTION * vehicle.gravity
    (sticky,) = results[STICKY]
    formula = Part(
        'the load transfer of eq. 2.6 taken by itself',
        lift > 0.0,
        f'It grows with the lateral acceleration without end and exceeds the static load from {number(lift)} m/s² on.',
        reading=True,
    )
    tyres = Part(
        f'the vehicle on its tyres with a friction of {number(FRICTION)}',
        lift < grip,
        f'The tyres give {number(grip)} m/s² at the very most: the vehicle slides before it lifts a wheel. That '
        f'takes a friction of more than {number(lift / vehicle.gravity)}. And a road never pulls: a lifted wheel '
        'carries nothing.',
        reading=True,
    )
    sticky_words = (
        f'with a friction of {number(STICKY_FRICTION)} a wheel lifts in a turn of {number(STICKY.radii[0])} m from'
    )
    facts = [
        fact('the rear inner wheel lifts at', rear, 'm/s²'),
        fact('the front inner wheel lifts at', front, 'm/s²'),
        fact('the tyres give at most', grip, 'm/s²'),
        fact(sticky_words, _lift_speed(sticky), 'km/h'),
    ]
    return verdict([formula, tyres], facts)


def _lift_speed(limit: Limit) -> float | None:
    return kilometres_per_hour(limit.speed) if limit.cause == 'lift' else None


CLAIMS = (
    Claim(1, 'The nearest turn centre for wheels within 90° is (0, 0.718) m.', 'sec. 3.2.1', (TIGHTEST,), _nearest),
    Claim(
        2,
        'Load transfer can make the load of a wheel negative, at extreme speed, and roll the vehicle over.',
        'sec. 2.2.4',
        (STICKY,),
        _negative_load,
    ),
)
