"""Direct yaw moment control: its reference, its signs, and the friction circles."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omni_vehicle_ros.control.health import WARN
from omni_vehicle_ros.control.traction import resultant
from omni_vehicle_ros.control.trim import Sensed
from omni_vehicle_ros.control.yaw_moment import YawMomentController
from omni_vehicle_ros.model.kinematics import Twist
from omni_vehicle_ros.parameters import SideSlipParameters, SteeringParameters, VehicleParameters

VEHICLE = VehicleParameters()
SPEED = 15.0 / 3.6
YAW = SideSlipParameters(controller='yaw_moment')
ROLLING = (5.0,) * 4


def trims(sensed, vehicle=VEHICLE, **values):
    return YawMomentController(SideSlipParameters(controller='yaw_moment', **values), vehicle).update(0, sensed)


def test_the_moment_is_the_gain_times_the_error_of_the_reference():
    # r_ref = r / (1 + A v^2): 1.0 / 1.125 at 5 m/s.
    sensed = Sensed(wheel_speed=ROLLING, twist=Twist(5.0, 0.0, 0.8), commanded=Twist(5.0, 0.0, 1.0))
    found = trims(sensed, yaw_gain=1e4)
    assert found.steer_angle == (0.0,) * 4
    forces = tuple(torque / VEHICLE.wheel_radius for torque in found.torque)
    made = resultant(forces, sensed.steer_angle, 0.0, VEHICLE)
    assert made.moment == pytest.approx(1e4 * (1.0 / 1.125 - 0.8))
    assert made.along == pytest.approx(0.0, abs=1e-9)
    # Right minus left on both axles (thesis eq. 2.10).
    assert 0.5 * 1.436 * (forces[1] - forces[0]) == 0.5 * 1.436 * (forces[3] - forces[2]) == pytest.approx(
        0.5 * made.moment
    )


@settings(deadline=None)
@given(st.floats(-1.0, 1.0), st.tuples(*[st.floats(-0.4, 0.4)] * 4), st.tuples(*[st.floats(-0.2, 0.2)] * 4))
def test_left_and_right_are_mirror_images(yaw_rate, angles, slips):
    fl, fr, rl, rr = angles
    sl, sr, tl, tr = slips
    left = Sensed(slips, ROLLING, angles, (30.0,) * 4, Twist(5.0, 0.1, yaw_rate), 3.0, Twist(5.0, 0.0, 0.5))
    right = Sensed(
        (-sr, -sl, -tr, -tl), ROLLING, (-fr, -fl, -rr, -rl), (30.0,) * 4, Twist(5.0, -0.1, -yaw_rate), -3.0,
        Twist(5.0, 0.0, -0.5),
    )  # fmt: skip
    a, b, c, d = trims(left).torque
    assert trims(right).torque == pytest.approx((b, a, d, c), abs=1e-9)


@settings(deadline=None)
@given(
    st.floats(-3.0, 3.0), st.tuples(*[st.floats(-0.5, 0.5)] * 4), st.floats(-1000.0, 1000.0), st.floats(-9.0, 9.0)
)
def test_no_tyre_is_asked_for_more_than_its_friction_circle_leaves(yaw_rate, slips, present, ay):
    torque = (0.35 * present,) * 4
    sensed = Sensed(slips, ROLLING, (0.0,) * 4, torque, Twist(5.0, 0.0, yaw_rate), ay, Twist(5.0, 0.0, 0.5))
    law = YawMomentController(SideSlipParameters(controller='yaw_moment', yaw_gain=1e6), VEHICLE)
    added = law.update(0, sensed).torque
    grip = law._grip
    for i, capacity in enumerate(grip.capacities(ay)):
        side = grip.side_force(slips[i], 5.0, capacity)
        assert abs(present + added[i] / 0.35) <= max(math.sqrt(max(capacity**2 - side**2, 0.0)), abs(present)) + 1e-6


def test_saturation_is_said_and_does_not_wind_up():
    law = YawMomentController(YAW, VEHICLE)
    sliding = Sensed((0.6,) * 4, ROLLING, commanded=Twist(5.0, 0.0, 0.5), twist=Twist(5.0, 0.0, -3.0))
    for k in range(400):
        full = law.update(k * 5_000_000, sliding).torque
    assert law.status.level == WARN
    assert 'friction circles' in law.status.message
    back = law.update(400 * 5_000_000, sliding._replace(twist=Twist(5.0, 0.0, 0.6))).torque
    assert back[1] < full[1]
    assert all(abs(torque) < abs(most) for torque, most in zip(back, full, strict=True))


@pytest.mark.parametrize('side', [1.0, -1.0])
def test_the_driven_vehicle_turns_at_the_reference(closed_loop, side):
    # R = 5 m at 15 km/h (thesis, ch. 5): radius R (1 + A v^2) = 5.43 m.
    loop = closed_loop(slip=YAW, speed=SPEED)
    for _ in loop.run(7.0, lambda: loop.drive(SPEED, (0.0, side * 5.0))):
        pass
    state, speed = loop.state, math.hypot(loop.state.vx, loop.state.vy)
    assert speed / state.r == pytest.approx(side * 5.0 * (1.0 + 0.005 * SPEED**2), rel=0.01)
    assert sum(loop.trims.torque) == pytest.approx(0.0, abs=20.0)


def test_it_keeps_a_vehicle_from_spinning_that_spins_without(closed_loop):
    # 6.5 m/s on R = 5 m is past the grip limit.
    drift = {}
    for name, slip in (('with', YAW), ('without', None)):
        loop = closed_loop(slip=slip, speed=6.5)
        states = list(loop.run(8.0, lambda loop=loop: loop.drive(6.5, (0.0, 5.0))))
        drift[name] = max(abs(math.atan2(state.vy, state.vx)) for state in states)
    assert drift['without'] > 1.5
    assert drift['with'] < 0.35


def test_steering_rule_and_reverse(closed_loop):
    loop = closed_loop(slip=YAW, steering=SteeringParameters(), speed=-3.0)
    for _ in loop.run(7.0, lambda: loop.drive(-3.0, (0.0, 5.0))):
        pass
    speed = math.hypot(loop.state.vx, loop.state.vy)
    assert speed / loop.state.r == pytest.approx(-5.0 * (1.0 + 0.005 * 9.0), rel=0.015)
