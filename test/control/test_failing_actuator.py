"""Actuators that fail do as the vocabulary says, and stay within range and rate whatever fails."""

import math
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omni_vehicle_ros.control.actuator import DriveActuator, SteerActuator
from omni_vehicle_ros.control.failing_actuator import FailingDrive, FailingSteer
from omni_vehicle_ros.faults import KINDS, OK, make_fault
from omni_vehicle_ros.parameters import WheelModuleParameters

PERIOD, NS = 0.005, 5_000_000
PARAMETERS = WheelModuleParameters()


def steering(*faults: tuple[int, str], cycles: int = 400, set_point=lambda time: 0.5) -> list[float]:
    """Return the angle at the begin of each cycle, with faults from cycles on."""
    steer, begun = FailingSteer(PARAMETERS), dict(faults)
    angles = []
    for cycle in range(cycles):
        if cycle in begun:
            failure, _, value = begun[cycle].partition(' ')
            steer.fail(make_fault('front_left/steering', failure, float(value) if value else None))
        angles.append(steer.update(cycle * NS, set_point(cycle * PERIOD), PERIOD)[0])
    return angles


def test_stuck_holds_the_angle_and_goes_on_from_there() -> None:
    angles = steering((20, 'stuck'), (100, 'ok'))
    assert 0.1 < angles[20] < 0.4
    assert set(angles[20:101]) == {angles[20]}
    # From there on as an actuator that starts at this angle.
    fresh = SteerActuator(PARAMETERS, angles[20])
    assert angles[100:] == [fresh.update(cycle * NS, 0.5, PERIOD)[0] for cycle in range(100, 400)]


def test_slow_turns_at_its_share_of_the_rate() -> None:
    angles = steering((0, 'slow 0.1'), cycles=100)
    rates = [(b - a) / PERIOD for a, b in pairwise(angles)]
    assert rates[50] == pytest.approx(0.1 * PARAMETERS.steer_rate_limit)
    assert max(rates) <= 0.1 * PARAMETERS.steer_rate_limit * (1 + 1e-9)


def test_wrong_adds_its_value_to_where_it_goes() -> None:
    assert steering((0, 'wrong -0.2'))[-1] == pytest.approx(0.3, abs=1e-6)


@given(delay=st.integers(0, 100))
@settings(deadline=None, max_examples=20)
def test_delayed_follows_as_much_later(delay: int) -> None:
    def ramp(time: float) -> float:
        return 0.2 * time

    late, sound = steering((0, f'delayed {delay * PERIOD}'), set_point=ramp), steering(set_point=ramp)
    assert late[delay:] == pytest.approx(sound[: 400 - delay], abs=1e-9)


def test_intermittent_is_stuck_in_the_first_half_of_its_period() -> None:
    angles = steering((0, 'intermittent 0.2'), set_point=lambda time: time)
    assert set(angles[:20]) == {0.0}
    assert angles[30] > 0.0
    assert set(angles[40:60]) == {angles[40]}


def test_off_is_where_the_road_puts_it() -> None:
    steer = FailingSteer(PARAMETERS)
    steer.fail(make_fault('front_left/steering', 'off'))
    steer.measured = 0.4
    assert steer.update(0, 0.0, PERIOD) == (0.4, 0.0)
    steer.fail(make_fault('front_left/steering', OK))
    assert steer.update(NS, 0.0, PERIOD)[0] == 0.4


FAILURES = st.sampled_from((OK, *KINDS['steering']))


@given(st.lists(st.tuples(st.integers(0, 150), FAILURES, st.floats(-3.0, 3.0)), max_size=6))
@settings(deadline=None, max_examples=40)
def test_angles_stay_in_range_and_rate_whatever_fails_in_turn(story: list[tuple[int, str, float]]) -> None:
    steer, foreseen = FailingSteer(PARAMETERS), None
    for cycle in range(160):
        for _, failure, _ in (entry for entry in story if entry[0] == cycle):
            steer.fail(make_fault('front_left/steering', failure))
        if foreseen is not None:
            steer.measured = foreseen
        aim = next((target for begin, _, target in reversed(story) if begin <= cycle), 1.0)
        angle, rate = steer.update(cycle * NS, aim, PERIOD)
        assert abs(angle) <= PARAMETERS.steer_limit + 1e-12
        assert abs(rate) <= PARAMETERS.steer_rate_limit * (1 + 1e-9)
        if foreseen is not None:
            assert angle == pytest.approx(foreseen, abs=1e-9)
        foreseen = angle + rate * PERIOD


def torques(failure: str, value: float | None = None, cycles: int = 100) -> list[float]:
    """Return the torques of a drive that is told 100 N m, with a fault from its 50th cycle on."""
    drive, said = FailingDrive(PARAMETERS), []
    for cycle in range(cycles):
        if cycle == 50:
            drive.fail(make_fault('front_left/drive', failure, value))
        said.append(drive.update(100.0 if cycle < 60 else 40.0, PERIOD))
    return said


def test_drives_that_fail() -> None:
    sound = torques(OK)
    assert set(torques('off')[50:]) == {0.0}
    assert set(torques('stuck')[50:]) == {sound[49]}
    assert torques('wrong', -0.5)[50:] == pytest.approx([-0.5 * torque for torque in sound[50:]])
    assert set(torques('intermittent', 0.1)[50:60]) == {0.0}
    # Ten times the time constant: what is left of a step after t is exp(-t / 0.5 s).
    slow = torques('slow', 0.1)
    assert (slow[-1] - 40.0) / (slow[59] - 40.0) == pytest.approx(math.exp(-40 * PERIOD / 0.5), rel=0.01)
    assert torques('garbage', 200.0) == torques('garbage', 200.0)
    assert max(map(abs, torques('garbage', 200.0))) <= 200.0


def test_no_fault_drives_beyond_the_limit() -> None:
    for failure in KINDS['drive']:
        drive = FailingDrive(WheelModuleParameters(drive_torque_limit=50.0))
        drive.fail(make_fault('front_left/drive', failure, 2.0 if failure == 'wrong' else None))
        assert all(abs(drive.update(100.0, PERIOD)) <= 50.0 for _ in range(100))


def test_a_sound_actuator_is_the_plain_one() -> None:
    plain, sound = SteerActuator(PARAMETERS), FailingSteer(PARAMETERS)
    drive, other = DriveActuator(PARAMETERS), FailingDrive(PARAMETERS)
    for cycle in range(200):
        aim = math.sin(0.05 * cycle)
        assert sound.update(cycle * NS, aim, PERIOD) == plain.update(cycle * NS, aim, PERIOD)
        assert other.update(1000.0 * aim, PERIOD) == drive.update(1000.0 * aim, PERIOD)
