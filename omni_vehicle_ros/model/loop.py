"""The algebraic loop of lateral acceleration, wheel loads and side forces, solved at one instant.

Written in the part of Python that numba compiles.
"""

from collections.abc import Callable
from typing import TypeVar

from omni_vehicle_ros.model.lanes import anywhere, select

LOOP_TOLERANCE = 1e-11  # of 1 m/s2 plus the acceleration
LOOP_STEPS = 12
BISECTIONS = 64

Wheels = TypeVar('Wheels')
Vehicle = TypeVar('Vehicle')
Forces = TypeVar('Forces')
Response = Callable[[float, Wheels, Vehicle], tuple[float, Forces]]


def solve_loop(
    response: Response[Wheels, Vehicle, Forces], limit: float, wheels: Wheels, constants: Vehicle
) -> tuple[float, Forces]:
    """Return the lateral acceleration [m/s2] that causes itself, and the tyre forces.

    Inverse quadratic interpolation from 0, where the loads are static; if it fails, bisection. The start
    never depends on the past, so that the result is a function of the wheels.

    Parameters
    ----------
    response
        From an acceleration, the wheels and the vehicle to the acceleration that these cause, and the forces.
    limit
        Largest acceleration that friction allows, to either side [m/s2].
    wheels, constants
        For the response.
    """
    guess = slope = last = gap_last = gap_before_last = 0.0
    unsolved = True
    for number in range(LOOP_STEPS):
        reached, forces = response(guess, wheels, constants)
        gap = reached - guess
        unsolved = abs(gap) > LOOP_TOLERANCE * (1.0 + abs(guess))
        if not anywhere(unsolved):
            return reached, forces
        moving = unsolved & (gap != gap_last) & (gap != gap_before_last)
        if not anywhere(moving):
            break
        step = gap
        if number > 0:
            # Newton's form of the inverse interpolation through the last points, taken at gap 0.
            slope_last, slope = slope, (guess - last) / (gap - gap_last)
            bend = (slope - slope_last) / (gap - gap_before_last) if number > 1 else 0.0
            step = gap * (gap_last * bend - slope)
        gap_before_last, gap_last, last = gap_last, gap, guess
        guess = select(moving, max(-limit, min(limit, guess + step)), guess)
    guess = select(unsolved, bisected(response, limit, wheels, constants), guess)
    return response(guess, wheels, constants)


def bisected(
    response: Response[Wheels, Vehicle, Forces], limit: float, wheels: Wheels, constants: Vehicle
) -> float:
    """Return the acceleration that causes itself, by bisection; parameters as in `solve_loop`."""
    low, high = -limit, limit
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        above = response(middle, wheels, constants)[0] > middle
        low, high = select(above, middle, low), select(above, high, middle)
    return 0.5 * (low + high)
