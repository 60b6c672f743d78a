"""Checks of single wheels, joints and sensors: seen in the stated number of cycles, named by their kind, and lifted."""

import itertools
import math
from functools import partial

import pytest

from omni_vehicle_ros.control.actuator import SteerActuator
from omni_vehicle_ros.control.fault_tolerance.condition import DriveFault, SteerFault
from omni_vehicle_ros.control.fault_tolerance.debounce import Debounce
from omni_vehicle_ros.control.fault_tolerance.drive_check import LOCKED_AFTER, DriveCheck
from omni_vehicle_ros.control.fault_tolerance.joint_check import JointCheck, Joints
from omni_vehicle_ros.control.fault_tolerance.order_check import OrderCheck
from omni_vehicle_ros.control.fault_tolerance.sensors import FADE, Seen, Sensor, SensorMonitor
from omni_vehicle_ros.control.fault_tolerance.steering_check import (
    ANGLE_TOLERANCE,
    LIFTED_AFTER,
    SEEN_AFTER,
    SteeringCheck,
)
from omni_vehicle_ros.control.trim import Sensed, Trims
from omni_vehicle_ros.model.kinematics import Twist
from omni_vehicle_ros.parameters import VehicleParameters, WheelModuleParameters

PERIOD, STEP = 0.005, 5_000_000
VEHICLE = VehicleParameters(front_roll_steer=0.0, rear_roll_steer=0.0)


def sine(cycle):
    return 0.4 * math.sin(2.0 * math.pi * 0.5 * cycle * PERIOD)


def actuator(**values):
    """Return what an actuator makes of the sine, cycle by cycle."""
    steer = SteerActuator(WheelModuleParameters(**values))
    return [steer.update(cycle * STEP, sine(cycle), PERIOD)[0] for cycle in range(1000)]


def steering_kinds(measured, directions=None):
    check, found = SteeringCheck(), []
    for cycle, expected in enumerate(actuator()):
        direction = directions[cycle] if directions else None
        found.append(check.update(measured[cycle], expected, partial(lambda value: value, direction)))
    return found


def seen(kinds):
    return next((cycle for cycle, kind in enumerate(kinds) if kind.value), None)


def test_wrong_and_right_need_their_cycles_in_a_row():
    debounce = Debounce(3, 5)
    assert [debounce.update(wrong) for wrong in (True, True, False, True, True, True)] == [False] * 5 + [True]
    assert [debounce.update(False) for _ in range(5)] == [True] * 4 + [False]


def test_a_sound_actuator_is_no_fault_and_nor_is_one_that_acts_late():
    sound = actuator()
    assert seen(steering_kinds(sound)) is None
    assert seen(steering_kinds([0.0] * 4 + sound[:-4])) is None


def test_a_stuck_wheel_is_seen_five_cycles_after_it_is_off():
    sound = actuator()
    stuck = sound[:300] + [sound[299]] * 700
    low = [min(sound[max(i - 4, 0):i + 1]) - ANGLE_TOLERANCE for i in range(1000)]
    high = [max(sound[max(i - 4, 0):i + 1]) + ANGLE_TOLERANCE for i in range(1000)]
    first = next(i for i in range(1000) if not low[i] <= stuck[i] <= high[i])
    kinds = steering_kinds(stuck)
    assert seen(kinds) == first + SEEN_AFTER - 1
    assert SteerFault.STUCK in kinds and kinds[-1] is SteerFault.STUCK


def test_a_constant_offset_is_named_and_measured():
    check, sound = SteeringCheck(), actuator()
    for cycle, expected in enumerate(sound):
        check.update(expected + (0.1 if cycle >= 300 else 0.0), expected, lambda: None)
    assert check.fault is SteerFault.OFFSET
    assert check.offset == pytest.approx(0.1, abs=1e-9)


def test_a_wheel_that_goes_by_its_motion_swings_freely():
    sound = actuator()
    motion = [0.3 * math.cos(2.0 * math.pi * 0.8 * cycle * PERIOD) for cycle in range(1000)]
    assert steering_kinds(sound[:300] + motion[300:], motion)[-1] is SteerFault.FREE


def castoring(directions):
    """Return the angles of a wheel that trails 0.1 m behind its axis at 4 m/s, from the first direction on."""
    angle, angles = directions[0], []
    for direction in directions:
        angle += (direction - angle) * (1.0 - math.exp(-4.0 / 0.1 * PERIOD))
        angles.append(angle)
    return angles


def test_a_wheel_that_swings_back_to_where_it_was_right_is_not_stuck_there():
    """It comes back slowly, while its set-points go through it: it stands where they say, and does not follow."""
    told = [0.05 * min(cycle / 40, 1.0) - 0.13 * min(max(cycle - 200, 0) / 60, 1.0) for cycle in range(700)]
    told = [angle + 0.08 * min(max(cycle - 500, 0) / 100, 1.0) for cycle, angle in enumerate(told)]
    motion = [-0.08 * math.sin(math.pi * min(cycle / 560, 1.0)) for cycle in range(700)]
    check, found = SteeringCheck(), []
    for measured, expected, direction in zip(castoring(motion), told, motion, strict=True):
        found.append(check.update(measured, expected, partial(lambda value: value, direction + 0.02)))
    assert SteerFault.FREE in found
    assert SteerFault.STUCK not in found


