"""What users of swerve and steering controllers complain about in public threads, and must not happen here.

Each test names the thread that it comes from.
"""

import math

import pytest

from omni_vehicle_ros.control.icr_steering import IcrSteering
from omni_vehicle_ros.messages import Point, Twist
from omni_vehicle_ros.parameters import SteeringParameters, VehicleParameters

VEHICLE = VehicleParameters()
PERIOD, STEP, SECOND = 0.005, 5_000_000, 1_000_000_000
ZERO = (0.0,) * 4
TURNING = (0.3, 0.25, -0.4, -0.3)


def steering(**limits):
    return IcrSteering(VEHICLE, SteeringParameters(**limits), PERIOD)


def cycles(law, seconds, command=None, now=0, angles=None, speeds=None):
    """Run with wheels that follow at once, unless told what is measured; return the set-points and the time."""
    measured, spin = angles or ZERO, speeds or ZERO
    for _ in range(round(seconds / PERIOD)):
        if command is not None:
            command(now)
        found = law.update(now, angles or measured, speeds or spin)
        measured, spin, now = found.steer_angle, found.wheel_speed, now + STEP
    return found, now


def drive(law, speed, icr=None):
    def command(now):
        if icr is not None:
            law.icr(Point(now, *icr), now)
        law.speed(Twist(now, speed), now)
    return command


def test_timeout_holds_the_steer_angles_and_ramps_the_speed_down():  # ros2_controllers PR 1289, 1694
    law = steering()
    before, now = cycles(law, 4.0, drive(law, 2.0, (0.0, 5.0)))
    after, _ = cycles(law, 0.75, now=now, angles=before.steer_angle, speeds=before.wheel_speed)
    assert after.steer_angle == before.steer_angle
    # Stale after 0.5 s, then 2 m/s2 for a quarter of a second; the last command came a period before.
    share = (2.0 - 2.0 * (0.25 + PERIOD)) / 2.0
    assert after.wheel_speed == pytest.approx([share * speed for speed in before.wheel_speed], rel=0.02)
    rest, _ = cycles(law, 3.0, now=now + round(0.75 * SECOND), angles=before.steer_angle, speeds=before.wheel_speed)
    assert rest.steer_angle == before.steer_angle
    assert rest.wheel_speed == ZERO


def test_fresh_commands_resume_after_a_timeout():  # ros2_controllers 1683
    law = steering()
    _, now = cycles(law, 4.0, drive(law, 2.0, (0.0, 5.0)))
    _, now = cycles(law, 5.0, now=now)
    found, _ = cycles(law, 4.0, drive(law, 2.0, (0.0, 5.0)), now)
    assert law.status.level == 0
    assert all(speed > 0.0 for speed in found.wheel_speed)


def test_timeout_of_zero_is_off():  # ros2_controllers PR 2503
    law = steering(command_timeout=0.0)
    before, now = cycles(law, 4.0, drive(law, 2.0))
    after, _ = cycles(law, 100.0 * PERIOD, now=now + 3600 * SECOND, speeds=before.wheel_speed)
    assert after.wheel_speed == pytest.approx(before.wheel_speed)


def test_zero_stamp_means_now():  # ros2_control_demos PR 828
    law = steering()
    found, _ = cycles(law, 4.0, lambda now: law.speed(Twist(0, 2.0), now), now=500 * SECOND)
    assert found.wheel_speed == pytest.approx((2.0 / 0.35,) * 4)
    assert law.status.level == 0


def test_wall_time_against_simulated_time_works_and_is_said_in_one_message():  # ros2_control_demos PR 828
    law, messages = steering(), set()

    def command(now):
        law.speed(Twist(1_700_000_000 * SECOND + now, 2.0), now)
        messages.add(law.status.message)

    found, now = cycles(law, 4.0, command)
    assert found.wheel_speed == pytest.approx((2.0 / 0.35,) * 4)
    assert 'use_sim_time' in law.status.message
    assert len(messages) <= 2
    cycles(law, 1.0, now=now)
    assert 'command_timeout' in law.status.message


