"""The least worst slip: near the force balance of linear tyres, and no steady turn on the path does better."""

import math

import numpy as np
import pytest

from omni_vehicle_ros.parameters import VehicleParameters
from omni_vehicle_ros.thesis.bounds import TRACTION, Bound, SlipBound, linear_bounds
from omni_vehicle_ros.thesis.trade_off import RADIUS, SPEED, GainCurve


def bound(traction: str, **changes: float) -> Bound:
    return SlipBound(RADIUS, SPEED, traction, VehicleParameters(**changes)).work()


def test_bounds_of_the_turn_of_the_thesis() -> None:
    """By steering the front axle's mean, with traction the mean of all four, as linear tyres have it: within 6 %.

    What is missing to them: the drag of turned wheels, their side force being not all lateral, and the loss of
    stiffness of the inner rear tyre.
    """
    front, _, every = linear_bounds(VehicleParameters(), RADIUS, SPEED)
    assert bound('alike').worst == pytest.approx(front, rel=0.06)
    assert bound('left and right').worst == pytest.approx(every, rel=0.06)
    assert bound('left and right').worst < 0.9 * bound('alike').worst


def test_at_the_bound_the_tyres_share_equally() -> None:
    """Steering alone: both front tyres slip alike; with traction: all four do."""
    steering, every = bound('alike'), bound('left and right')
    assert steering.side_slip[0] == pytest.approx(steering.side_slip[1], abs=1e-6)
    assert np.ptp(every.side_slip) < 1e-6
    left, right = every.drive_force[::2], every.drive_force[1::2]
    assert max(left) < 0.0 < min(right)


def test_drive_forces_against_each_other_buy_less_slip_for_grip() -> None:
    """With four free forces turned wheels pull the vehicle inward: half of the slip, but nearly all of the friction."""
    free = bound('free')
    assert free.worst < 0.75 * bound('left and right').worst
    assert free.friction_use > 0.9 > bound('left and right').friction_use


def test_a_small_turn_reaches_the_linear_bounds() -> None:
    """In a wide and slow turn steer angles and slips vanish, and so does the difference: at least of first order."""
    errors = []
    for radius in (20.0, 80.0):
        speed = math.sqrt(0.5 * radius)  # the same lateral acceleration
        front, _, every = linear_bounds(VehicleParameters(), radius, speed)
        found = [SlipBound(radius, speed, traction).work().worst for traction in TRACTION[:2]]
        errors.append([abs(found[0] / front - 1.0), abs(found[1] / every - 1.0)])
    assert np.all(np.array(errors[1]) < 0.3 * np.array(errors[0]))


def test_no_gain_beats_the_bound_on_the_path() -> None:
    """The gains of the thesis have less slip only off the path: the slip that remains is that of a wider turn."""
    least = bound('alike').worst
    for gain, error, slip in GainCurve((1.0, 1.0, 0.0, 0.0)).work():
        wider = SPEED**2 / ((1.0 + error) * RADIUS)
        allowed = least * wider / (SPEED**2 / RADIUS)
        assert slip > 0.97 * allowed, f'gain {gain:g}'
        assert error > 0.04