@pytest.mark.parametrize(('way', 'kind'), [
    (lambda cycle: -0.02 * (1.0 - math.exp(-cycle / 5)), SteerFault.DRIFTING),
    (lambda cycle: 0.0, SteerFault.UNKNOWN),
    (lambda cycle: -0.1 * min(cycle / 7, 1.0), SteerFault.UNKNOWN),
])  # fmt: skip
def test_what_drifts_with_the_vehicle_is_told_at_once_from_what_stands_or_is_driven(way, kind):
    """At 0.02 rad, and told to turn on; the place of the wheel moves straight ahead."""
    check, found = SteeringCheck(), []
    for cycle in range(-20, 60):
        turned = max(cycle, 0)
        found.append(check.update(0.02 + way(turned), 0.02 + 0.001 * turned, lambda: 0.0))
    assert next(fault for fault in found if fault is not SteerFault.NONE) is kind


def test_a_wheel_turned_away_is_out_of_control():
    sound = actuator()
    wild = [0.4 * math.sin(14.5 * cycle * PERIOD) * math.sin(1.7 * cycle * PERIOD) for cycle in range(1000)]
    assert SteerFault.ERRATIC in steering_kinds(sound[:300] + wild[300:])


def test_what_follows_again_is_lifted_after_200_cycles():
    sound = actuator()
    stuck = [*sound[:300], *[sound[299]] * 100, *sound[400:]]
    kinds = steering_kinds(stuck)
    last = max(cycle for cycle, kind in enumerate(kinds) if kind.value)
    off = max(cycle for cycle in range(400) if abs(stuck[cycle] - sound[cycle]) > ANGLE_TOLERANCE)
    assert off + LIFTED_AFTER - 5 <= last < off + LIFTED_AFTER + 5


@pytest.mark.parametrize(('made', 'kind'), [
    (lambda told: 0.0, DriveFault.DEAD), (lambda told: 150.0, DriveFault.STUCK),
    (lambda told: -told, DriveFault.WRONG),
])  # fmt: skip
def test_a_drive_is_seen_after_five_cycles(made, kind):
    check, found = DriveCheck(), []
    for cycle in range(20):
        told = 300.0 + 2.0 * cycle
        found.append(check.update(made(told), told, 4.0, 4.0))
    assert seen(found) == SEEN_AFTER - 1
    assert set(found[SEEN_AFTER:]) == {kind}


def test_a_locked_wheel_is_seen_after_ten_cycles_unless_it_was_told_to_brake():
    check = DriveCheck()
    found = [check.update(0.0, 0.0, 0.0, 4.0) for _ in range(20)]
    assert seen(found) == LOCKED_AFTER - 1 and found[-1] is DriveFault.LOCKED
    braked = DriveCheck()
    assert seen([braked.update(-500.0, -500.0, 0.0, 4.0) for _ in range(20)]) is None
    slow = DriveCheck()
    assert seen([slow.update(0.0, 0.0, 0.0, 0.3) for _ in range(20)]) is None


def rolling(cycle):
    return Joints((sine(cycle),) * 4, (10.0 * cycle * PERIOD,) * 4, (10.0,) * 4)


@pytest.mark.parametrize('lie', [
    lambda cycle: rolling(100),
    lambda cycle: None,
    lambda cycle: Joints((sine(cycle),) * 4, (float(cycle % 7),) * 4, (10.0,) * 4),
    lambda cycle: rolling(cycle)._replace(steer_angle=(0.3 * (-1) ** cycle,) * 4),
])
def test_joint_states_that_are_of_no_moving_vehicle(lie):
    check = JointCheck(3.0)
    found = [check.update(cycle * STEP, rolling(cycle)) for cycle in range(100)]
    assert not any(found)
    found = [check.update(cycle * STEP, lie(cycle)) for cycle in range(100, 130)]
    assert found.index(True) <= SEEN_AFTER
    found = [check.update(cycle * STEP, rolling(cycle)) for cycle in range(130, 130 + LIFTED_AFTER + 2)]
    assert found[LIFTED_AFTER - 2] and not found[-1]


TURNING = Twist(4.0, -0.1, 0.5)


def sensors(cycle, **lies):
    """Return what consistent sensors say of a steady turn, and what some of them say instead."""
    angles = (0.12, 0.1, 0.0, 0.0)
    ahead = [TURNING.vx - y * TURNING.r for y in VEHICLE.wheel_y]
    left = [TURNING.vy + x * TURNING.r for x in VEHICLE.wheel_x]
    speeds = tuple(a * math.cos(d) + b * math.sin(d) for a, b, d in zip(ahead, left, angles, strict=True))
    slips = tuple(d - math.atan2(b, a) for a, b, d in zip(ahead, left, angles, strict=True))
    truth = Sensed(slips, speeds, angles, (0.0,) * 4, TURNING, TURNING.vx * TURNING.r, TURNING)
    place, yaw_rate = (4.0 * cycle * PERIOD, 0.0), TURNING.r
    fields = {'yaw_rate': yaw_rate, 'place': place} | {k: v for k, v in lies.items() if k in ('yaw_rate', 'place')}
    return Seen(truth._replace(**{k: v for k, v in lies.items() if k not in fields}), rolling=speeds, **fields)


