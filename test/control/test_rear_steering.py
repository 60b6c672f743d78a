"""Active rear steering: Abe's law at small angles, and zero body slip in closed loop."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omni_vehicle_ros.control.rear_steering import RearSteeringController
from omni_vehicle_ros.control.trim import Sensed
from omni_vehicle_ros.model.kinematics import Twist
from omni_vehicle_ros.parameters import SideSlipParameters, VehicleParameters

VEHICLE = VehicleParameters()
FRONT, REAR, MASS = VEHICLE.cg_to_front_axle, VEHICLE.cg_to_rear_axle, VEHICLE.mass
REAR_STEERING = SideSlipParameters(controller='rear_steering')


def trims(sensed, vehicle=VEHICLE):
    return RearSteeringController(REAR_STEERING, vehicle).update(0, sensed)


@settings(deadline=None)
@given(st.floats(2.0, 30.0), st.floats(-1.0, 1.0), st.floats(-1.0, 1.0), st.floats(20000.0, 60000.0))
def test_small_angles_give_the_law_of_abe(speed, front, yaw, stiffness):
    # delta_r = -(Kf / Kr) delta_f + (m v / (2 Kr) + (lf Kf - lr Kr) / (Kr v)) r: thesis eq. 2.11, beta = 0.
    scale = 1e-5
    front, yaw = scale * front, scale * yaw
    vehicle = VehicleParameters(cornering_stiffness=stiffness)
    twist, commanded = Twist(speed, 0.0, yaw), Twist(speed, 0.0, 0.0)
    sensed = Sensed(steer_angle=(front, front, 0.0, 0.0), twist=twist, commanded=commanded)
    law = -front + (MASS * speed / (2.0 * stiffness) + (FRONT - REAR) / speed) * yaw
    found = trims(sensed, vehicle)
    assert found.torque == (0.0,) * 4
    assert found.steer_angle[:2] == (0.0, 0.0)
    # Both rear wheels; what is left is of the second order, by turned wheels and their tracks.
    assert found.steer_angle[2:] == pytest.approx((law, law), abs=1e-8)


@pytest.mark.parametrize('radius, speed', [(20.0, 5.0), (20.0, 8.0), (-40.0, 10.0)])
def test_the_driven_vehicle_has_no_body_slip(closed_loop, radius, speed):
    drift = {}
    for name, slip in (('with', REAR_STEERING), ('without', None)):
        loop = closed_loop(slip=slip, speed=speed)
        for _ in loop.run(5.0, lambda loop=loop: loop.drive(speed, (0.0, radius))):
            pass
        drift[name] = math.atan2(loop.state.vy, loop.state.vx)
    assert abs(drift['with']) < 0.002
    assert abs(drift['without']) > 5.0 * abs(drift['with'])


def test_its_steady_turn_is_that_of_the_linear_theory(closed_loop):
    # Yaw moment balance with beta = 0: r = v delta_f / (lf + lr m v^2 / (2 C l)) (thesis eq. 2.11).
    speed, radius = 8.0, 100.0
    loop = closed_loop(slip=REAR_STEERING, speed=speed)
    for _ in loop.run(5.0, lambda: loop.drive(speed, (0.0, radius))):
        pass
    length, axle = FRONT + REAR, 2.0 * VEHICLE.cornering_stiffness
    # Roll steer turns the front wheels outward by 0.2 of the roll angle.
    roll = 0.2 * VEHICLE.sprung_mass * VEHICLE.roll_arm * loop.seen.ay
    stiffness = VEHICLE.roll_stiffness - VEHICLE.sprung_mass * VEHICLE.gravity * VEHICLE.roll_arm
    angle = 0.5 * sum(loop.angles[:2]) - roll / stiffness
    expected = speed * angle / (FRONT + REAR * MASS * speed**2 / (axle * length))
    assert loop.state.r == pytest.approx(expected, rel=0.01)


def test_a_crab_has_no_drift_from_its_own_direction():
    bearing = 0.4
    commanded = Twist(5.0 * math.cos(bearing), 5.0 * math.sin(bearing), 0.0)
    still = trims(Sensed(steer_angle=(bearing,) * 4, twist=commanded, commanded=commanded))
    assert still.steer_angle == pytest.approx((0.0,) * 4, abs=1e-12)
    turning = trims(Sensed(steer_angle=(bearing,) * 4, twist=commanded._replace(r=0.01), commanded=commanded))
    assert abs(turning.steer_angle[2]) > 1e-4


@pytest.mark.parametrize('commanded', [Twist(-5.0, 0.0, 0.5), Twist(0.0, 5.0, 0.5)])
def test_it_leaves_reverse_and_a_crab_sideways_alone(commanded):
    found = trims(Sensed(steer_angle=(0.1,) * 4, twist=commanded, commanded=commanded))
    assert found.steer_angle == pytest.approx((0.0,) * 4, abs=1e-12)
