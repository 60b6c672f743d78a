"""Allocation: as little slip as the path allows, on the path, up to the grip limit and with grace past it."""

import math

import numpy as np
import pytest
from scipy.optimize import minimize

from omni_vehicle_ros.control.allocation import AllocationController
from omni_vehicle_ros.control.grip import Grip
from omni_vehicle_ros.control.health import WARN
from omni_vehicle_ros.control.trim import Sensed
from omni_vehicle_ros.model.body import Environment, Inputs, derivative, evaluate
from omni_vehicle_ros.model.constants import constants
from omni_vehicle_ros.model.kinematics import Icr, Twist, road_steer_angles
from omni_vehicle_ros.model.state import State, state_vector
from omni_vehicle_ros.parameters import SideSlipParameters, VehicleParameters, WheelModuleParameters

VEHICLE = VehicleParameters()
MODEL = constants(VEHICLE)
SPEED, RADIUS = 15.0 / 3.6, 5.0
STEERING = SideSlipParameters(controller='allocation', allocation_traction=False)
TRACTION = SideSlipParameters(controller='allocation')
BOTH = pytest.mark.parametrize('slip', [STEERING, TRACTION], ids=['steering alone', 'with traction'])


def least_worst_slip(speed, radius, traction):
    """Least worst slip of a steady turn, over four angles and one drive force, or four without a side force."""
    state = state_vector(State(speed, 0.0, speed / radius, *[0.0] * 7))
    kinematic = np.array(road_steer_angles(Icr(0.0, radius), VEHICLE))

    def inputs(unknown):
        forces = 1e3 * unknown[4:8] if traction else np.full(4, 1e3 * unknown[4])
        return Inputs(tuple((kinematic + unknown[:4]).tolist()), tuple(forces.tolist()))

    def balance(unknown):
        set_to = inputs(unknown)
        rates = derivative(state, set_to, Environment(), MODEL)[:3]
        across = 1e-3 * np.dot(set_to.drive_force, np.sin(set_to.steer_angle))
        return np.append(rates, across) if traction else rates

    def room(unknown):
        slip = np.array(evaluate(state, inputs(unknown), Environment(), MODEL).side_slip)
        return np.concatenate((unknown[-1] - slip, unknown[-1] + slip))

    start = np.array([0.04] * 4 + [0.05] * (4 if traction else 1) + [0.05])
    found = minimize(
        lambda unknown: unknown[-1], start, method='SLSQP', options={'ftol': 1e-13, 'maxiter': 500},
        constraints=({'type': 'eq', 'fun': balance}, {'type': 'ineq', 'fun': room}),
    )  # fmt: skip
    assert found.success
    return found.x[-1]


def turn(closed_loop, slip, speed=SPEED, duration=5.0, radius=RADIUS, **options):
    """Turn with real actuators and the speed controller; return the loop and the slips of the last second."""
    loop = closed_loop(slip=slip, speed=speed, **options)
    slips = [loop.seen.side_slip for _ in loop.run(duration, lambda: loop.drive(speed, (0.0, radius)))]
    return loop, np.array(slips[-200:])


def path_radius(loop):
    return math.hypot(loop.state.vx, loop.state.vy) / loop.state.r


@BOTH
def test_the_worst_slip_is_within_5_percent_of_the_bound_on_the_commanded_path(closed_loop, slip):
    loop, slips = turn(closed_loop, slip)
    speed = math.hypot(loop.state.vx, loop.state.vy)
    assert speed == pytest.approx(SPEED, rel=0.002)
    bound = least_worst_slip(speed, RADIUS, slip.allocation_traction)
    assert 0.999 * bound <= slips.max() <= 1.05 * bound
    assert path_radius(loop) == pytest.approx(RADIUS, rel=0.001)
    # What still moves is the speed, by less than half a percent of the slips in a second.
    assert np.ptp(slips, axis=0).max() < 0.005 * slips.max()
    uncontrolled, before = turn(closed_loop, None)
    assert slips.max() < 0.9 * before.max()
    assert path_radius(uncontrolled) > 1.04 * RADIUS