def test_consistent_sensors_are_believed():
    monitor = SensorMonitor(VEHICLE)
    for cycle in range(50):
        seen_now = sensors(cycle)
        assert monitor.update(seen_now, ()) == seen_now.sensed
    assert monitor.faulty == () and monitor.notes == []


@pytest.mark.parametrize(('lie', 'liar'), [
    ({'yaw_rate': 1.2}, Sensor.IMU), ({'lateral_acceleration': 20.0}, Sensor.IMU),
    ({'twist': Twist(4.0, -0.1, -0.4)}, Sensor.ODOM), ({'twist': Twist(6.0, -0.15, 0.5)}, Sensor.ODOM),
    ({'place': (0.0, 0.0)}, Sensor.ODOM),
    ({'side_slip': (0.2,) * 4}, Sensor.SIDE_SLIP), ({'side_slip': (math.nan,) * 4}, Sensor.SIDE_SLIP),
])  # fmt: skip
def test_the_one_that_lies_is_named_and_another_stands_in(lie, liar):
    monitor = SensorMonitor(VEHICLE)
    for cycle in range(SEEN_AFTER + 1):
        assert monitor.faulty == ()
        believed = monitor.update(sensors(cycle, **lie), ())
        if monitor.faulty:
            break
    assert monitor.faulty == (liar,)
    truth = sensors(0).sensed
    assert believed.side_slip == pytest.approx(truth.side_slip, abs=1e-9)
    assert believed.twist == pytest.approx(truth.twist, abs=0.02)
    assert believed.lateral_acceleration == pytest.approx(truth.lateral_acceleration)


@pytest.mark.parametrize('factor', [-3.0, 0.5, 1.2, 2.0])
def test_of_three_that_tell_the_speeds_of_the_wheels_joint_states_are_at_fault_if_the_others_agree(factor):
    monitor, true = SensorMonitor(VEHICLE), sensors(0)
    others = [
        true,
        sensors(0, twist=Twist(*(factor * number for number in TURNING))),
        sensors(0, wheel_speed=tuple(factor * speed for speed in true.rolling)),
        sensors(0, wheel_speed=(math.nan,) * 4),
    ]
    assert not any(monitor.contradicts_joints(seen) for seen in others)
    assert monitor.contradicts_joints(true._replace(rolling=tuple(factor * speed for speed in true.rolling)))
    spinning = tuple(3.0 * speed for speed in true.rolling)
    assert not monitor.contradicts_joints(sensors(0, wheel_speed=spinning)._replace(rolling=spinning))


def test_with_two_faulty_sensors_the_trims_fade_without_a_step_and_come_back():
    monitor, trims = SensorMonitor(VEHICLE), Trims((0.2,) * 4, (100.0,) * 4)
    given = []
    for cycle in range(450):
        lies = {'yaw_rate': 1.5, 'side_slip': (0.3,) * 4} if 50 <= cycle < 150 else {}
        monitor.update(sensors(cycle, **lies), ())
        given.append(monitor.fade(trims, PERIOD).steer_angle[0])
    steps = [abs(b - a) for a, b in itertools.pairwise(given)]
    assert max(steps) <= 0.2 * PERIOD / FADE + 1e-12
    assert given[49] == 0.2 and given[149] == 0.0 and given[-1] == pytest.approx(0.2)


def test_messages_that_come_twice_late_or_out_of_order_are_named():
    order = OrderCheck('front_left/command', STEP)
    assert [order.take(stamp * STEP, stamp * STEP) for stamp in (1, 2, 3)] == [True] * 3
    assert order.wrong() == ''
    assert order.take(3 * STEP, 3 * STEP) and order.wrong() == 'front_left/command comes twice'
    assert not order.take(2 * STEP, 3 * STEP) and 'out of order' in order.wrong()
    assert order.take(4 * STEP, 8 * STEP) and order.wrong() == ''
    assert order.take(5 * STEP, 10 * STEP) and 'late' in order.wrong()
    assert order.take(1000 * STEP, 1000 * STEP) and order.take(5 * STEP, 5 * STEP) and order.wrong() == ''
    assert order.take(0, 6 * STEP) and order.take(0, 7 * STEP) and order.wrong() == ''


@pytest.mark.parametrize('back', [150, *range(196, 200)])
def test_after_a_clock_that_went_back_by_little_messages_are_in_order_again(back):
    order = OrderCheck('front_left/command', STEP)
    assert order.take(200 * STEP, 200 * STEP)
    for cycle in range(back, back + 10):
        assert order.take(cycle * STEP, cycle * STEP)
        assert order.wrong() == ''
