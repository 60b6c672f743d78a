"""The speed controller on vehicles of one mass, with the lag of the drive, against what its laws promise."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omni_vehicle_ros.control import speed as law
from omni_vehicle_ros.control.actuator import DriveActuator
from omni_vehicle_ros.parameters import SteeringParameters, VehicleParameters, WheelModuleParameters

VEHICLE, STEERING = VehicleParameters(), SteeringParameters()
PERIOD = 0.005
AHEAD = (1.0,) * 4
SPIN = (-1.0, 1.0, -1.0, 1.0)


class Trolley:
    """A mass on four wheels that all run at one speed, each with its own rolling direction, on a slope."""

    def __init__(self, signs=AHEAD, speed=0.0, slope=0.0, lagging=True):
        self.signs, self.speed, self.slope, self.travel = signs, speed, slope, 0.0
        self.drives = [DriveActuator(WheelModuleParameters(ideal_actuators=not lagging)) for _ in range(4)]
        self.forces = (0.0,) * 4

    @property
    def speeds(self):
        return tuple(sign * self.speed for sign in self.signs)

    def push(self, forces):
        self.forces = forces
        got = [drive.update(0.35 * f, PERIOD) / 0.35 for drive, f in zip(self.drives, forces, strict=True)]
        pull = sum(sign * force for sign, force in zip(self.signs, got, strict=True))
        self.speed += PERIOD * (pull / VEHICLE.mass + self.slope)
        self.travel += PERIOD * self.speed


@pytest.mark.parametrize('signs', [AHEAD, SPIN, (1.0, -1.0, -1.0, 1.0)])
@pytest.mark.parametrize('slope', [0.0, 0.4])
def test_the_commanded_speed_is_reached_without_an_error(signs, slope):
    trolley, controller = Trolley(signs, slope=slope), law.SpeedController(VEHICLE, STEERING)
    for _ in range(3000):
        trolley.push(controller.drive(3.0, trolley.speed, 0.0, signs, PERIOD))
    assert trolley.speed == pytest.approx(3.0, abs=1e-3)


def test_feed_forward_alone_accelerates_as_told():
    trolley = Trolley(lagging=False)
    controller = law.SpeedController(VEHICLE, SteeringParameters(speed_gain=0.0, speed_integral_gain=0.0))
    for _ in range(200):
        trolley.push(controller.drive(1.0, trolley.speed, 1.5, AHEAD, PERIOD))
    assert trolley.speed == pytest.approx(1.5)


@pytest.mark.parametrize('lagging', [True, False])
@pytest.mark.parametrize('signs', [AHEAD, SPIN])
@pytest.mark.parametrize('speed', [5.0, 0.3, -2.0, 0.02])
def test_standing_comes_to_rest_from_one_side_and_stays(lagging, signs, speed):
    trolley, controller = Trolley(signs, speed, lagging=lagging), law.SpeedController(VEHICLE, STEERING)
    for _ in range(1600):
        trolley.push(controller.stand(trolley.speeds, PERIOD))
        assert trolley.speed * speed >= -1e-3 * speed * speed
    assert trolley.speed == pytest.approx(0.0, abs=2e-4)
    # The forces are quiet: no chatter.
    before = trolley.forces
    trolley.push(controller.stand(trolley.speeds, PERIOD))
    assert trolley.forces == pytest.approx(before, abs=1.0)


@pytest.mark.parametrize('slope', [0.5, -0.5])
def test_standing_on_a_slope_holds_exactly(slope):
    trolley, controller = Trolley(slope=slope), law.SpeedController(VEHICLE, STEERING)
    for _ in range(2000):
        trolley.push(controller.stand(trolley.speeds, PERIOD))
    assert trolley.speed == pytest.approx(0.0, abs=1e-4)
    assert sum(trolley.forces) == pytest.approx(-VEHICLE.mass * slope, rel=1e-3)
    assert abs(trolley.travel) < 0.3


def test_starting_on_a_slope_begins_with_the_force_that_held():
    trolley, controller = Trolley(slope=-0.5), law.SpeedController(VEHICLE, STEERING)
    for _ in range(2000):
        trolley.push(controller.stand(trolley.speeds, PERIOD))
    forces = controller.drive(1e-9, trolley.speed, 0.0, AHEAD, PERIOD)
    assert sum(forces) == pytest.approx(0.5 * VEHICLE.mass, rel=1e-2)


def test_integral_does_not_wind_up_against_the_force_limit():
    controller = law.SpeedController(VEHICLE, STEERING)
    for _ in range(10000):
        controller.drive(30.0, 0.0, 0.0, AHEAD, PERIOD)
    assert sum(controller.drive(30.0, 31.0, 0.0, AHEAD, PERIOD)) < 0.0


def test_traction_follows_the_shares_and_a_brake_acts_on_all_wheels():
    steering = SteeringParameters(drive_shares=(0.5, 0.5, 0.0, 0.0))
    controller = law.SpeedController(VEHICLE, steering)
    driving = controller.drive(2.0, 1.9, 0.0, AHEAD, PERIOD)
    assert driving[0] == driving[1] > 0.0
    assert driving[2] == driving[3] == 0.0
    controller.reset()
    braking = controller.drive(2.0, 2.1, 0.0, AHEAD, PERIOD)
    assert braking == pytest.approx((braking[0],) * 4)
    assert braking[0] < 0.0


@settings(deadline=None)
@given(
    st.floats(-40.0, 40.0), st.floats(-1e3, 1e3), st.floats(-1e3, 1e3), st.tuples(*[st.floats(-3.0, 3.0)] * 4),
    st.tuples(*[st.floats(-1e3, 1e3)] * 4), st.floats(0.0, 0.1),
)
def test_forces_never_pass_the_limit(magnitude, measured, acceleration, units, speeds, dt):
    controller = law.SpeedController(VEHICLE, STEERING)
    for _ in range(3):
        assert max(map(abs, controller.drive(magnitude, measured, acceleration, units, dt))) <= 3000.0
        assert max(map(abs, controller.stand(speeds, dt))) <= 3000.0