def test_all_slips_of_an_axle_are_equal_and_with_traction_all_four(closed_loop):
    _, slips = turn(closed_loop, STEERING)
    fl, fr, rl, rr = slips[-1]
    assert (fl, rl) == pytest.approx((fr, rr), rel=1e-3)
    assert fl > 1.3 * rl
    _, slips = turn(closed_loop, TRACTION)
    assert slips[-1] == pytest.approx(slips[-1].mean(), rel=2e-3)


def test_it_settles_without_overshoot(closed_loop):
    loop = closed_loop(slip=TRACTION, speed=SPEED)
    yaw, drift = [], []
    for state in loop.run(3.0, lambda: loop.drive(SPEED, (0.0, RADIUS))):
        yaw.append(state.r)
        drift.append(state.vy / state.vx)
    # The direction of the command takes half a second for the turn.
    assert max(yaw) < 1.01 * yaw[-1]
    assert max(map(abs, drift)) < 0.005
    assert np.all(abs(np.array(yaw[200:]) / yaw[-1] - 1.0) < 0.02)


@BOTH
def test_left_and_right_are_mirror_images(closed_loop, slip):
    left, slips = turn(closed_loop, slip, duration=2.0)
    right, mirrored = turn(closed_loop, slip, duration=2.0, radius=-RADIUS)
    fl, fr, rl, rr = slips[-1]
    assert mirrored[-1] == pytest.approx((-fr, -fl, -rr, -rl), abs=1e-7)
    assert right.state.r == pytest.approx(-left.state.r, abs=1e-7)


@BOTH
@pytest.mark.parametrize('speed', [5.0, 5.75])
def test_up_to_the_grip_limit_it_keeps_the_path_and_is_stable(closed_loop, slip, speed):
    # Without control the vehicle spins from a command of 5.8 m/s on.
    loop, slips = turn(closed_loop, slip, speed, 12.0)
    assert path_radius(loop) == pytest.approx(RADIUS, rel=0.005)
    # The speed has not quite settled yet: a slow drift, no oscillation.
    assert np.ptp(slips, axis=0).max() < math.radians(0.5)
    assert np.all(np.diff(slips, axis=0) > -1e-5)


@pytest.mark.parametrize('slip, speed', [(STEERING, 7.0), (TRACTION, 6.2), (TRACTION, 9.0)])
def test_past_the_grip_limit_it_runs_wide_and_comes_back(closed_loop, slip, speed):
    loop = closed_loop(slip=slip, speed=speed)
    for state in loop.run(6.0, lambda: loop.drive(speed, (0.0, RADIUS))):
        assert abs(state.vy) < 0.1 * state.vx
    assert path_radius(loop) > 1.05 * RADIUS
    assert loop.slip.status.level == WARN
    assert 'running wide' in loop.slip.status.message
    # The axle that leads lets go first.
    assert min(loop.seen.side_slip[:2]) > max(loop.seen.side_slip[2:])
    assert max(loop.seen.side_slip) < math.radians(16.0)
    for _ in loop.run(5.0, lambda: loop.drive(SPEED, (0.0, RADIUS))):
        pass
    assert path_radius(loop) == pytest.approx(RADIUS, rel=0.005)
    assert max(loop.seen.side_slip) < math.radians(3.0)


@pytest.mark.parametrize('radius, speed', [(2.0, 3.5), (1.5, 2.75)])
def test_in_a_small_turn_it_keeps_the_path_as_far_as_steering_can(closed_loop, radius, speed):
    # v^2 / R is 0.6 g: the wheels stand at up to 60 deg, so that their forces do not all point to the centre.
    loop, slips = turn(closed_loop, TRACTION, speed, 10.0, radius=radius)
    assert path_radius(loop) == pytest.approx(radius, rel=0.005)
    assert np.ptp(slips, axis=0).max() < math.radians(0.6)


