"""Locked wheels, words of the modules, and twins that begin in the middle of a drive."""

import math

import pytest

from omni_vehicle_ros.control.fault_tolerance.condition import DriveFault, SteerFault, WheelCondition
from omni_vehicle_ros.control.fault_tolerance.drive_check import LOCKED_AFTER
from omni_vehicle_ros.control.fault_tolerance.monitor import Heard, Measured, ModuleMonitor
from omni_vehicle_ros.control.fault_tolerance.word_check import SETTLING, Word, WordCheck
from omni_vehicle_ros.model.kinematics import Twist
from omni_vehicle_ros.parameters import VehicleParameters, WheelModuleParameters

PERIOD, STEP = 0.005, 5_000_000
VEHICLE = VehicleParameters()
ZEROS = (0.0, 0.0, 0.0, 0.0)


def straight(speeds, cycles=100, torque=ZEROS):
    """Return what is wrong, cycle by cycle, with wheels that point ahead and turn at given speeds [m/s]."""
    monitor = ModuleMonitor(VEHICLE, WheelModuleParameters(), PERIOD, 0.2)
    found = []
    for cycle in range(cycles):
        rolling = tuple(speed / VEHICLE.wheel_radius for speed in speeds(cycle))
        heard = (Heard(begun=True, age=STEP),) * 4
        found.append(monitor.update(cycle * STEP, Measured(ZEROS, rolling, torque), heard).wheels)
        monitor.told(cycle * STEP, Twist(4.0, 0.0, 0.0), ZEROS, ZEROS)
    return found


@pytest.mark.parametrize('locked', [(0,), (0, 2), (0, 3), (2, 3)])
def test_locked_wheels_are_named_while_two_others_roll(locked):
    """They lock in cycle 50."""
    found = straight(lambda cycle: [0.0 if i in locked and cycle >= 50 else 4.0 for i in range(4)])
    assert not any(wheel.drive.value for wheels in found[:50] for wheel in wheels)
    expected = tuple(DriveFault.LOCKED if i in locked else DriveFault.NONE for i in range(4))
    assert tuple(wheel.drive for wheel in found[49 + LOCKED_AFTER]) == expected


def test_a_second_locked_wheel_is_named_beside_the_first():
    """The left side: those that stand may not tell each other that the vehicle stands."""
    found = straight(lambda cycle: [0.0 if cycle >= 70 else 4.0, 4.0, 0.0 if cycle >= 30 else 4.0, 4.0])
    assert found[69][2].drive is DriveFault.LOCKED and found[69][0].drive is DriveFault.NONE
    assert [wheel.drive.value for wheel in found[69 + LOCKED_AFTER]] == ['is locked', '', 'is locked', '']


def test_one_wheel_that_spins_says_nothing_of_three_that_stand():
    assert all(wheel == WheelCondition() for wheels in straight(lambda cycle: [9.0, 0.0, 0.0, 0.0]) for wheel in wheels)


def test_wheels_with_grip_are_not_locked_while_others_spin_on_ice():
    """At 0.3 m/s2 they have a speed; beside them two spin at a hundred times that."""
    found = straight(lambda cycle: [rate * cycle * PERIOD for rate in (0.3, 30.0, 30.0, 0.3)])
    assert all(wheel.drive is DriveFault.NONE for wheels in found for wheel in wheels)


def turning(cycle):
    angle = 0.4 * math.sin(2.0 * math.pi * 0.5 * cycle * PERIOD)
    return (angle, 0.9 * angle, -angle, -0.9 * angle), (100.0,) * 4


def words(cycle):
    """Return what sound modules have said of the cycle before."""
    angles, torques = turning(cycle)
    return [Word((cycle - 1) * STEP, angle, torque) for angle, torque in zip(angles, torques, strict=True)]


def test_joints_that_are_as_their_modules_say_are_not_contradicted():
    check = WordCheck(PERIOD)
    assert not any(check.update(cycle * STEP, *turning(cycle), words(cycle)) for cycle in range(400))
    late = WordCheck(PERIOD)
    assert not any(late.update(cycle * STEP, *turning(cycle - 4), words(cycle)) for cycle in range(400))


@pytest.mark.parametrize('factor', [-7.4, 0.0, 0.5, 1.5])
def test_joints_that_are_all_scaled_are_contradicted(factor):
    check = WordCheck(PERIOD)
    angles, torques = ([factor * number for number in numbers] for numbers in turning(100))
    assert check.update(100 * STEP, tuple(angles), tuple(torques), words(100))


def test_two_wheels_two_late_words_or_a_jump_of_the_clock_contradict_nobody():
    angles, torques = turning(100)
    two = (angles[0] + 0.2, angles[1] + 0.2, *angles[2:])
    four = tuple(angle + 0.2 for angle in angles)
    assert not WordCheck(PERIOD).update(100 * STEP, two, torques, words(100))
    old = [word._replace(stamp=word.stamp - STEP * (i < 2)) for i, word in enumerate(words(100))]
    assert not WordCheck(PERIOD).update(100 * STEP, four, torques, old)
    assert not WordCheck(PERIOD).update(100 * STEP, four, torques, [None] * 4)
    jumped = WordCheck(PERIOD)
    jumped.update(60 * STEP, *turning(60), words(60))
    assert not jumped.update(100 * STEP, four, torques, words(100))
    for cycle in range(101, 101 + SETTLING + 1):
        answer = jumped.update(cycle * STEP, tuple(angle + 0.2 for angle in turning(cycle)[0]), torques, words(cycle))
    assert answer


def begun_late(error, torque):
    """Return what is wrong with wheels that turn on to an angle when watching begins, and are off by an error then."""
    monitor = ModuleMonitor(VEHICLE, WheelModuleParameters(), PERIOD, 0.2)
    found, torque = [], (torque,) * 4
    for cycle in range(400):
        angles = (0.3 + error,) * 4
        heard = (Heard(begun=True, age=STEP),) * 4
        found.append(monitor.update(cycle * STEP, Measured(angles, (10.0,) * 4, torque), heard).wheels)
        monitor.told(cycle * STEP, Twist(4.0, 0.0, 0.0), (0.3,) * 4, torque)
    return found


@pytest.mark.parametrize('torque', [0.0, 400.0])
def test_wheels_that_are_turned_when_watching_begins_are_sound(torque):
    assert all(wheel == WheelCondition() for wheels in begun_late(0.0, torque) for wheel in wheels)


def test_wheels_that_are_off_when_watching_begins_are_seen_within_a_stated_time():
    found = begun_late(0.2, 400.0)
    first = next(cycle for cycle, wheels in enumerate(found) if wheels[0].steer is not SteerFault.NONE)
    assert first <= SETTLING + 20
