"""The emergency stop: a latch, brake forces within what the turn leaves, and wheels that stop by themselves."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omni_vehicle_ros.control.emergency_stop import EmergencyBrake, EmergencyStop
from omni_vehicle_ros.control.icr_steering import IcrSteering
from omni_vehicle_ros.control.wheel_module import Setpoint, WheelModule
from omni_vehicle_ros.messages import Twist as TwistMessage
from omni_vehicle_ros.model.kinematics import Twist
from omni_vehicle_ros.parameters import SteeringParameters, VehicleParameters, WheelModuleParameters
from omni_vehicle_ros.scenarios import load_scenario
from omni_vehicle_ros.simulation import record

VEHICLE = VehicleParameters()
STEP = 5_000_000


@settings(deadline=None)
@given(st.lists(st.tuples(st.sampled_from([None, True, False]), st.booleans(), st.booleans()), max_size=30))
def test_only_false_then_rest_at_standstill_releases(script):
    stop, last, engaged = EmergencyStop(), False, False
    for said, standing, rest in script:
        if said is not None:
            stop.say(said)
            last, engaged = said, engaged or said
        engaged = engaged and (last or not (standing and rest))
        assert stop.update(standing=standing, rest_commanded=rest) == engaged


speeds = st.floats(0.5, 25.0)


@settings(deadline=None)
@given(speeds, st.floats(-0.6, 0.6), st.floats(1.0, 12.0))
def test_brake_and_turn_together_stay_within_what_is_asked_of_the_tyres(speed, rate, most):
    steering = SteeringParameters(emergency_deceleration=most, maximum_drive_force=1e5)
    forces = EmergencyBrake(VEHICLE, steering).forces(Twist(speed, 0.0, rate), (speed,) * 4)
    brake = -sum(forces) / VEHICLE.mass
    assert all(force <= 0.0 for force in forces)
    # Close to standstill the brake fades, so as not to turn a wheel round.
    assert brake <= max(math.sqrt(max(most**2 - (speed * rate) ** 2, 0.0)), 0.25 * most) + 1e-9
    if speed > 4.0:
        assert brake >= 0.25 * most * (1.0 - 1e-9)


def test_on_a_straight_road_each_axle_brakes_by_its_load():
    steering = SteeringParameters(emergency_deceleration=5.0)
    front_left, front_right, rear_left, rear_right = EmergencyBrake(VEHICLE, steering).forces(
        Twist(10.0, 0.0, 0.0), (10.0,) * 4
    )
    # Moments about the contact points: the height of the centre of gravity is roll_arm over the roll axis.
    height, base = VEHICLE.roll_arm + VEHICLE.front_roll_centre_height, VEHICLE.wheelbase
    front_load = VEHICLE.mass * (VEHICLE.gravity * VEHICLE.cg_to_rear_axle + 5.0 * height) / base
    rear_load = VEHICLE.mass * VEHICLE.gravity - front_load
    assert front_left == front_right
    assert rear_left == rear_right
    assert front_left / rear_left == pytest.approx(front_load / rear_load)
    assert front_left + front_right + rear_left + rear_right == pytest.approx(-5.0 * VEHICLE.mass)


def turn(friction, speed, *, controlled, body='yaw_plane'):
    """Return odometry and slips from the stop in a turn on."""
    settings = (
        f'speed={speed}', f'plant.friction=[{friction}, {friction}, {friction}, {friction}]',
        f'side_slip_control={str(controlled).lower()}', f'vehicle.body_model={body}', 'duration=8.0',
    )
    bag = record(load_scenario('manoeuvres/emergency_stop', settings))
    begin = np.searchsorted(bag['odom'].stamp, 4.0)
    return bag['odom'], bag['tyres/side_slip'].position, begin


@pytest.mark.parametrize(
    ('friction', 'speed', 'controlled', 'body'),
    [(0.9, 14.0, False, 'yaw_plane'), (0.9, 12.0, True, 'eight_dof'), (0.5, 9.0, False, 'eight_dof')],
)
def test_a_stop_in_a_turn_at_the_limit_of_grip_does_not_spin(friction, speed, controlled, body):
    odom, slip, begin = turn(friction, speed, controlled=controlled, body=body)
    before, speeds = slice(begin - 100, begin), np.hypot(odom.vx, odom.vy)
    moving = slice(begin, begin + int(np.argmax(speeds[begin:] < 1.0)))
    # The yaw rate only falls, the body does not swing out, and it comes to rest sooner than with half the brake.
    assert abs(odom.yaw_rate[moving]).max() <= abs(odom.yaw_rate[before]).max() * 1.01
    assert abs(np.arctan2(odom.vy, odom.vx)[moving]).max() < 0.2
    assert abs(slip[moving]).max() < 0.3
    assert speeds[-1] < 0.01
    stopped = odom.stamp[begin + int(np.argmax(speeds[begin:] < 0.05))] - 4.0
    assert stopped < speeds[begin] / 3.0 + 1.0


def law():
    return IcrSteering(VEHICLE, SteeringParameters(), 0.005)


def follow(law, now, seconds, speed, angles=(0.1,) * 4, wheels=0.0):
    for _ in range(round(seconds * 200)):
        law.speed(TwistMessage(0, speed), now)
        found = law.update(now, angles, (wheels,) * 4)
        now += STEP
    return found, now


def test_the_vehicle_goes_on_only_after_false_and_speed_0():
    law_, now = law(), 0
    law_.emergency_stop(True)
    found, now = follow(law_, now, 0.5, 3.0)
    assert found.wheel_speed == (0.0,) * 4
    assert 'emergency stop: say false, then command speed 0' in law_.status.message
    law_.emergency_stop(False)
    found, now = follow(law_, now, 0.5, 3.0)
    assert found.wheel_speed == (0.0,) * 4
    assert 'emergency stop: command speed 0' in law_.status.message
    _, now = follow(law_, now, 0.1, 0.0)
    assert 'emergency' not in law_.status.message
    found, _ = follow(law_, now, 1.0, 3.0)
    assert found.wheel_speed[0] > 1.0


def test_angles_hold_and_drive_is_off_while_it_rolls():
    law_ = law()
    _, now = follow(law_, 0, 1.0, 8.0, wheels=8.0 / 0.35)
    held = law_.update(now, (0.1,) * 4, (8.0 / 0.35,) * 4).steer_angle
    law_.emergency_stop(True)
    for sense in (1.0, -1.0):
        found, now = follow(law_, now + STEP, 0.1, 20.0, wheels=sense * 8.0 / 0.35)
        assert found.steer_angle == held
        assert all(sense * torque < -50.0 for torque in found.torque)


def test_a_stop_outlives_a_clock_that_jumps_back():
    law_ = law()
    law_.emergency_stop(True)
    _, now = follow(law_, 10**12, 0.1, 3.0)
    law_.emergency_stop(False)
    found, _ = follow(law_, 0, 0.5, 3.0)
    assert found.wheel_speed == (0.0,) * 4
    assert now > 10**12


@settings(deadline=None, max_examples=50)
@given(st.floats(-1500.0, 1500.0), st.floats(-60.0, 60.0), st.booleans())
def test_a_wheel_never_drives_in_an_emergency_whatever_steering_commands(torque, wheel_speed, ideal):
    module = WheelModule(WheelModuleParameters(ideal_actuators=ideal), 0.005, 0.5)
    module.emergency_stop(True)
    for k in range(200):
        module.command(Setpoint(k * STEP, 0.1, 30.0, torque))
        state = module.update(k * STEP, wheel_speed)
    if abs(wheel_speed) > 0.1:
        assert state.drive_torque * wheel_speed <= 0.0
        assert abs(state.drive_torque) >= min(100.0, 150.0 * abs(wheel_speed)) * 0.999


@pytest.mark.parametrize('timeout', [0.0, 0.1, 60.0])
@pytest.mark.parametrize('commanded', [True, False])
def test_a_wheel_stops_without_steering(timeout, commanded):
    """Whether ICR steering has died or was never there, and however long a module would trust it."""
    module = WheelModule(WheelModuleParameters(module_timeout=timeout), 0.005, 0.5)
    speed, inertia = 20.0, 0.25 * VEHICLE.mass * VEHICLE.wheel_radius**2
    if commanded:
        module.command(Setpoint(0, 0.2, 20.0, 300.0))
        module.update(0, speed)
    module.emergency_stop(True)
    for k in range(1, 2000):
        state = module.update(k * STEP, speed)
        speed += state.drive_torque / inertia * 0.005
        if k == 200:
            held = state.steer_angle
    assert abs(speed) < 0.05
    assert state.steer_angle == pytest.approx(held, abs=1e-6)
    assert (held > 0.1) == commanded
    module.emergency_stop(False)
    assert 'emergency' not in (module.update(2000 * STEP, speed), module.status.message)[1]