@pytest.mark.parametrize('radius, speed, drift', [(1.0, 2.5, 0.4), (2.0, 3.8, 0.1), (2.5, 4.3, 0.1), (-3.0, 5.0, 0.1)])
def test_past_the_limit_of_a_small_turn_it_runs_wide_and_does_not_spin(closed_loop, radius, speed, drift):
    loop, slips = closed_loop(slip=TRACTION, speed=speed), []
    for state in loop.run(10.0, lambda: loop.drive(speed, (0.0, radius))):
        assert abs(state.vy) < drift * state.vx
        slips.append(loop.seen.side_slip)
    assert path_radius(loop) / radius > 1.02
    # Down to 2 m, where the limits of both axles come together, nothing sways.
    if abs(radius) > 2.0:
        assert np.ptp(slips[-200:], axis=0).max() < math.radians(1.5)


@BOTH
@pytest.mark.parametrize(
    'options',
    [
        {'friction': 0.5},
        {'plant': VehicleParameters(mass=1.2 * 1298.9, sprung_mass=1.2 * 1167.5)},
        {'module': WheelModuleParameters(steer_delay=0.010)},
        {'module': WheelModuleParameters(ideal_actuators=True)},
        {'bank': 0.05},
    ],
    ids=['slippery', 'heavy', 'delayed', 'ideal actuators', 'banked'],
)
def test_what_it_does_not_know_neither_takes_it_off_the_path_nor_upsets_it(closed_loop, slip, options):
    loop, slips = turn(closed_loop, slip, duration=6.0, **options)
    assert path_radius(loop) == pytest.approx(RADIUS, rel=0.005)
    assert np.ptp(slips, axis=0).max() < math.radians(0.05)
    assert slips[-1][0] == pytest.approx(slips[-1][1], rel=0.01)
    assert slips.max() < math.radians(4.0)


@BOTH
def test_a_road_on_which_no_such_turn_is_possible_does_not_make_it_spin(closed_loop, slip):
    # Friction 0.4 where 0.9 is estimated: m v^2 / R needs 0.35 of the weight, and more than the tyres give.
    loop = closed_loop(slip=slip, speed=SPEED, friction=0.4)
    slips = []
    for state in loop.run(12.0, lambda: loop.drive(SPEED, (0.0, RADIUS))):
        assert abs(state.vy) < 0.05 * state.vx
        slips.append(loop.seen.side_slip)
    assert np.ptp(slips[-200:], axis=0).max() < math.radians(3.0)


def test_traction_makes_no_net_force_and_steering_alone_none_at_all(closed_loop):
    loop, _ = turn(closed_loop, TRACTION, duration=3.0)
    along = sum(t * math.cos(angle) for t, angle in zip(loop.trims.torque, loop.angles, strict=True))
    assert along == pytest.approx(0.0, abs=1e-3)
    assert loop.trims.torque[1] > 100.0 > -100.0 > loop.trims.torque[0]
    loop, _ = turn(closed_loop, STEERING, duration=3.0)
    assert loop.trims.torque == (0.0,) * 4


@BOTH
def test_crab_stop_spin_and_reverse(closed_loop, slip):
    loop = closed_loop(slip=slip, speed=2.0)

    def drive(duration, *twist):
        for state in loop.run(duration - 0.5, lambda: loop.twist(*twist)):
            assert all(map(math.isfinite, state))
        angles = np.array([loop.angles for _ in loop.run(0.5, lambda: loop.twist(*twist))])
        assert np.ptp(angles, axis=0).max() < 1e-3
        return loop.state

    crab = drive(4.0, 2.0, 1.0, 0.0)
    assert (crab.vx, crab.vy, crab.r) == pytest.approx((2.0, 1.0, 0.0), abs=0.02)
    turning = drive(4.0, 2.0, 1.0, 0.4)
    assert (turning.vx, turning.vy, turning.r) == pytest.approx((2.0, 1.0, 0.4), abs=0.02)
    stopped = drive(4.0, 0.0, 0.0, 0.0)
    assert stopped[:3] == pytest.approx((0.0,) * 3, abs=1e-3)
    assert (loop.trims.steer_angle, loop.trims.torque) == ((0.0,) * 4, (0.0,) * 4)
    spin = drive(4.0, 0.0, 0.0, 0.5)
    assert spin[:3] == pytest.approx((0.0, 0.0, 0.5), abs=0.02)
    drive(3.0, 0.0, 0.0, 0.0)
    reverse = drive(4.0, -3.0, 0.0, 0.5)
    assert (reverse.vx, reverse.vy, reverse.r) == pytest.approx((-3.0, 0.0, 0.5), abs=0.02)
    away = drive(5.0, 3.0, 0.0, 0.5)
    assert (away.vx, away.vy, away.r) == pytest.approx((3.0, 0.0, 0.5), abs=0.03)