def test_never_received_is_its_own_state():  # ros2_controllers 1774
    law = steering()
    found, _ = cycles(law, 5.0, angles=TURNING, speeds=(3.0,) * 4)
    assert found == (TURNING, ZERO, ZERO, (0.0,) * 3)
    assert law.status.level == 0
    assert ('state', 'never') in law.status.values


def test_past_the_limit_a_wheel_turns_by_180_degrees_less_and_reverses():  # ros_controllers PR 441
    law = steering(motion_rate_limit=0.0)
    # The ICR left of the vehicle but inside the track: the left wheels roll backwards.
    found, _ = cycles(law, 3.0, drive(law, 0.5, (0.0, 0.4)))
    assert max(map(abs, found.steer_angle)) <= 1.75
    assert [speed > 0.0 for speed in found.wheel_speed] == [False, True, False, True]


def test_flipping_has_a_hysteresis():  # allwpilib PR 2248
    # A crab that trembles about 90 deg: wheels stay on their side of it.
    law, angles = steering(motion_rate_limit=0.0), []
    measured = ZERO
    for k in range(400):
        law.cmd_vel(Twist(0, 0.02 * math.sin(k) + (0.1 if k < 10 else 0.0), 1.0), k * STEP)
        measured = law.update(k * STEP, measured, ZERO).steer_angle
        angles.append(measured[0])
    assert max(angles) - min(angles) < 0.2


@pytest.mark.parametrize('noise', [0.0, 1e-12, 1e-6])
def test_zero_speed_does_not_swing_the_wheels(noise):  # allwpilib 4204, 5167
    law = steering()
    turning, now = cycles(law, 4.0, lambda now: law.cmd_vel(Twist(now, 1.0, 0.2, 0.2), now))
    standing, _ = cycles(law, 4.0, lambda now: law.cmd_vel(Twist(now, 0.0, -noise, noise), now), now,
                         turning.steer_angle, turning.wheel_speed)
    assert standing.steer_angle == turning.steer_angle
    assert standing.wheel_speed == ZERO


def test_zero_speed_at_the_start_holds_the_measured_angles():  # allwpilib 5167
    law = steering()
    for say in (law.cmd_vel, law.speed):
        say(Twist(0, 0.0), 0)
        found = law.update(STEP, TURNING, ZERO)
        assert found.steer_angle == TURNING
        assert found.torque == pytest.approx(ZERO)


def test_angles_and_speeds_stay_finite_near_the_icr():  # zinger_swerve_controller 1, osr-rover-code 134
    x, y = VEHICLE.wheel_x[0], VEHICLE.wheel_y[0]
    for offset in (0.0, 1e-300, 1e-12, 1e-6, -1e-9):
        law = steering(motion_rate_limit=0.0)
        found, _ = cycles(law, 2.0, drive(law, 1.0, (x + offset, y)))
        assert all(math.isfinite(value) for values in found for value in values)
        assert abs(found.wheel_speed[0]) < 1e-5
        assert found.wheel_speed[3] > 1.0


def test_an_icr_exactly_under_a_wheel_leaves_it_its_angle():  # osr-rover-code 134
    law = steering(motion_rate_limit=0.0)
    straight, now = cycles(law, 1.0, drive(law, 1.0))
    found, _ = cycles(law, 1.0, drive(law, 1.0, (VEHICLE.wheel_x[0], VEHICLE.wheel_y[0])), now)
    assert found.steer_angle[0] == straight.steer_angle[0]
    assert found.wheel_speed[0] == 0.0


def test_an_icr_in_the_centre_of_gravity_is_refused_with_the_remedy():  # osr-rover-code 134
    law = steering()
    law.icr(Point(0, 0.0, 0.0), 0)
    law.update(0, ZERO, ZERO)
    assert 'cmd_vel' in law.status.message