def test_feed_forward_alone_is_near(closed_loop):
    open_loop = SideSlipParameters(controller='allocation', allocation_gain=0.0, allocation_integral_gain=0.0)
    loop, slips = turn(closed_loop, open_loop)
    assert path_radius(loop) == pytest.approx(RADIUS, rel=0.005)
    assert np.ptp(slips[-1]) < math.radians(0.1)


def test_a_step_of_the_command_asks_for_no_more_than_the_limits():
    law = AllocationController(TRACTION, VEHICLE)
    rolling = Sensed(wheel_speed=(6.0,) * 4, twist=Twist(6.0, 0.0, 0.0), commanded=Twist(6.0, 0.0, 0.0))
    law.update(0, rolling)
    trims = law.update(5_000_000, rolling._replace(commanded=Twist(6.0, 0.0, 1.2)))
    # The wheels turn, and the axle no farther ahead of the motion that there is than by 5/4 of the slip limit.
    told = [math.atan2(1.2, 6.0 - side * 0.718 * 1.2) for side in (1.0, -1.0)]
    turned = [told[i] + trims.steer_angle[i] for i in range(2)]
    assert min(turned) > 0.25
    assert np.mean(turned) == pytest.approx(1.25 * Grip(VEHICLE, 0.9).slip_limit(6.0), abs=1e-9)
    assert max(map(abs, trims.torque)) < 1050.0
    # A step into a crab asks for a push to the side, at once and for one cycle only.
    law.update(10_000_000, rolling)
    aside = rolling._replace(commanded=Twist(6.0, 1.0, 0.0))
    pushed, after = (law.update(stamp, aside).steer_angle for stamp in (15_000_000, 20_000_000))
    assert min(pushed) > 0.01
    assert max(pushed) < 0.25
    assert max(after) < 0.2


def test_the_least_sum_of_squares_of_all_forces_takes_a_quarter_of_the_levelling_moment():
    # Why the worst slip is minimised: linear tyres, straight wheels, one lateral force F, a moment Mz.
    front, rear = VEHICLE.cg_to_front_axle, VEHICLE.cg_to_rear_axle
    length, track, force = front + rear, VEHICLE.front_track, 1298.9

    def squares(moment):
        axles = np.array([force * rear - moment, force * front + moment]) / length
        return np.sum(axles**2) / 2.0 + 4.0 * (moment / (2.0 * track)) ** 2

    level = 0.5 * (rear - front) * force
    least = minimize(lambda m: squares(m[0] * level) / force**2, [0.0], tol=1e-12).x[0]
    assert least == pytest.approx(track**2 / (track**2 + length**2), rel=1e-4)
    # By use of friction, with loads as they stand, both axles are level without any moment.
    loads = np.array([rear, front]) / length
    assert force * rear / length / loads[0] == pytest.approx(force * front / length / loads[1])


def test_a_road_that_gives_less_than_the_estimate_is_told(closed_loop):
    loop = closed_loop(slip=STEERING, speed=SPEED, friction=0.3)
    for _ in loop.run(4.0, lambda: loop.drive(SPEED, (0.0, RADIUS))):
        pass
    assert 'friction_estimate 0.9' in loop.slip.status.message