def test_the_vehicle_waits_until_its_wheels_point_right():  # allwpilib 5749, ros2_controllers PR 1314
    law = steering(motion_rate_limit=0.0)
    stuck, now = cycles(law, 2.0, lambda now: law.cmd_vel(Twist(now, 0.0, 1.0), now), angles=ZERO, speeds=ZERO)
    assert stuck.steer_angle == pytest.approx((math.pi / 2,) * 4)
    assert stuck.wheel_speed == pytest.approx(ZERO, abs=1e-9)
    halfway, now = cycles(law, 3.0, lambda now: law.cmd_vel(Twist(now, 0.0, 1.0), now), now, (1.0,) * 4)
    there, _ = cycles(law, 3.0, lambda now: law.cmd_vel(Twist(now, 0.0, 1.0), now), now, stuck.steer_angle)
    assert 0.5 / 0.35 < halfway.wheel_speed[0] < 0.9 / 0.35
    assert there.wheel_speed == pytest.approx((1.0 / 0.35,) * 4)


def test_without_slowdown_it_does_not_wait():
    law = steering(motion_rate_limit=0.0, alignment_slowdown=False)
    found, _ = cycles(law, 2.0, lambda now: law.cmd_vel(Twist(now, 0.0, 1.0), now), angles=ZERO, speeds=ZERO)
    assert found.wheel_speed == pytest.approx((1.0 / 0.35,) * 4)


@pytest.mark.parametrize('icr', [(0.0, 2.0), (-3.0, -1.0), (0.5, 0.3)])
def test_too_fast_for_a_wheel_slows_all_by_one_factor(icr):  # allwpilib 7332
    slow, fast = steering(acceleration_limit=0.0), steering(acceleration_limit=0.0, maximum_wheel_speed=3.0)
    for law in (slow, fast):
        law.found, _ = cycles(law, 8.0, drive(law, 9.0, icr))
    assert fast.found.steer_angle == pytest.approx(slow.found.steer_angle)
    assert max(map(abs, fast.found.wheel_speed)) * 0.35 == pytest.approx(3.0)
    ratios = [a / b for a, b in zip(fast.found.wheel_speed, slow.found.wheel_speed, strict=True)]
    assert ratios == pytest.approx([ratios[0]] * 4)
    assert 'maximum_wheel_speed, 3 m/s' in fast.status.message


def test_commands_at_20_hz_against_a_200_hz_loop():  # f1tenth_gym_ros PR 12
    law, levels = steering(), set()

    def command(now):
        if now % (10 * STEP) == 0:
            law.speed(Twist(now, 2.0), now)
        levels.add(law.status.level)

    found, _ = cycles(law, 4.0, command)
    assert found.wheel_speed == pytest.approx((2.0 / 0.35,) * 4)
    assert levels == {0}


def test_time_that_jumps_back_starts_anew_and_goes_on():  # rclpy 1490
    law = steering()
    _, now = cycles(law, 2.0, drive(law, 2.0), now=1000 * SECOND)
    found, now = cycles(law, 1.0, angles=TURNING)
    assert found == (TURNING, ZERO, ZERO, (0.0,) * 3)
    found, _ = cycles(law, 8.0, drive(law, 2.0), now)
    assert found.wheel_speed == pytest.approx((2.0 / 0.35,) * 4)


def test_stopping_neither_rolls_back_nor_creeps(closed_loop):
    loop = closed_loop()
    for _ in loop.run(1.5, lambda: loop.drive(2.0)):
        pass
    lowest = min(state.vx for state in loop.run(3.0, lambda: loop.drive(0.0)))
    assert lowest > -0.01
    assert abs(loop.state.vx) < 0.01


def test_a_wheel_module_that_hears_nothing_stops_the_vehicle_by_itself(closed_loop):  # ros2_controllers 95
    loop = closed_loop(speed=2.0)
    for _ in loop.run(0.2, lambda: loop.drive(2.0)):
        pass
    loop.commanded = False
    lowest = min(state.vx for state in loop.run(2.0))
    assert lowest > -1e-3
    assert abs(loop.state.vx) < 1e-2


def test_spin_in_place_stays_in_place(closed_loop):
    loop = closed_loop()
    for _ in loop.run(5.5, lambda: loop.twist(0.0, 0.0, 0.8)):
        pass
    assert loop.state.r == pytest.approx(0.8, rel=0.05)
    assert math.hypot(loop.state.vx, loop.state.vy) < 0.05
